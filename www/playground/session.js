// @ts-check
/**
 * Keeps a tab's work over a reload, in this browser only: the exemplar, the settings and the run as it was last saved.
 * Every tab has a session of its own, so that two don't overwrite each other; a new tab begins anew.
 */

/** @typedef {import('../common/messages.js').Source} Source */

/**
 * @typedef {object} Kept
 * @property {{ title: string, caption: string, source: Source, isOwn?: boolean, value?: string } & import('./state.js').FromFile} chosen
 * @property {Record<string, string | boolean>} settings
 * @property {string} fragment the address's link, when this was kept
 * @property {import('../common/messages.js').Parameters} beyond what no control shows
 * @property {import('./run.js').Status} status
 * @property {string | null} state of the run; null when there is none or it is too large
 * @property {{ losses: Record<string, number>[], scales: number[] }} curve
 */

/** Of what is stored; another one is as good as nothing. */
const VERSION = 1;
const DATABASE = 'pointweave';
const STORE = 'sessions';
/** Name of the tab's own in `sessionStorage`. */
const ID_KEY = 'pointweave.session';
const KEEP_MS = 7 * 24 * 3600 * 1000;
/** Characters of a state that are still kept; beyond, a reload starts the run anew. */
const LARGEST_STATE = 16_000_000;

/** @template T @param {IDBRequest<T>} request @returns {Promise<T>} */
const result = (request) =>
  new Promise((resolve, reject) => {
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error);
  });

/** @returns {Promise<IDBDatabase>} */
function openDatabase() {
  const request = indexedDB.open(DATABASE, 1);
  request.onupgradeneeded = () => void request.result.createObjectStore(STORE, { keyPath: 'id' });
  return result(request);
}

const newId = () => crypto.getRandomValues(new Uint32Array(4)).join('-');

/** @param {any} value @returns {value is Kept & { version: number }} whether it has the shape that is written here */
function isKept(value) {
  const { chosen, settings, beyond, state, curve } = value ?? {};
  return (
    value?.version === VERSION &&
    typeof chosen?.title === 'string' &&
    typeof chosen.caption === 'string' &&
    typeof chosen.source?.name === 'string' &&
    typeof settings === 'object' &&
    settings !== null &&
    typeof beyond === 'object' &&
    beyond !== null &&
    (state === null || typeof state === 'string') &&
    Array.isArray(curve?.losses) &&
    Array.isArray(curve.scales)
  );
}

export class Session {
  #id = '';
  /** @type {Promise<IDBDatabase> | null} */
  #database = null;
  /** The newest that waits to be written, and whether something is being written. */
  #next = /** @type {Kept | null} */ (null);
  #writing = false;

  /** @param {boolean} enabled whether anything is kept at all */
  constructor(enabled) {
    if (!enabled) return;
    try {
      this.#id = sessionStorage.getItem(ID_KEY) ?? '';
      this.#database = openDatabase();
      this.#database.catch(() => {});
    } catch {
      // Where nothing may be stored, a reload begins anew.
      this.#database = null;
    }
  }

  /** What this tab was doing; null when that is unknown or can't be read. @returns {Promise<Kept | null>} */
  async recall() {
    if (!this.#database) return null;
    const before = this.#id;
    try {
      if (!before || (await this.#isTaken(before))) {
        // A copy of a tab goes on with the same, under a name of its own.
        this.#id = newId();
        sessionStorage.setItem(ID_KEY, this.#id);
        void this.#isTaken(this.#id);
      }
      if (!before) return null;
      const store = (await this.#database).transaction(STORE).objectStore(STORE);
      const value = await result(store.get(before));
      return isKept(value) ? value : null;
    } catch {
      return null;
    }
  }

  /** Takes the name for as long as this tab lives. @param {string} id @returns {Promise<boolean>} whether another tab has it */
  #isTaken(id) {
    if (!navigator.locks) return Promise.resolve(false);
    return new Promise((resolve) => {
      navigator.locks
        .request(`${ID_KEY}.${id}`, { ifAvailable: true }, (lock) => {
          resolve(lock === null);
          return lock && new Promise(() => {});
        })
        .catch(() => resolve(false));
    });
  }

  /** @param {Kept} kept */
  keep(kept) {
    if (!this.#database) return;
    this.#next = kept;
    if (!this.#writing) void this.#write();
  }

  /** Writes what is newest, one after the other. */
  async #write() {
    this.#writing = true;
    try {
      const database = await /** @type {Promise<IDBDatabase>} */ (this.#database);
      await forgetOld(database);
      while (this.#next) {
        const { state, ...rest } = this.#next;
        this.#next = null;
        const short = state !== null && state.length <= LARGEST_STATE ? state : null;
        const record = { id: this.#id, version: VERSION, at: Date.now(), ...rest };
        await put(database, { ...record, state: short }).catch((error) => {
          if (short === null) throw error;
          // Perhaps there is room for the rest.
          return put(database, { ...record, state: null });
        });
      }
    } catch {
      // No room, or not allowed: a reload begins anew.
      this.#database = null;
    } finally {
      this.#writing = false;
    }
  }
}

/** @param {IDBDatabase} database @param {object} record */
function put(database, record) {
  const transaction = database.transaction(STORE, 'readwrite');
  transaction.objectStore(STORE).put(record);
  return new Promise((resolve, reject) => {
    transaction.oncomplete = resolve;
    transaction.onabort = () => reject(transaction.error);
  });
}

/** Sessions of tabs that are long gone. @param {IDBDatabase} database */
async function forgetOld(database) {
  const store = database.transaction(STORE, 'readwrite').objectStore(STORE);
  await new Promise((resolve, reject) => {
    const request = store.openCursor();
    request.onerror = () => reject(request.error);
    request.onsuccess = () => {
      const cursor = request.result;
      if (!cursor) return resolve(undefined);
      if (!(Date.now() - cursor.value.at < KEEP_MS)) cursor.delete();
      cursor.continue();
    };
  });
}
