// @ts-check
/**
 * The page's end of the line to the worker: asks, waits, and notices when nobody answers any more.
 */

/** @typedef {import('./messages.js').Request} Request */
/** @typedef {import('./messages.js').Answers} Answers */

/**
 * A worker that was started before the page's modules were there, and its WebAssembly; see `early.js`.
 * @typedef {{ url: string, worker: Worker, module: Promise<WebAssembly.Module | null>, failed: string | null }} Early
 */

/** A request the worker refused, with the sentence it gave; of a file also the place, and the columns there are to choose from. */
export class Refused extends Error {
  /** @param {import('./messages.js').ErrorResponse & { columns?: import('./files-messages.js').Column[] }} response */
  constructor(response) {
    super(response.message);
    this.place = response.place;
    this.columns = response.columns ?? [];
  }
}

/** The worker died before it answered. */
export class WorkerDied extends Error {}

export class WorkerLink {
  /** @type {Worker | null} */
  #worker = null;
  #nextId = 0;
  /** @type {Map<number, { type: string, resolve: (response: any) => void, reject: (error: Error) => void }>} */
  #waiting = new Map();
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  #watchdog;
  #url;
  #patienceMs;
  #onDeath;
  /** What is still to be taken over. @type {Early | null} */
  #early;
  /** The WebAssembly for workers that replace others. @type {Promise<WebAssembly.Module | null>} */
  #module;

  /**
   * @param {string} url of the worker's module
   * @param {number} patienceMs how long one answer may take before the worker counts as dead
   * @param {(reason: string) => void} onDeath called once a death, after every waiting request was rejected
   */
  constructor(url, patienceMs, onDeath) {
    this.#url = url;
    this.#patienceMs = patienceMs;
    this.#onDeath = onDeath;
    const { early } = /** @type {{ early?: Early }} */ (globalThis);
    this.#early = early?.url === url ? early : null;
    this.#module = this.#early?.module ?? Promise.resolve(null);
  }

  /** The worker that is there already; else a new one, with the WebAssembly that is there already. */
  #take() {
    const early = this.#early;
    this.#early = null;
    if (early) {
      // Also when it failed before anybody listened.
      if (early.failed !== null) queueMicrotask(() => early.worker === this.#worker && this.#bury(early.failed ?? ''));
      return early.worker;
    }
    const worker = new Worker(this.#url, { type: 'module' });
    void this.#module.then((module) => worker.postMessage({ module }));
    return worker;
  }

  /** Starts the worker if there is none. */
  #open() {
    if (this.#worker) return this.#worker;
    const worker = this.#take();
    worker.onmessage = ({ data }) => {
      if (worker !== this.#worker) return;
      if ('died' in data) {
        this.#bury(data.died);
        return;
      }
      const waiting = this.#waiting.get(data.id);
      this.#waiting.delete(data.id);
      this.#watch();
      if (data.response.type === 'error') waiting?.reject(new Refused(data.response));
      else waiting?.resolve(data.response);
    };
    worker.onerror = (event) => {
      event.preventDefault();
      if (worker === this.#worker) this.#bury(event.message || 'it could not be loaded');
    };
    worker.onmessageerror = () => {
      if (worker === this.#worker) this.#bury('a message could not be read');
    };
    this.#worker = worker;
    return worker;
  }

  /** Requests that must be answered soon. Opening a device takes as long as it takes; the worker knows when to stop. */
  get #urgent() {
    return [...this.#waiting.values()].filter(({ type }) => type !== 'engine').length;
  }

  /** Restarts the clock, or stops it when nothing urgent is being waited for. */
  #watch() {
    clearTimeout(this.#watchdog);
    if (this.#urgent === 0) return;
    const patience = this.#patienceMs;
    this.#watchdog = setTimeout(() => this.#bury(`no answer for ${Math.round(patience / 1000)} s`), patience);
  }

  /** @param {string} reason */
  #bury(reason) {
    clearTimeout(this.#watchdog);
    this.#worker?.terminate();
    this.#worker = null;
    const waiting = [...this.#waiting.values()];
    this.#waiting.clear();
    for (const { reject } of waiting) reject(new WorkerDied(reason));
    this.#onDeath(reason);
  }

  /**
   * Asks one question; a dead worker is replaced first.
   *
   * @template {Request} R
   * @param {R} request
   * @returns {Promise<Answers[R['type']]>}
   */
  ask(request) {
    const worker = this.#open();
    const id = this.#nextId++;
    return new Promise((resolve, reject) => {
      this.#waiting.set(id, { type: request.type, resolve, reject });
      if (this.#urgent === 1) this.#watch();
      worker.postMessage({ id, request });
    });
  }

  /**
   * Makes the worker die, or its device, for tests; it obeys only when its address says so.
   *
   * @param {'trap' | 'silence' | 'device'} how
   */
  crash(how) {
    return this.ask(/** @type {any} */ ({ type: 'crash', how })).catch(() => {});
  }
}
