// @ts-check
/** The playground: wires the controls, the worker and the canvases together. */
import { areThings, drawPoints, markRadius, prepare, readColours } from './draw.js';
import { Compare } from './compare.js';
import { Engine } from './engine.js';
import { Files, LARGEST_FILE } from './files.js';
import { Look } from './look.js';
import { LossChart } from './loss-chart.js';
import { Run } from './run.js';
import { Stage } from './stage.js';
import { Statistics } from './statistics.js';
import { Touch } from './touch.js';
import { duration, points, times } from './words.js';
import { Refused, WorkerDied, WorkerLink } from './worker-link.js';

/** @typedef {import('./messages.js').Source} Source */
/** @typedef {import('./messages.js').GalleryEntryView} GalleryEntryView */
/** @typedef {import('./messages.js').PatternView} PatternView */
/** @typedef {import('./messages.js').Progress} Progress */
/** @typedef {PatternView['boundary']} Boundary */
/** @typedef {{ title: string, caption: string, source: Source }} Chosen */

/** What the page shows first. */
const FIRST = 'rings';
/** A slider in motion starts one run, not thirty. */
const SETTLE_MS = 180;
const LARGEST_SEED = Number.MAX_SAFE_INTEGER;

const address = new URLSearchParams(location.search);
/** `?test=1` lets a test make the worker die; `&patience=` says after how many milliseconds of silence it counts as dead. */
const isTest = address.get('test') === '1';
const patience = isTest ? Number(address.get('patience')) || 30_000 : 30_000;
/** `&with=channels:4,grid-max:16` replaces parameters, so that a test can have a run that a slow device gets through. */
const replaced = Object.fromEntries(
  ((isTest && address.get('with')) || '').split(',').map((pair) => pair.split(':')).filter(([, value]) => value)
    .map(([name, value]) => [name, Number(value)]),
);

/**
 * @template {HTMLElement} [E=HTMLElement]
 * @param {string} id
 * @returns {E}
 */
function element(id) {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no element '${id}'`);
  return /** @type {E} */ (found);
}

const chart = new LossChart();
const link = new WorkerLink(`./worker.js${isTest ? '?test=1' : ''}`, patience, onWorkerDeath);
const files = new Files();
const look = new Look(files, () => {
  stage.restyle();
  drawThumbnails();
});
const stage = new Stage(look);
const engine = new Engine(link, { announce, checks: (checks) => void (run.shares = checks) });
const run = new Run(link, { started: onStarted, batch: onBatch, status: onStatus, refused: complain });

const touch = new Touch(stage, run, announce);
const compare = new Compare(stage, link, announce);
const statistics = new Statistics(link, { status: () => run.status, announce });

/** @type {Chosen} */
let chosen = { title: 'Rings', caption: '', source: { source: 'gallery', name: FIRST } };
/** The exemplar's. @type {string[]} */
let classNames = [];
/** @type {Progress | null} */
let progress = null;
/** @type {import('./messages.js').Parameters | null} */
let parameters = null;
let booted = false;

// ---------------------------------------------------------------------------------------------- notices

/**
 * Says something in the one place for it; the next notice replaces it.
 *
 * @param {string} text
 * @param {{ label: string, act: () => void }} [offer]
 */
function notify(text, offer) {
  const notice = document.createElement('div');
  notice.className = 'notice';
  const words = document.createElement('p');
  words.textContent = text;
  notice.append(words);
  if (offer) {
    const button = document.createElement('button');
    button.type = 'button';
    button.textContent = offer.label;
    button.onclick = () => {
      unnotify();
      offer.act();
    };
    notice.append(button);
  }
  const close = document.createElement('button');
  close.type = 'button';
  close.className = 'close';
  close.textContent = '×';
  close.setAttribute('aria-label', 'Dismiss');
  close.onclick = unnotify;
  notice.append(close);
  element('notices').replaceChildren(notice);
}

function unnotify() {
  element('notices').replaceChildren();
}

/** @param {string} message a sentence of the library; those begin small and have no full stop */
function complain(message) {
  complainAbout('', message.charAt(0).toUpperCase() + message.slice(1));
}

/**
 * @param {string} start what must stay as it is, such as a file's name
 * @param {string} message
 */
function complainAbout(start, message) {
  notify(start + message + (/[.!?]$/.test(message) ? '' : '.'));
}

/** @param {string} text for those who do not see the canvas move */
function announce(text) {
  element('live').textContent = text;
}

/** @param {string} reason */
function onWorkerDeath(reason) {
  run.workerDied();
  engine.workerDied();
  if (!booted) {
    notify(`The computation could not start: ${reason}.`, { label: 'Try again', act: () => void boot() });
    return;
  }
  const saved = run.savedIterations;
  if (saved === null) {
    notify(`The computation stopped unexpectedly (${reason}).`, { label: 'Start again', act: () => begin(true) });
  } else {
    notify(`The computation stopped unexpectedly (${reason}). Its state after iteration ${saved} is safe.`, {
      label: saved === 0 ? 'Start again' : `Continue from iteration ${saved}`,
      act: () => void run.recover(),
    });
  }
}

// ---------------------------------------------------------------------------------------------- the run

/** @param {import('./messages.js').StartedResponse} started */
function onStarted(started) {
  progress = started.progress;
  classNames = started.exemplar.classNames;
  parameters = started.parameters;
  chart.keep(started.progress.totalIterations);
  look.show(started.exemplar);
  stage.show(started.exemplar, started.output);
  touch.started();
  compare.started(started.parameters, chosen.source);
  const { exemplar, output } = started;
  const outputCount = output.points.classes.length;
  element('exemplar-title').textContent = chosen.title;
  element('exemplar-caption').textContent = chosen.caption;
  element('exemplar-count').textContent = points(exemplar.points.classes.length);
  const factors = [started.parameters['expansion-x'], started.parameters['expansion-y']].map(Number);
  element('output-count').textContent = `${points(outputCount)} · ${factors.map(times).join(' ')}`;
  element('exemplar-canvas').setAttribute(
    'aria-label',
    `The exemplar ${chosen.title}: ${points(exemplar.points.classes.length)}. ${chosen.caption}`,
  );
  element('download-csv').title = `${points(outputCount)}, one line each, in the exemplar's own units`;
  showProgress(null, null);
  engine.ensure();
  statistics.restart();
}

/** @param {import('./messages.js').BatchResponse} batch */
function onBatch(batch) {
  const scaleBefore = progress?.scale;
  progress = batch.progress;
  for (const event of batch.events) {
    if (event.type === 'iterated') chart.add(event.loss);
    // A scale also starts anew where another engine takes it over.
    else if (event.type === 'scale-started' && event.progress.iteration === 0) chart.beginScale();
  }
  if (batch.engine) engine.change(batch.engine, batch.note);
  if (batch.points) {
    stage.move(batch.points);
    touch.changed();
    statistics.moved();
  }
  showProgress(batch.iterationsPerSecond, batch.secondsLeft);
  if (progress.scale !== scaleBefore) announce(`Scale ${progress.scale + 1} of ${progress.scales} has begun.`);
}

/**
 * @param {number | null} iterationsPerSecond
 * @param {number | null} secondsLeft
 */
function showProgress(iterationsPerSecond, secondsLeft) {
  if (!progress) return;
  const { class: klass, turn, classes, scale, scales, restart, restarts, redoing, iteration, iterations } = progress;
  const { totalIterations, done } = progress;
  const finished = run.status === 'finished';
  const playing = run.status === 'playing';
  const part = classes > 1 ? `Class ${turn + 1} of ${classes} (${classNames[klass] ?? ''}) · ` : '';
  const again = redoing ? ' · Redoing a region' : restart > 0 ? ` · Mending the worst, ${restart} of ${restarts}` : '';
  element('fact-scale').textContent = finished ? 'Finished' : `${part}Scale ${scale + 1} of ${scales}${again}`;
  element('fact-iteration').textContent = `Iteration ${totalIterations}`;
  engine.speed = playing ? iterationsPerSecond : null;
  element('fact-left').textContent =
    secondsLeft !== null && playing ? `about ${duration(secondsLeft)} left` : '';
  const bar = element('progress');
  if (bar.children.length !== scales) {
    bar.replaceChildren(
      ...Array.from({ length: scales }, () => {
        const segment = document.createElement('span');
        segment.append(document.createElement('i'));
        return segment;
      }),
    );
  }
  for (const [index, segment] of [...bar.children].entries()) {
    const share = finished || index < scale ? 1 : index > scale ? 0 : iteration / Math.max(iterations, 1);
    /** @type {HTMLElement} */ (segment.firstChild).style.transform = `translateX(${101 * Math.min(share, 1) - 101}%)`;
  }
  const words = finished ? 'Finished' : `Scale ${scale + 1} of ${scales}, iteration ${iteration} of ${iterations}`;
  bar.setAttribute('aria-valuenow', String(Math.round(100 * (finished ? 1 : done))));
  bar.setAttribute('aria-valuetext', words);
  element('output-canvas').setAttribute(
    'aria-label',
    `The result: ${points(stage.positions.length / 2)} with the structure of ${chosen.title}. ${words}.`,
  );
}

/** @param {import('./run.js').Status} status */
function onStatus(status) {
  const does = { empty: 'play', paused: 'play', playing: 'pause', finished: 'again', stopped: 'again' }[status];
  const button = element('play');
  button.dataset.does = does;
  const continues = (progress?.totalIterations ?? 0) > 0;
  element('play-label').textContent =
    does === 'pause' ? 'Pause' : does === 'again' ? 'Run again' : continues ? 'Continue' : 'Run';
  element('step').toggleAttribute('disabled', status === 'finished' || status === 'stopped' || status === 'empty');
  if (status !== 'playing') showProgress(null, null);
  if (status === 'finished') {
    announce('Finished.');
    compare.finished();
  }
  // What is still playing goes on by itself.
  element('go-on').toggleAttribute('disabled', status !== 'finished' && status !== 'paused');
  document.body.dataset.status = status;
  statistics.turned();
}

function toggle() {
  if (run.status === 'playing') run.pause();
  else if (run.status === 'paused') run.play();
  else if (run.status === 'finished' || run.status === 'stopped') void run.again();
}

async function reset() {
  await run.reset();
  onStatus(run.status);
}

// ---------------------------------------------------------------------------------------------- settings

const settings = element('settings');
const [slideX, slideY] = [element('expansion-x'), element('expansion-y')].map(
  (slider) => /** @type {HTMLInputElement} */ (slider),
);
const seedField = /** @type {HTMLInputElement} */ (element('seed'));
const linked = /** @type {HTMLInputElement} */ (element('linked'));

/** @param {string} name */
const radio = (name) =>
  /** @type {HTMLInputElement | null} */ (settings.querySelector(`input[name="${name}"]:checked`))?.value;

/** The gallery says what the first exemplar's boundary is; until then the worker, which knows, decides. */
let knowsBoundary = false;

/**
 * An exemplar brings its own boundary along; the person may change it afterwards.
 *
 * @param {Boundary} boundary
 */
function setBoundary(boundary) {
  knowsBoundary = true;
  const input = settings.querySelector(`input[name="boundary"][value="${boundary}"]`);
  /** @type {HTMLInputElement} */ (input).checked = true;
  showTilesChoice();
}

/** Only a result that tiles can be shown as tiles. */
function showTilesChoice() {
  element('tiles-row').hidden = radio('boundary') !== 'periodic';
}

/** @returns {number | null} */
function readSeed() {
  const text = seedField.value.trim();
  const seed = /^\d+$/.test(text) ? Number(text) : Number.NaN;
  const valid = Number.isSafeInteger(seed);
  seedField.setAttribute('aria-invalid', String(!valid));
  return valid ? seed : null;
}

/** @type {ReturnType<typeof setTimeout> | undefined} */
let settling;

/** Whether a change of settings keeps the points. */
const keepsPoints = /** @type {HTMLInputElement} */ (element('keep-points'));

/**
 * Starts a run with the settings as they are.
 *
 * @param {boolean} play
 * @param {boolean} [onward] from the points as they are
 */
function begin(play, onward = false) {
  clearTimeout(settling);
  const seed = readSeed();
  if (seed === null) {
    complain(`the seed must be a whole number between 0 and ${LARGEST_SEED}`);
    return Promise.resolve(false);
  }
  const plan = {
    source: chosen.source,
    preset: radio('preset') ?? 'fast',
    overrides: {
      'expansion-x': Number(slideX.value),
      'expansion-y': Number(slideY.value),
      ...(knowsBoundary && { boundary: radio('boundary') ?? 'open' }),
      seed,
      ...replaced,
    },
  };
  return onward ? run.continueWith(plan) : run.start(plan, play);
}

/** @param {boolean} [onward] whether the points may be kept */
function beginSoon(onward = true) {
  clearTimeout(settling);
  settling = setTimeout(() => {
    unnotify();
    void begin(true, onward && keepsPoints.checked && run.status !== 'empty' && run.status !== 'stopped');
  }, SETTLE_MS);
}
element('go-on').addEventListener('click', () => void begin(true, true));

function showSliders() {
  element('expansion-x-value').textContent = times(Number(slideX.value));
  element('expansion-y-value').textContent = times(Number(slideY.value));
}

for (const [slider, other] of [
  [slideX, slideY],
  [slideY, slideX],
]) {
  slider.addEventListener('input', () => {
    if (linked.checked) other.value = slider.value;
    showSliders();
    beginSoon();
  });
}
linked.addEventListener('change', () => {
  if (!linked.checked || slideX.value === slideY.value) return;
  slideY.value = slideX.value;
  showSliders();
  beginSoon();
});
settings.addEventListener('change', (event) => {
  const { name, type } = /** @type {HTMLInputElement} */ (event.target);
  // Another engine goes on with the run at hand.
  if (type !== 'radio' || name === 'engine') return;
  if (name === 'boundary') {
    knowsBoundary = true;
    showTilesChoice();
  }
  beginSoon();
});
seedField.addEventListener('input', () => {
  if (readSeed() !== null) beginSoon();
});
element('dice').addEventListener('click', () => {
  seedField.value = String(crypto.getRandomValues(new Uint32Array(1))[0] % 1_000_000);
  readSeed();
  beginSoon();
});
element('tiles').addEventListener('change', (event) => {
  stage.tiles = /** @type {HTMLInputElement} */ (event.target).checked;
});
settings.addEventListener('submit', (event) => {
  event.preventDefault();
  beginSoon();
});

/** @param {import('./messages.js').DescriptionResponse} description */
function showDescription({ engine: processor, presets, ranges, glyphs }) {
  engine.describe(processor);
  look.learn(glyphs);
  if (element('presets').children.length === 0) {
    for (const [index, { name, title }] of presets.entries()) {
      const label = document.createElement('label');
      const input = document.createElement('input');
      Object.assign(input, { type: 'radio', name: 'preset', value: name, defaultChecked: index === 0 });
      input.setAttribute('aria-describedby', 'hint-preset');
      const words = document.createElement('span');
      words.textContent = title;
      label.append(input, words);
      element('presets').append(label);
    }
  }
  element('hint-preset').textContent = presets.map(({ title, meaning }) => `${title}: ${meaning}`).join('\n');
  for (const { name, meaning } of ranges) {
    const hint = document.getElementById(`hint-${name}`);
    if (hint) hint.textContent = meaning;
  }
}

// ---------------------------------------------------------------------------------------------- exemplars

/** @type {Map<HTMLCanvasElement, PatternView>} */
const thumbnails = new Map();

/** A thumbnail has room for about so many things whose shape is to be seen; of more it shows a part. */
const THINGS_SEEN = 34;

/**
 * @param {HTMLCanvasElement} canvas
 * @param {PatternView} pattern
 */
function drawThumbnail(canvas, pattern) {
  const { points, size: [width, height], spacing } = pattern;
  const side = canvas.clientWidth || 60;
  const colours = readColours();
  const styles = look.styles(pattern, colours);
  const things = areThings(points, styles);
  // Dots stand within a margin; of things the middle is shown, to the border.
  const margin = things ? 0 : 4;
  const zoom = things ? Math.min(2, Math.max(1, Math.sqrt(points.classes.length / THINGS_SEEN))) : 1;
  const scale = (side - 2 * margin) * zoom;
  const context = prepare(canvas, side, side);
  drawPoints(context, colours, points, {
    left: (side - width * scale) / 2,
    top: (side - height * scale) / 2,
    scale,
    radius: (things ? 1.15 : 0.9) * Math.max(things ? 1.6 : 0.89, markRadius(spacing, scale, things)),
    styles,
  });
}

function drawThumbnails() {
  for (const [canvas, pattern] of thumbnails) drawThumbnail(canvas, pattern);
}

/**
 * @param {Chosen} choice
 * @param {string} value
 * @param {PatternView} pattern
 */
function exemplarCard(choice, value, pattern) {
  const card = document.createElement('label');
  card.className = 'exemplar-card';
  card.title = choice.caption;
  const input = document.createElement('input');
  Object.assign(input, { type: 'radio', name: 'exemplar', value, className: 'unseen' });
  input.addEventListener('change', () => choose(choice, pattern.boundary));
  const canvas = document.createElement('canvas');
  canvas.setAttribute('aria-hidden', 'true');
  const words = document.createElement('div');
  const title = document.createElement('strong');
  title.textContent = choice.title;
  const caption = document.createElement('span');
  caption.textContent = choice.caption;
  words.append(title, caption);
  card.append(input, canvas, words);
  thumbnails.set(canvas, pattern);
  return { card, input };
}

/**
 * @param {Chosen} choice
 * @param {Boundary} boundary
 */
function choose(choice, boundary) {
  chosen = choice;
  setBoundary(boundary);
  beginSoon(false);
}

/** @param {GalleryEntryView[]} entries */
function showGallery(entries) {
  const gallery = element('gallery');
  if (gallery.children.length > 0) return;
  for (const { name, title, caption, pattern } of entries) {
    const choice = { title, caption, source: /** @type {Source} */ ({ source: 'gallery', name }) };
    const { card, input } = exemplarCard(choice, name, pattern);
    if (chosen.source.name === name) {
      input.checked = true;
      chosen = choice;
      if (!knowsBoundary) setBoundary(pattern.boundary);
      element('exemplar-title').textContent = title;
      element('exemplar-caption').textContent = caption;
    }
    gallery.append(card);
  }
  drawThumbnails();
}

/** @param {File} file */
async function openFile(file) {
  unnotify();
  if (file.size > LARGEST_FILE) {
    complainAbout(file.name, ` has ${Math.round(file.size / 1e6)} MB; a point pattern of that size can't be used here`);
    return;
  }
  try {
    const { pattern } = await files.read(file.name, new Uint8Array(await file.arrayBuffer()));
    /** @type {Source} */
    const source = { source: 'pattern', name: file.name, pattern };
    const { exemplar } = await link.ask({ type: 'open', exemplar: source });
    const caption = `Your own file, ${points(exemplar.points.classes.length)}.`;
    const choice = { title: file.name, caption, source };
    const { card, input } = exemplarCard(choice, 'own', exemplar);
    const gallery = element('gallery');
    gallery.querySelector('input[value="own"]')?.closest('label')?.remove();
    gallery.prepend(card);
    gallery.scrollTo({ top: 0, left: 0 });
    input.checked = true;
    for (const canvas of thumbnails.keys()) if (!canvas.isConnected) thumbnails.delete(canvas);
    drawThumbnails();
    chosen = choice;
    setBoundary(exemplar.boundary);
    await begin(true);
  } catch (error) {
    if (error instanceof WorkerDied) return;
    if (error instanceof Refused) complainAbout('', error.message);
    else complainAbout(file.name, ` could not be read: ${error instanceof Error ? error.message : error}`);
  }
}

const fileField = /** @type {HTMLInputElement} */ (element('file'));
fileField.addEventListener('change', () => {
  const file = fileField.files?.[0];
  // So that the same file can be chosen again after it was mended.
  if (file) void openFile(file).finally(() => (fileField.value = ''));
});

/** @param {DragEvent} event */
const carriesFile = (event) => event.dataTransfer?.types.includes('Files') ?? false;
window.addEventListener('dragover', (event) => {
  if (!carriesFile(event)) return;
  event.preventDefault();
  element('drop-veil').hidden = false;
});
window.addEventListener('dragleave', (event) => {
  if (event.relatedTarget === null) element('drop-veil').hidden = true;
});
window.addEventListener('drop', (event) => {
  element('drop-veil').hidden = true;
  if (!carriesFile(event)) return;
  event.preventDefault();
  const file = event.dataTransfer?.files[0];
  if (file) void openFile(file);
});

// ---------------------------------------------------------------------------------------------- downloads

/**
 * @param {'csv' | 'svg'} format
 * @param {string} mime
 */
async function download(format, mime) {
  try {
    const { bytes } = await files.write(format, await run.export(), look.choice);
    const name = chosen.source.name.replace(/\.[^.]*$/, '');
    const anchor = document.createElement('a');
    anchor.href = URL.createObjectURL(new Blob([/** @type {Uint8Array<ArrayBuffer>} */ (bytes)], { type: mime }));
    anchor.download = `pointweave-${name}.${format}`;
    anchor.click();
    setTimeout(() => URL.revokeObjectURL(anchor.href), 10_000);
  } catch (error) {
    if (error instanceof Refused) complain(error.message);
    else if (!(error instanceof WorkerDied)) throw error;
  }
}
element('download-csv').addEventListener('click', () => void download('csv', 'text/csv'));
element('download-svg').addEventListener('click', () => void download('svg', 'image/svg+xml'));

// ---------------------------------------------------------------------------------------------- keyboard

element('play').addEventListener('click', toggle);
element('step').addEventListener('click', () => void run.step());
element('reset').addEventListener('click', () => void reset());

window.addEventListener('keydown', (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
  const target = /** @type {HTMLElement} */ (event.target);
  const type = target instanceof HTMLInputElement ? target.type : '';
  const writes = type !== '' && !['radio', 'checkbox', 'range', 'file'].includes(type);
  if (writes || target.closest('textarea, select')) return;
  // A control keeps the keys it answers to; a chosen radio does not answer to Space.
  const ownsSpace = target.closest('button, summary, a') || ['checkbox', 'file'].includes(type);
  const ownsArrows = type === 'radio' || type === 'range';
  if (event.key === ' ' && !ownsSpace) toggle();
  else if (event.key === 'ArrowRight' && !ownsArrows) void run.step();
  else if (event.key.toLowerCase() === 'r' && !event.repeat) void reset();
  else return;
  event.preventDefault();
});

// ---------------------------------------------------------------------------------------------- start

matchMedia('(prefers-color-scheme: dark)').addEventListener('change', drawThumbnails);
new ResizeObserver(drawThumbnails).observe(element('gallery'));

async function boot() {
  try {
    // The worker answers in order: the run is on its way while the page is still being filled.
    const description = link.ask({ type: 'describe' }).then(showDescription);
    const gallery = link.ask({ type: 'gallery' }).then(({ entries }) => showGallery(entries));
    const first = begin(true);
    await Promise.all([description, gallery]);
    booted = true;
    await first;
  } catch (error) {
    if (!(error instanceof WorkerDied)) throw error;
  }
}

/**
 * For tests and for the curious, in the browser's console: what the page knows, as numbers.
 * `crash` works only on a page opened with `?test=1`.
 */
Object.assign(window, {
  pointweave: {
    get status() {
      return run.status;
    },
    get progress() {
      return progress && { ...progress };
    },
    /** All parameters of the run, under their names in files. */
    get parameters() {
      return parameters && { ...parameters };
    },
    /** Where the points are, not where they are drawn on their way there: `[x, y, x, y, …]` in exemplar units. */
    get positions() {
      return Array.from(stage.positions);
    },
    /** Total loss of every iteration so far. */
    get losses() {
      return chart.totals;
    },
    get savedIterations() {
      return run.savedIterations;
    },
    get engine() {
      return engine.view;
    },
    /** Which points are pinned, in the order of `positions`. */
    get pinned() {
      return Array.from(stage.pinned);
    },
    /** The glyph and colour of every class of the exemplar, and what is chosen for files. */
    get look() {
      return look.choice;
    },
    /** How often statistics were worked out, and the latest. */
    get statistics() {
      return statistics.state;
    },
    crash: (/** @type {'trap' | 'silence' | 'device'} */ how) => link.crash(how),
  },
});

onStatus('empty');
showSliders();
void boot();
