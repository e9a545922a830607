// @ts-check
/** The built module in Node, and the native program it is held against. */
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

/** @typedef {import('../../www/common/messages.js').Request} Request */
/** @typedef {import('../../www/common/messages.js').Response} Response */
/**
 * The members of a saved state these tests look at; see `SynthesisState` in `src/synthesis.rs`.
 * @typedef {{ points: [number, number][], losses: number[], 'total-iterations': number,
 *   parameters: Record<string, unknown>, adam: { first: [number, number][] } }} State
 */

const ROOT = fileURLToPath(new URL('../../', import.meta.url));
const PACKAGE = join(process.env.POINTWEAVE_DIST ?? join(ROOT, 'dist'), 'pkg');

assert.ok(existsSync(PACKAGE), `there is no built module in ${PACKAGE}: run \`cargo xtask build\` first`);
/** @type {typeof import('/pkg/pointweave.js')} */
const module = await import(pathToFileURL(join(PACKAGE, 'pointweave.js')).href);
module.initSync({ module: readFileSync(join(PACKAGE, 'pointweave_bg.wasm')) });

/** @type {typeof import('/pkg/pointweave_files.js')} */
const files = await import(pathToFileURL(join(PACKAGE, 'pointweave_files.js')).href);
files.initSync({ module: readFileSync(join(PACKAGE, 'pointweave_files_bg.wasm')) });

/** What the worker for files asks of its module; see `www/common/files-messages.js`. */
export const answer = files.answer;

/** What a worker holds, driven without a worker. */
export class Session {
  #session = new module.WorkerSession();

  /**
   * @template {Request['type']} T
   * @param {Extract<Request, { type: T }>} request
   * @returns {import('../../www/common/messages.js').Answers[T]}
   */
  ask(request) {
    const response = /** @type {Response} */ (this.#session.handle(request));
    if (response.type === 'error') throw new Error(response.message);
    return /** @type {any} */ (response);
  }

  /** @param {string} name @param {Record<string, number | string>} overrides */
  start(name, overrides) {
    return this.ask({ type: 'start', exemplar: { source: 'gallery', name }, method: 'network', preset: 'fast', overrides });
  }

  /**
   * Runs until so many iterations are done.
   *
   * @param {number} count
   * @param {{ budgetMs: number, maxIterations: number }} piece how much to ask for at a time
   */
  run(count, { budgetMs, maxIterations }) {
    for (let left = count, requests = 0; left > 0; requests++) {
      assert.ok(requests < 100_000, 'the run goes on');
      const { events, finished } = this.ask({ type: 'run', budgetMs, maxIterations: Math.min(maxIterations, left) });
      left -= events.filter(({ type }) => type === 'iterated').length;
      assert.ok(left === 0 || !finished, `the run ended ${left} iterations early`);
    }
  }

  /** @param {State} state */
  resume(state) {
    return this.ask({ type: 'resume', state: JSON.stringify(state) });
  }

  /** @returns {State} */
  state() {
    return JSON.parse(this.ask({ type: 'save' }).state);
  }
}

/** Builds the native program of this tree, which is the one the module was built from, and says where it is. */
function buildNative() {
  const output = execFileSync(
    process.env.CARGO ?? 'cargo',
    ['build', '--locked', '--quiet', '--bin', 'pointweave', '--message-format=json'],
    { cwd: ROOT, encoding: 'utf8', maxBuffer: 1 << 28, stdio: ['ignore', 'pipe', 'inherit'] },
  );
  const built = output
    .split('\n')
    .filter((line) => line.startsWith('{'))
    .map((line) => JSON.parse(line))
    .find(({ executable, target }) => executable && target.name === 'pointweave');
  assert.ok(built, 'cargo names the program it has built');
  return /** @type {string} */ (built.executable);
}

/** @type {string | undefined} */
let native;

/**
 * The state of a native run after so many iterations altogether.
 *
 * @param {string[]} run what to run: an exemplar and its settings, or a state to continue
 * @param {number} count
 * @param {string} folder for its files
 * @returns {State}
 */
function advanceNative(run, count, folder) {
  native ??= buildNative();
  const state = join(folder, 'after.state');
  const stop = ['--max-iterations', String(count), '--save-state', state, '-o', join(folder, 'points.csv')];
  execFileSync(native, ['synth', '--quiet', ...run, ...stop], { stdio: ['ignore', 'inherit', 'inherit'] });
  return JSON.parse(readFileSync(state, 'utf8'));
}

/** @template T @param {(folder: string) => T} work @returns {T} */
function inFolder(work) {
  const folder = mkdtempSync(join(tmpdir(), 'pointweave-wasm-'));
  try {
    return work(folder);
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
}

/**
 * Runs natively from the start.
 *
 * @param {string} name of an exemplar in the gallery
 * @param {Record<string, number | string>} overrides
 * @param {number} count of iterations
 */
export function nativeState(name, overrides, count) {
  const settings = Object.entries(overrides).flatMap(([key, value]) => ['--set', `${key}=${value}`]);
  return inFolder((folder) => advanceNative([`gallery:${name}`, '--preset', 'fast', ...settings], count, folder));
}

/** Does one more iteration natively. @param {State} state */
export function nativeStep(state) {
  return inFolder((folder) => {
    const file = join(folder, 'before.state');
    writeFileSync(file, JSON.stringify(state));
    return advanceNative(['--resume', file], state['total-iterations'] + 1, folder);
  });
}
