// @ts-check
/** The playground: wires the controls, the worker and the canvases together. */
import { areThings, drawPoints, markRadius, prepare, readColours } from '../common/draw.js';
import { Compare } from './compare.js';
import { Editor } from './editor/editor.js';
import { Host, applyEmbedOptions, embedOptions } from './embed.js';
import { Engine } from './engine.js';
import { Files } from '../common/files.js';
import { Import, capital } from './import/import.js';
import { Look } from './look.js';
import { LossChart } from './loss-chart.js';
import '../playground/layout.js';
import { keepForOffline } from '../common/offline.js';
import { blank, count } from '../common/pattern.js';
import { sourceOf, viewOf } from '../common/pattern-source.js';
import { Run } from './run.js';
import { Session, fillForm, readForm } from './session.js';
import { Share, isLink } from './share.js';
import { Stage } from './stage.js';
import { Statistics } from './statistics.js';
import { Touch } from './touch.js';
import { Take } from './take.js';
import { withhold } from '../common/withhold.js';
import { duration, points, times } from '../common/words.js';
import { Refused, WorkerDied, WorkerLink } from '../common/worker-link.js';

/** @typedef {import('../common/messages.js').Source} Source */
/** @typedef {import('../common/messages.js').GalleryEntryView} GalleryEntryView */
/** @typedef {import('../common/messages.js').PatternView} PatternView */
/** @typedef {import('../common/messages.js').Progress} Progress */
/** @typedef {PatternView['boundary']} Boundary */
/** @typedef {import('../common/pattern.js').Pattern} Pattern */
/**
 * `isOwn`: opened or drawn here by the person; `value` is that of its card.
 * @typedef {{ title: string, caption: string, source: Source, isOwn?: boolean, value?: string }} Chosen
 */

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

const embedded = applyEmbedOptions();
const chart = new LossChart();
const link = new WorkerLink(`./worker.js${isTest ? '?test=1' : ''}`, patience, onWorkerDeath);
const files = new Files();
const look = new Look(files, () => {
  stage.restyle();
  drawThumbnails();
});
const stage = new Stage(look);
const engine = new Engine(link, { announce, checks: (checks) => void (run.shares = checks) });
const run = new Run(link, { started: onStarted, batch: onBatch, status: onStatus, refused: complain, saved: keepSession });

const touch = new Touch(stage, run, announce);
const compare = new Compare(stage, link, { announce, turned: () => (showProgress(null, null), touch.changed()) });
const statistics = new Statistics(link, { status: () => run.status, announce });

/** A page in a frame is its host's to keep. */
const session = new Session(window === window.top && !embedded);
const take = new Take(files, link, run, stage, { look: () => look.choice, chosen: () => chosen, complain, announce });
const share = new Share(files, { chosen: () => chosen, plan: currentPlan, adopt, saveProject: () => take.project(), announce });
const host = new Host({
  state: () => ({
    status: run.status,
    // The name of an own file is the person's own, too.
    title: isPrivate ? '' : chosen.title,
    points: stage.positions.length / 2,
    progress,
    parameters,
  }),
  play: () => void (run.status !== 'playing' && toggle()),
  pause: () => run.pause(),
  step: () => run.step(),
  reset,
  openLink,
  openData,
  points: () => run.export(),
  isPrivate: () => isPrivate,
});

/** @type {Chosen} */
let chosen = { title: 'Rings', caption: '', source: { source: 'gallery', name: FIRST } };
/** The exemplar's. @type {string[]} */
let classNames = [];
/** @type {Progress | null} */
let progress = null;
/** @type {import('../common/messages.js').Parameters | null} */
let parameters = null;
let booted = false;
/** The exemplar of the run at hand. @type {PatternView | null} */
let shown = null;
/** Whether the exemplar is the person's own, not the gallery's, a link's, or the page's around this one. */
let isPrivate = false;
/** What a link or a project says beyond the controls, or between what they can show. @type {import('../common/messages.js').Parameters} */
let beyond = {};

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

/**
 * @param {string} message a sentence of the library; those begin small and have no full stop
 * @param {boolean} [onward] whether the points were to be kept
 */
function complain(message, onward) {
  const offer = onward ? { label: 'Start anew', act: () => void begin(true) } : undefined;
  complainAbout('', message.charAt(0).toUpperCase() + message.slice(1), offer);
}

/**
 * @param {string} start what must stay as it is, such as a file's name
 * @param {string} message
 * @param {Parameters<typeof notify>[1]} [offer]
 */
function complainAbout(start, message, offer) {
  notify(start + message + (/[.!?]$/.test(message) ? '' : '.'), offer);
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

/** @param {import('../common/messages.js').StartedResponse} started */
function onStarted(started) {
  progress = started.progress;
  classNames = started.exemplar.classNames;
  parameters = started.parameters;
  chart.keep(started.progress.totalIterations);
  look.show(started.exemplar);
  shown = started.exemplar;
  stage.show(started.exemplar, started.output);
  touch.started();
  compare.started(started.parameters, chosen.source);
  if (chosen.source.source !== 'gallery' && !ownCard(chosen.value ?? 'own')) showOwn(chosen, started.exemplar);
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
  take.periodic = output.boundary === 'periodic';
  share.outdated();
  showProgress(null, null);
  engine.ensure();
  statistics.restart();
}

/** @param {import('../common/messages.js').BatchResponse} batch */
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
  host.tell('progress');
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
    stage.showsKept
      ? 'A, the result that was kept.'
      : `The result: ${points(stage.positions.length / 2)} with the structure of ${chosen.title}. ${words}.`,
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
  withhold(/** @type {HTMLButtonElement} */ (element('go-on')), 'status', status === 'finished' || status === 'paused' ? null : '');
  document.body.dataset.status = status;
  touch.changed();
  host.tell('status');
  statistics.turned();
}

function toggle() {
  if (run.status === 'playing') run.pause();
  else if (run.status === 'paused') run.play();
  else if (run.status === 'finished' || run.status === 'stopped') void run.again();
  else if (booted) {
    // A link that waited for this.
    unnotify();
    void begin(true);
  }
}

async function reset() {
  await run.reset();
  onStatus(run.status);
}

// ---------------------------------------------------------------------------------------------- settings

const settings = /** @type {HTMLFormElement} */ (element('settings'));
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

/** A preset to begin with; the page's own come with the worker's first answer. */
let firstPreset = 'fast';

/** What the settings say. @param {number} seed @returns {import('./run.js').Plan} */
const planned = (seed) => ({
  source: chosen.source,
  preset: radio('preset') ?? firstPreset,
  overrides: {
    'expansion-x': Number(slideX.value),
    'expansion-y': Number(slideY.value),
    ...(knowsBoundary && { boundary: radio('boundary') ?? 'open' }),
    seed,
    ...beyond,
    ...replaced,
  },
});

/** The run at hand with all its parameters, as links keep it; null when there is none. */
function currentPlan() {
  const plan = run.plan;
  return plan && parameters && { ...plan, overrides: parameters };
}

/** A control was moved: what a link said about it is no longer so. @param {string[]} names */
function overrule(...names) {
  beyond = Object.fromEntries(Object.entries(beyond).filter(([name]) => !names.includes(name)));
  showBeyond();
}

/** Says what no control shows. */
function showBeyond() {
  const shown = ['expansion-x', 'expansion-y', 'boundary', 'seed'];
  const names = Object.entries(beyond).filter(([name]) => !shown.includes(name));
  const text = names.map(([name, value]) => `${name} ${typeof value === 'number' ? Number(value.toPrecision(4)) : value}`).join(', ');
  element('beyond').hidden = text === '';
  element('beyond-text').textContent = `With ${text} in place of the preset’s.`;
}

element('beyond-clear').addEventListener('click', () => {
  beyond = {};
  showBeyond();
  showSliders();
  beginSoon();
});

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
  const plan = planned(seed);
  return onward ? run.continueWith(plan) : run.start(plan, play);
}

/** @param {boolean} [onward] whether the points may be kept */
function beginSoon(onward = true) {
  clearTimeout(settling);
  settling = setTimeout(() => {
    unnotify();
    leaveLink();
    void begin(true, onward && keepsPoints.checked && run.status !== 'empty' && run.status !== 'stopped');
  }, SETTLE_MS);
}
element('go-on').addEventListener('click', () => void begin(true, true));
withhold(/** @type {HTMLButtonElement} */ (element('go-on')), 'status', '');

function showSliders() {
  element('expansion-x-value').textContent = times(Number(beyond['expansion-x'] ?? slideX.value));
  element('expansion-y-value').textContent = times(Number(beyond['expansion-y'] ?? slideY.value));
}

for (const [slider, other] of [
  [slideX, slideY],
  [slideY, slideX],
]) {
  slider.addEventListener('input', () => {
    if (linked.checked) other.value = slider.value;
    overrule('expansion-x', 'expansion-y');
    showSliders();
    beginSoon();
  });
}
linked.addEventListener('change', () => {
  if (!linked.checked || slideX.value === slideY.value) return;
  slideY.value = slideX.value;
  overrule('expansion-x', 'expansion-y');
  showSliders();
  beginSoon();
});
settings.addEventListener('change', (event) => {
  const { name, type } = /** @type {HTMLInputElement} */ (event.target);
  // Another engine goes on with the run at hand.
  if (type !== 'radio' || name === 'engine') return;
  if (name === 'boundary') {
    knowsBoundary = true;
    overrule('boundary');
    showTilesChoice();
  }
  if (name === 'preset') {
    // It stands for all that no control shows.
    const { 'expansion-x': x, 'expansion-y': y } = beyond;
    beyond = { ...(x !== undefined && { 'expansion-x': x }), ...(y !== undefined && { 'expansion-y': y }) };
    showBeyond();
  }
  beginSoon();
});
seedField.addEventListener('input', () => {
  overrule('seed');
  if (readSeed() !== null) beginSoon();
});
element('dice').addEventListener('click', () => {
  seedField.value = String(crypto.getRandomValues(new Uint32Array(1))[0] % 1_000_000);
  readSeed();
  overrule('seed');
  beginSoon();
});
element('tiles').addEventListener('change', (event) => {
  stage.tiles = /** @type {HTMLInputElement} */ (event.target).checked;
  touch.changed();
});
settings.addEventListener('submit', (event) => {
  event.preventDefault();
  beginSoon();
});

/** @param {import('../common/messages.js').DescriptionResponse} description */
function showDescription({ engine: processor, presets, ranges, glyphs }) {
  engine.describe(processor);
  look.learn(glyphs);
  if (element('presets').children.length === 0) {
    for (const { name, title } of presets) {
      const label = document.createElement('label');
      const input = document.createElement('input');
      Object.assign(input, { type: 'radio', name: 'preset', value: name, defaultChecked: name === firstPreset });
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
  const input = document.createElement('input');
  Object.assign(input, { type: 'radio', name: 'exemplar', value, className: 'unseen' });
  choice.value = value;
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
  editor.close(true);
  chosen = choice;
  isPrivate = choice.source.source !== 'gallery' && choice.isOwn === true;
  setBoundary(boundary);
  overrule('boundary');
  beginSoon(false);
}

/** What the gallery's exemplars are called. @type {Map<string, Chosen>} */
const galleryChoices = new Map();

/** @param {GalleryEntryView[]} entries */
function showGallery(entries) {
  const gallery = element('gallery');
  if (gallery.children.length > 0) return;
  for (const { name, title, caption, pattern } of entries) {
    const choice = { title, caption, source: /** @type {Source} */ ({ source: 'gallery', name }) };
    galleryChoices.set(name, choice);
    const { card, input } = exemplarCard(choice, name, pattern);
    if (chosen.source.source === 'gallery' && chosen.source.name === name) {
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

/**
 * Puts a card that is not of the gallery on top of it, or in the place of the one with the same value.
 *
 * @param {Chosen} choice
 * @param {PatternView} pattern
 */
function showOwn(choice, pattern) {
  keepOwn(choice, choice.value ?? 'own', pattern).checked = true;
}

/**
 * The same without choosing it.
 *
 * @param {Chosen} choice
 * @param {string} value
 * @param {PatternView} pattern
 */
function keepOwn(choice, value, pattern) {
  const { card, input } = exemplarCard(choice, value, pattern);
  const gallery = element('gallery');
  const before = ownCard(value);
  if (before) before.replaceWith(card);
  else gallery.prepend(card);
  gallery.scrollTo({ top: 0, left: 0 });
  forgetThumbnails();
  drawThumbnails();
  return input;
}

/**
 * Opens points in any format the page reads, or a project.
 *
 * @param {string} name
 * @param {Uint8Array} bytes
 * @param {boolean} play
 * @param {boolean} [isOwn] whether the person gave them, not another page
 */
async function openData(name, bytes, play, isOwn = false) {
  const { pattern, ...read } = await files.read(name, bytes);
  const project = read.type === 'read' ? read.project : null;
  if (project) return openProject(project, pattern, isOwn);
  await openPattern(name, `${isOwn ? 'Your own file' : 'From the page around this one'}, ${points(pattern.classes.length)}.`, pattern, isOwn);
  await begin(play);
}

/**
 * Makes a pattern the exemplar, without starting anything.
 *
 * @param {string} title
 * @param {string} caption
 * @param {import('../common/messages.js').PatternData} pattern
 * @param {boolean} isOwn
 * @param {string} [value] of its card
 * @returns {Promise<PatternView>}
 */
async function openPattern(title, caption, pattern, isOwn, value) {
  /** @type {Chosen} */
  const choice = { title, caption, source: sourceOf(pattern, title), isOwn, value };
  const { exemplar } = await link.ask({ type: 'open', exemplar: choice.source });
  editor.close(true);
  showOwn(choice, exemplar);
  chosen = choice;
  isPrivate = isOwn;
  setBoundary(exemplar.boundary);
  overrule('boundary');
  return exemplar;
}

/**
 * Sets the controls to a preset and what differs from it; what they can't show is kept beside them.
 *
 * @param {string} preset
 * @param {import('../common/messages.js').Parameters} overrides
 */
function applySettings(preset, overrides) {
  firstPreset = preset;
  const presetRadio = settings.querySelector(`input[name="preset"][value="${CSS.escape(preset)}"]`);
  if (presetRadio) /** @type {HTMLInputElement} */ (presetRadio).checked = true;
  const { boundary, seed } = overrides;
  beyond = { ...overrides };
  if (seed !== undefined) seedField.value = String(seed);
  slideX.value = String(overrides['expansion-x'] ?? 2);
  slideY.value = String(overrides['expansion-y'] ?? 2);
  linked.checked = (overrides['expansion-x'] ?? 2) === (overrides['expansion-y'] ?? 2);
  if (boundary === 'open' || boundary === 'periodic') setBoundary(boundary);
  readSeed();
  showBeyond();
  showSliders();
}

/**
 * Goes on with a project, paused, where it was saved.
 *
 * @param {import('../common/files-messages.js').Project} project
 * @param {import('../common/messages.js').PatternData} pattern
 * @param {boolean} isOwn
 */
async function openProject(project, pattern, isOwn) {
  await openPattern(project.title || 'Project', `From a project, ${points(pattern.classes.length)}.`, pattern, isOwn);
  applySettings(project.preset, project.overrides);
  leaveLink();
  chart.keep();
  const seed = readSeed();
  if (project.state === null || seed === null) await begin(true);
  else if (await run.resume(planned(seed), project.state, false)) announce('The project goes on where it was saved.');
}

/** @param {string} value */
const ownCard = (value) => element('gallery').querySelector(`input[value="${value}"]`)?.closest('label');

function forgetThumbnails() {
  for (const canvas of thumbnails.keys()) if (!canvas.isConnected) thumbnails.delete(canvas);
}

/** A card's value that is free. @param {'own' | 'drawing'} kind @returns {{ value: string, number: number }} */
function freeValue(kind) {
  for (let number = 1; ; number++) {
    const value = `${kind}-${number}`;
    if (!ownCard(value)) return { value, number };
  }
}

/** @param {import('./import/import.js').Imported} imported */
async function useImported({ name, pattern, preview, project }) {
  unnotify();
  try {
    if (project) {
      await openProject(project, pattern, true);
      return;
    }
    await openPattern(name, `${capital(preview.format)}, ${points(preview.points)}.`, pattern, true, freeValue('own').value);
    leaveLink();
    await begin(true);
  } catch (error) {
    if (error instanceof Refused) complain(error.message);
    else if (!(error instanceof WorkerDied)) throw error;
  }
}

const importer = new Import(files, look, { use: (imported) => void useImported(imported) });

// ---------------------------------------------------------------------------------------------- drawing

const editor = new Editor({ weave: useDrawing, closed: onEditorClosed });
/**
 * The drawing under way: the card it has or will have, and what there was before it began.
 *
 * @type {{ value: string, title: string, isNew: boolean, woven: Pattern | null,
 *   before: { chosen: Chosen, boundary: Boundary, beyond: import('../common/messages.js').Parameters } }}
 */
let drawing;

/** @param {Chosen} choice */
const isDrawing = ({ value }) => value?.startsWith('drawing-') === true;

/**
 * @param {Pattern} pattern
 * @param {string} label what was done, for people
 * @param {boolean} again whether it goes on with the drawing that is chosen
 */
function draw(pattern, label, again = false) {
  if (!editor.isOpen) {
    const { value, number } = freeValue('drawing');
    drawing = {
      value: again ? (chosen.value ?? value) : value,
      title: again ? chosen.title : number === 1 ? 'Your drawing' : `Your drawing ${number}`,
      isNew: !again,
      woven: null,
      before: { chosen, boundary: /** @type {Boundary} */ (radio('boundary') ?? pattern.boundary), beyond },
    };
  }
  editor.open(pattern, label);
  stage.editing = true;
  element('editor').scrollIntoView({ block: 'start' });
}

/** @param {Pattern} pattern */
function keepDrawing(pattern) {
  /** @type {Chosen} */
  const choice = { title: drawing.title, caption: `Drawn here, ${points(count(pattern))}.`, source: sourceOf(pattern), isOwn: true };
  return { choice, card: keepOwn(choice, drawing.value, viewOf(pattern)) };
}

/** @param {Pattern} pattern */
function useDrawing(pattern) {
  unnotify();
  leaveLink();
  const { choice, card } = keepDrawing(pattern);
  card.checked = true;
  chosen = choice;
  isPrivate = true;
  // The border is the drawing's, but also the person's to change while the drawing keeps its own.
  if (pattern.boundary !== (drawing.woven ?? shown)?.boundary) {
    setBoundary(pattern.boundary);
    overrule('boundary');
  }
  drawing.woven = pattern;
  void begin(true);
}

/** @param {boolean} kept */
function onEditorClosed(kept) {
  stage.editing = false;
  if (kept) {
    // Another exemplar was chosen before the latest strokes were woven.
    if (editor.isChanged && editor.pattern !== drawing.woven && count(editor.pattern) > 0) keepDrawing(editor.pattern);
  } else {
    const { before, value, isNew, woven } = drawing;
    if (isNew) {
      ownCard(value)?.remove();
      forgetThumbnails();
    } else if (before.chosen.source.source === 'pattern') {
      keepOwn(before.chosen, value, viewOf(before.chosen.source.pattern));
    }
    chosen = before.chosen;
    isPrivate = chosen.source.source !== 'gallery' && chosen.isOwn === true;
    beyond = before.beyond;
    showBeyond();
    const input = ownCard(chosen.value ?? '')?.querySelector('input');
    if (input) input.checked = true;
    setBoundary(before.boundary);
    if (woven) void begin(true);
    if (editor.isChanged) {
      notify('The drawing was discarded.', {
        label: 'Bring it back',
        act: () => {
          stage.editing = true;
          drawing.woven = null;
          editor.reopen();
        },
      });
    }
  }
  element('edit').focus();
}

element('draw-own').addEventListener('click', () => draw(blank(), 'A new blank exemplar'));
element('edit').addEventListener('click', () => {
  const { source, title } = chosen;
  if (source.source === 'pattern') {
    const again = isDrawing(chosen);
    draw(source.pattern, again ? `Editing ${title}` : `Editing a copy of ${title}`, again);
  } else {
    void drawCopy();
  }
});

/** The exemplar to the last digit is only the worker's to give. */
async function drawCopy() {
  const { title, source } = chosen;
  try {
    const { pattern } = await link.ask({ type: 'open', exemplar: source });
    if (chosen.source === source) draw(pattern, `Editing a copy of ${title}`);
  } catch (error) {
    if (error instanceof Refused) complain(error.message);
    else if (!(error instanceof WorkerDied)) throw error;
  }
}

// ---------------------------------------------------------------------------------------------- links

/** The address's link, if it has one. */
const linkOf = () => (isLink(location.hash) ? location.hash.slice(1) : '');

/** The page has moved on from the link in its address. */
function leaveLink() {
  if (linkOf() === '') return;
  const rest = new URLSearchParams(location.hash.slice(1));
  const kept = ['embed', 'hide'].flatMap((name) => (rest.has(name) ? [`${name}=${rest.get(name)}`] : []));
  history.replaceState(history.state, '', location.pathname + location.search + (kept.length > 0 ? `#${kept.join('&')}` : ''));
}

/**
 * Does what a link says. Whatever would take long waits for a person to start it.
 *
 * @param {string} fragment
 * @param {boolean} play
 */
async function openLink(fragment, play) {
  const { exemplar, preset, overrides, parameters: all, notes, cost } = await files.readLink(fragment);
  const isGallery = 'gallery' in exemplar;
  /** @type {Source} */
  const source = isGallery
    ? { source: 'gallery', name: exemplar.gallery }
    : { source: 'pattern', name: 'Shared pattern', pattern: exemplar.pattern };
  const { exemplar: shown } = await link.ask({ type: 'open', exemplar: source });
  editor.close(true);
  if (isGallery) {
    const card = element('gallery').querySelector(`input[name="exemplar"][value="${CSS.escape(exemplar.gallery)}"]`);
    if (card) /** @type {HTMLInputElement} */ (card).checked = true;
    chosen = galleryChoices.get(exemplar.gallery) ?? { title: exemplar.gallery, caption: '', source };
    setBoundary(shown.boundary);
  } else {
    chosen = { title: 'Shared pattern', caption: `From a link, ${points(shown.points.classes.length)}.`, source };
    showOwn(chosen, shown);
    setBoundary(shown.boundary);
  }
  isPrivate = false;
  applySettings(preset, overrides);
  if (play && cost.autoRun) {
    await begin(true);
    if (notes.length > 0) notify(notes.join(' '));
    return;
  }
  waitForPerson(shown, all, notes, cost);
}

/**
 * Shows a link's exemplar, and how long its run would take.
 *
 * @param {PatternView} exemplar
 * @param {import('../common/messages.js').Parameters} all
 * @param {string[]} notes
 * @param {import('../common/files-messages.js').Cost} cost
 */
function waitForPerson(exemplar, all, notes, cost) {
  run.clear();
  [progress, parameters] = [null, null];
  chart.keep();
  const [x, y] = [Number(all['expansion-x']), Number(all['expansion-y'])];
  const boundary = all['boundary'] === 'periodic' ? 'periodic' : 'open';
  const size = /** @type {[number, number]} */ ([exemplar.size[0] * x, exemplar.size[1] * y]);
  const nothing = new Float32Array();
  const none = { positions: nothing, classes: new Uint16Array(), radii: nothing, scales: nothing, turns: nothing, depths: nothing, pinned: new Uint16Array() };
  stage.show(exemplar, { ...exemplar, points: none, size, boundary });
  element('exemplar-title').textContent = chosen.title;
  element('exemplar-caption').textContent = chosen.caption;
  element('exemplar-count').textContent = points(exemplar.points.classes.length);
  element('output-count').textContent = `${points(cost.points)} · ${[x, y].map(times).join(' ')}`;
  share.outdated();
  const words = `This link asks for ${points(cost.points)}; on the processor that takes about ${duration(cost.seconds)}.`;
  notify([...notes, words].join(' '), { label: 'Run', act: () => void begin(true) });
  announce(words);
}

/** Opens the address's link; says why when it can't. @returns {Promise<boolean>} whether it did */
async function openAddress() {
  try {
    await openLink(linkOf(), true);
    return true;
  } catch (error) {
    if (!(error instanceof Refused || error instanceof WorkerDied)) throw error;
    complainAbout('This link can’t be opened: ', error.message);
    return false;
  }
}

window.addEventListener('hashchange', () => {
  if (embedOptions(location).embed !== embedded) return location.reload();
  applyEmbedOptions();
  if (linkOf() !== '') {
    unnotify();
    void openAddress();
  }
});

/** The exemplar as a link holds it, so that whoever opens the link has the same run. @param {import('../common/messages.js').PatternData} pattern */
async function adopt(pattern) {
  await openPattern(chosen.title, chosen.caption, pattern, isPrivate);
  await begin(true);
}

element('open-whole').addEventListener('click', (event) => {
  event.preventDefault();
  // Opened at once: later, a browser would take it for an unasked window.
  const tab = window.open('about:blank', '_blank');
  void share.write().then(
    ({ fragment }) => tab && (tab.location.href = `${location.origin}${location.pathname}#${fragment}`),
    (error) => {
      tab?.close();
      complain(error instanceof Error ? error.message : String(error));
    },
  );
});

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

window.addEventListener('themechange', drawThumbnails);
new ResizeObserver(drawThumbnails).observe(element('gallery'));

/** Writes down where this tab stands, for a reload. @param {string} state of the run */
function keepSession(state) {
  session.keep({
    chosen,
    settings: readForm(settings),
    fragment: linkOf(),
    beyond,
    status: run.status,
    state,
    curve: chart.record,
  });
}

/** Puts the settings of another visit in place. @param {import('./session.js').Kept} kept */
function restore({ chosen: before, settings: values, curve, beyond: more }) {
  chosen = before;
  isPrivate = chosen.isOwn === true;
  beyond = more;
  showBeyond();
  const { engine: _, preset, boundary, ...rest } = values;
  fillForm(settings, rest);
  firstPreset = typeof preset === 'string' ? preset : firstPreset;
  if (boundary === 'open' || boundary === 'periodic') setBoundary(boundary);
  stage.tiles = /** @type {HTMLInputElement} */ (element('tiles')).checked;
  readSeed();
  showSliders();
  chart.record = curve;
}

/** Goes on with what this tab did before it was loaded again; false when there is nothing. */
async function continueSession() {
  const kept = await session.recall();
  // A link that was opened goes before what the tab did until then.
  if (!kept || (linkOf() !== '' && kept.fragment !== linkOf())) return false;
  restore(kept);
  const seed = readSeed();
  if (seed === null || kept.state === null) return begin(true);
  if (await run.resume(planned(seed), kept.state, kept.status !== 'paused')) return true;
  unnotify();
  return begin(true);
}

async function boot() {
  try {
    const continued = continueSession();
    await Promise.all([
      link.ask({ type: 'describe' }).then(showDescription),
      link.ask({ type: 'gallery' }).then(({ entries }) => showGallery(entries)),
    ]);
    booted = true;
    void keepForOffline();
    if (!(await continued) && (linkOf() === '' || !(await openAddress()))) {
      if (run.status === 'empty' && chosen !== galleryChoices.get(FIRST)) {
        // What was kept can't be used any more.
        unnotify();
        settings.reset();
        [chosen, firstPreset, knowsBoundary, beyond] = [galleryChoices.get(FIRST) ?? chosen, 'fast', false, {}];
        showBeyond();
        showSliders();
      }
      await begin(true);
    }
    host.listen();
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
    /** The exemplar as it stands in the open editor. */
    get drawing() {
      return editor.isOpen ? structuredClone(editor.pattern) : null;
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
const requested = address.get('url');
if (requested !== null) {
  // Asked once; a reload is no second question.
  const asked = new URL(location.href);
  asked.searchParams.delete('url');
  history.replaceState(history.state, '', asked);
  importer.openAddress(requested);
}
