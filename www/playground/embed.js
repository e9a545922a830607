// @ts-check
/**
 * The page inside another: without its own frame, with parts hidden, and with messages to and from the page around it.
 * The messages are described in `docs/embed.md`.
 */

/** Parts of the page that `hide=` can name, and where they are. */
export const PARTS = {
  gallery: '.rail',
  open: '.open',
  exemplar: '.figure.exemplar',
  editor: '#editor, #edit',
  loss: '.loss',
  statistics: '#statistics',
  deck: '.deck, #engine-line',
  step: '#step',
  reset: '#reset',
  engine: '#engine-line, [data-field="engine"]',
  settings: '#settings',
  quality: '[data-field="preset"]',
  size: '.field-group:has([data-field="expansion-x"])',
  border: '.field-group:has([data-field="boundary"])',
  seed: '[data-field="seed"]',
  share: '#share',
  take: '#take',
  theme: '.theme',
};

/** Version of the messages. */
const VERSION = 1;
/** A host that wants to follow hears no oftener than this. */
const PROGRESS_EVERY_MS = 100;

/** @param {Location} address */
export function embedOptions({ search, hash }) {
  const [query, fragment] = [new URLSearchParams(search), new URLSearchParams(hash.replace(/^#/, ''))];
  const embed = fragment.get('embed') === '1' || query.get('embed') === '1';
  const names = [query.get('hide'), fragment.get('hide')].flatMap((list) => list?.split(',') ?? []);
  const hide = new Set(names.map((name) => name.trim()).filter((name) => Object.hasOwn(PARTS, name)));
  return { embed, hide: /** @type {Set<keyof typeof PARTS>} */ (hide) };
}

/** Hides what the address says, now and whenever such a part comes. */
export function applyEmbedOptions() {
  const { embed, hide } = embedOptions(location);
  const root = document.documentElement;
  root.toggleAttribute('data-embed', embed);
  const without = [hide.has('gallery') && 'rail', hide.has('settings') && hide.has('share') && hide.has('take') && 'panel'];
  root.dataset.without = without.filter(Boolean).join(' ');
  root.dataset.hide = [...hide].join(' ');
  const sheet = new CSSStyleSheet();
  for (const part of hide) sheet.insertRule(`:is(${PARTS[part]}) { display: none !important; }`);
  document.adoptedStyleSheets = [sheet];
  return embed;
}

/**
 * @typedef {object} Hooks
 * @property {() => object} state what the page knows, as plain values
 * @property {() => void} play
 * @property {() => void} pause
 * @property {() => Promise<unknown>} step
 * @property {() => Promise<unknown>} reset
 * @property {(fragment: string, run: boolean) => Promise<void>} openLink refuses with an error whose message is a sentence
 * @property {(name: string, bytes: Uint8Array, run: boolean) => Promise<void>} openData the same
 * @property {() => Promise<import('../common/messages.js').PatternData>} points of the result
 * @property {() => boolean} isPrivate whether the points are the person's own, not the host's or the gallery's
 */

/** A message's own words that it can't be done. */
class Unusable extends Error {}

export class Host {
  #hooks;
  /** Who follows, and may be answered unasked. @type {{ source: WindowProxy, origin: string } | null} */
  #follower = null;
  #toldAt = 0;

  /** @param {Hooks} hooks */
  constructor(hooks) {
    this.#hooks = hooks;
  }

  /** Listens from now on, and says so. The first word goes to whoever holds the frame, and tells nothing. */
  listen() {
    if (window.parent === window) return;
    window.addEventListener('message', (event) => {
      // Only the page that holds the frame is listened to.
      if (event.source !== window.parent || event.data?.pointweave === undefined) return;
      void this.#answer(event);
    });
    window.parent.postMessage({ pointweave: VERSION, type: 'ready' }, '*');
  }

  /** The run has changed its state or gone on. @param {'status' | 'progress'} what */
  tell(what) {
    if (!this.#follower) return;
    const now = performance.now();
    if (what === 'progress' && now - this.#toldAt < PROGRESS_EVERY_MS) return;
    this.#toldAt = now;
    this.#post(this.#follower.source, this.#follower.origin, { type: what, ...this.#hooks.state() });
  }

  /**
   * To the origin that asked and no other. A page without an origin (a file, a sandbox) can't be named.
   *
   * @param {WindowProxy} source
   * @param {string} origin
   * @param {object} message
   * @param {Transferable[]} [transfer]
   */
  #post(source, origin, message, transfer = []) {
    source.postMessage({ pointweave: VERSION, ...message }, origin === 'null' ? '*' : origin, transfer);
  }

  /** @param {MessageEvent} event */
  async #answer({ data, origin, source }) {
    const asker = /** @type {WindowProxy} */ (source);
    const envelope = { of: String(data.type), ...(data.id !== undefined && { id: data.id }) };
    try {
      if (data.pointweave !== VERSION) throw new Unusable(`This page speaks version ${VERSION} of the messages.`);
      const { more, transfer } = await this.#do(data, asker, origin);
      this.#post(asker, origin, { type: 'done', ...envelope, ...more }, transfer);
    } catch (error) {
      const message = error instanceof Error ? error.message : String(error);
      this.#post(asker, origin, { type: 'refused', ...envelope, message });
    }
  }

  /**
   * @param {any} request
   * @param {WindowProxy} source
   * @param {string} origin
   * @returns {Promise<{ more?: object, transfer?: Transferable[] }>}
   */
  async #do(request, source, origin) {
    const hooks = this.#hooks;
    switch (request.type) {
      case 'state':
        return { more: hooks.state() };
      case 'play':
        hooks.play();
        return { more: hooks.state() };
      case 'pause':
        hooks.pause();
        return { more: hooks.state() };
      case 'step':
        await hooks.step();
        return { more: hooks.state() };
      case 'reset':
        await hooks.reset();
        return { more: hooks.state() };
      case 'follow':
        this.#follower = request.on === false ? null : { source, origin };
        return { more: hooks.state() };
      case 'points': {
        if (hooks.isPrivate()) throw new Unusable('These points are the person’s own; they stay on this machine.');
        const pattern = await hooks.points();
        return { more: { pattern }, transfer: [pattern.positions.buffer, pattern.classes.buffer] };
      }
      case 'load': {
        const { link, data, name = '', run = true } = request;
        if (typeof link === 'string') await hooks.openLink(link.slice(link.indexOf('#') + 1), run === true);
        else await hooks.openData(String(name), asBytes(data), run === true);
        return { more: hooks.state() };
      }
      default:
        throw new Unusable(`There is no message of type '${request.type}'.`);
    }
  }
}

/** @param {unknown} data */
function asBytes(data) {
  if (typeof data === 'string') return new TextEncoder().encode(data);
  if (data instanceof ArrayBuffer) return new Uint8Array(data);
  if (data instanceof Uint8Array) return data;
  throw new Unusable("A message 'load' has a 'link' or 'data': text, an ArrayBuffer or a Uint8Array.");
}
