// @ts-check
/** The playground: puts the parts together and starts the page. */
import { Files } from '../common/files.js';
import { points } from '../common/words.js';
import { WorkerLink } from '../common/worker-link.js';
import { isTest, patience, takeRequestedFile } from './address.js';
import { Compare } from './compare.js';
import { openConsole } from './console.js';
import { Drawing } from './drawing.js';
import { Host, applyEmbedOptions } from './embed.js';
import { Engine } from './engine.js';
import { Figures } from './figures.js';
import { Gallery } from './gallery.js';
import { Import } from './import/import.js';
import { listenToKeys } from './keyboard.js';
import './layout.js';
import { Links } from './links.js';
import { Look } from './look.js';
import { LossChart } from './loss-chart.js';
import { Notices } from './notices.js';
import { Opening } from './opening.js';
import { Running } from './running.js';
import { Session } from './session.js';
import { SessionView } from './session-view.js';
import { Settings } from './settings.js';
import { Share } from './share.js';
import { Stage } from './stage.js';
import { Start } from './start.js';
import { chooseExemplar, isPrivate, methodOf, pageStore } from './state.js';
import { Statistics } from './statistics.js';
import { Take } from './take.js';
import { lack } from './tools.js';
import { Touch } from './touch.js';
import { Transport } from './transport.js';

const embedded = applyEmbedOptions();
const store = pageStore();
const notices = new Notices();
/** @param {string} text */
const announce = (text) => notices.announce(text);
/** @param {string} message */
const complain = (message) => notices.complain(message);

const link = new WorkerLink(`./worker.js${isTest ? '?test=1' : ''}`, patience, onWorkerDeath);
const files = new Files();
const chart = new LossChart();
const look = new Look(files, () => {
  stage.restyle();
  gallery.redraw();
});
const stage = new Stage(look);
const running = new Running(store, link, notices, { started: onStarted, batch: onBatch, saved: (state) => tab.keep(state) });
const { run } = running;
const engine = new Engine(link, {
  announce,
  checks: (checks) => void (run.shares = checks),
  shows: (view) => store.update({ engine: view }),
});
const figures = new Figures(store, stage);
const touch = new Touch(stage, run, announce);
const compare = new Compare(stage, link, { announce, turned: onTurned, count: () => figures.count });
const statistics = new Statistics(link, { status: () => store.state.status, announce });
const gallery = new Gallery(store, look, (choice, boundary) => {
  drawing.leave();
  chooseExemplar(store, choice, boundary);
  running.beginSoon(false);
});
const settings = new Settings(store, () => running.beginSoon());
const drawing = new Drawing(store, running, gallery, notices, stage, link);
const parts = { store, running, gallery, settings, drawing, notices, chart, files, link };
const opening = new Opening(parts);

const chosen = () => store.state.chosen;
const take = new Take(files, link, run, stage, { look: () => look.choice, chosen, complain, announce });
const share = new Share(files, {
  chosen,
  plan: () => running.currentPlan,
  adopt: (pattern) => void opening.adopt(pattern),
  saveProject: () => take.project(),
  announce,
});
const links = new Links(parts, stage, share, embedded);
/** A page in a frame is its host's to keep. */
const tab = new SessionView(store, running, new Session(window === window.top && !embedded), chart, notices);
const host = new Host({
  state: () => {
    const { status, points: count, progress, parameters } = store.state;
    // The name of an own file is the person's own, too.
    return { status, title: isPrivate(store.state) ? '' : chosen().title, points: count, progress, parameters };
  },
  play: () => void (run.status !== 'playing' && running.toggle()),
  pause: () => run.pause(),
  step: () => run.step(),
  reset: () => running.reset(),
  openLink: (fragment, play) => links.open(fragment, play),
  openData: (name, bytes, play) => opening.data(name, bytes, play),
  points: () => run.export(),
  isPrivate: () => isPrivate(store.state),
});
const importer = new Import(files, look, { use: (imported) => void opening.imported(imported) });
new Transport(store, running);

// ---------------------------------------------------------------------------------------------- what follows the state

store.subscribe(({ settings: { tiles } }) => tiles, (tiles) => {
  stage.tiles = tiles;
  touch.changed();
});
store.subscribe((state) => methodOf(state, state.settings.method), (method) => method && engine.withholdGpu(lack(method, 'gpu')));
store.subscribe((state) => methodOf(state, state.plan?.method ?? state.settings.method), (method) => {
  if (!method) return;
  chart.describe(method.losses);
  touch.offer(method);
});
store.subscribe(({ iterationsPerSecond }) => iterationsPerSecond, (perSecond) => void (engine.speed = perSecond));
store.subscribe(({ result }) => result, (result) => {
  if (result) take.describe(points(store.state.points), result.boundary === 'periodic');
  share.outdated();
});
store.subscribe(({ status }) => status, (status) => {
  if (status === 'finished') {
    announce('Finished.');
    compare.finished();
  }
  touch.changed();
  host.tell('status');
  statistics.turned();
});

// ---------------------------------------------------------------------------------------------- what the run and the worker say

/** @param {import('../common/messages.js').StartedResponse} started */
function onStarted({ exemplar, output, parameters, progress }) {
  chart.keep(progress.totalIterations);
  look.show(exemplar);
  stage.show(exemplar, output);
  touch.started();
  compare.started(parameters, chosen().source);
  if (chosen().source.source !== 'gallery' && !gallery.has(chosen().value)) gallery.keepOwn(chosen(), exemplar);
  engine.ensure();
  statistics.restart();
}

/** @param {import('../common/messages.js').BatchResponse} batch */
function onBatch({ events, engine: view, note, points: moved }) {
  for (const event of events) {
    if (event.type === 'iterated') chart.add(event.losses);
    // A scale also starts anew where another engine takes it over.
    else if (event.type === 'scale-started' && event.progress.iteration === 0) chart.beginScale();
  }
  if (view) engine.change(view, note);
  if (!moved) return;
  stage.move(moved);
  touch.changed();
  statistics.moved();
}
// Told of what the state says after a batch.
store.subscribe(({ progress }) => progress, () => host.tell('progress'));

function onTurned() {
  store.update({ showsKept: stage.showsKept });
  touch.changed();
}

/** @param {string} reason */
function onWorkerDeath(reason) {
  engine.workerDied();
  if (store.state.booted) return running.workerDied(reason);
  run.workerDied();
  notices.notify(`The computation could not start: ${reason}.`, { label: 'Try again', act: () => void start.boot() });
}

// ---------------------------------------------------------------------------------------------- start

const start = new Start(parts, { engine, look, links, tab, host });
openConsole({ store, running, stage, drawing, chart, look, statistics, link });
listenToKeys(running);
void start.boot();
const requested = takeRequestedFile();
if (requested !== null) importer.openAddress(requested);
