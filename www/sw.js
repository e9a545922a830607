// @ts-check
/**
 * Keeps the page for when there is no network.
 *
 * The rule is that a tab never gets files of two builds. All files of a build are kept under its version, each checked
 * against its hash; a navigation asks the server for its version first, and if that is another one, or none at all,
 * the whole tab comes from the server. So a new build shows on the next load, and the kept one serves whoever is
 * offline or has the newest already. The next version's service worker waits until no tab of this one is left, or the
 * only tab there is says that it is of the new version.
 */
{
  /**
   * The page's files and their hashes. The build fills in both lines; without, as on a page that was never built,
   * nothing is kept.
   *
   * @type {Record<string, string>}
   */
  const FILES = {};
  const VERSION = '';

  const worker = /** @type {any} */ (self);
  const home = new URL('./', self.location.href);
  const prefix = `pointweave:${home.pathname}:`;
  const kept = prefix + VERSION;
  /** Holds the clients that are served by the network; this worker may be stopped and started any time. */
  const remote = `${prefix}remote`;
  /** Slower than this, the network counts as none. */
  const PATIENCE_MS = 3000;

  /** @param {string} path a page is asked for by its folder, as people do: hosts like to redirect its name */
  const address = (path) => new URL(path === 'index.html' ? './' : path, home).href;
  /** By content, so that the next version finds what has not changed. @param {string} path */
  const key = (path) => `${address(path)}?${encodeURIComponent(FILES[path])}`;

  /** @param {string} url @returns {string | null} the file that is meant */
  function pathOf(url) {
    const { origin, pathname } = new URL(url);
    if (origin !== home.origin || !pathname.startsWith(home.pathname)) return null;
    const path = pathname.slice(home.pathname.length) || 'index.html';
    return Object.hasOwn(FILES, path) ? path : null;
  }

  /** @param {string} path */
  async function fetchFile(path) {
    const response = await fetch(address(path), { integrity: FILES[path], cache: 'no-cache' });
    if (!response.ok) throw new Error(`${path}: status ${response.status}`);
    // What was redirected can't answer a navigation.
    return response.redirected ? new Response(await response.blob(), { headers: response.headers }) : response;
  }

  async function keepAll() {
    if (VERSION === '') return worker.skipWaiting();
    const cache = await caches.open(kept);
    await Promise.all(
      Object.keys(FILES).map(async (path) => {
        if (await cache.match(key(path))) return;
        await cache.put(key(path), (await caches.match(key(path))) ?? (await fetchFile(path)));
      }),
    );
  }

  async function forgetOthers() {
    for (const name of await caches.keys()) {
      if (name.startsWith(prefix) && name !== kept) await caches.delete(name);
    }
  }

  /** @returns {Promise<string | null>} the server's version, null when no server answers */
  async function serversVersion() {
    try {
      const response = await fetch(new URL('./version.json', home), {
        cache: 'no-store',
        signal: AbortSignal.timeout(PATIENCE_MS),
      });
      if (response.status >= 500) return null;
      return response.ok ? String((await response.json()).version) : 'unknown';
    } catch (error) {
      return error instanceof SyntaxError ? 'unknown' : null;
    }
  }

  /** @param {string} id */
  const mark = (id) => new URL(`./client/${id}`, home).href;

  /** @param {string} id of a client whose files are to come from the server */
  async function comesFromServer(id) {
    if (id) await (await caches.open(remote)).put(mark(id), new Response());
  }

  /** @param {Request} request @param {string} path */
  async function fromCache(request, path) {
    const cache = await caches.open(kept);
    return (await cache.match(key(path))) ?? fetch(request);
  }

  /** @param {any} event @param {string} path */
  async function navigate({ request, resultingClientId }, path) {
    const version = await serversVersion();
    if (version === null || version === VERSION) return fromCache(request, path);
    await comesFromServer(resultingClientId);
    // Whoever is offline the next time has what was seen now.
    worker.registration.update().catch(() => {});
    return fetch(request);
  }

  /** @param {any} event @param {string} path */
  async function deliver({ request, clientId, resultingClientId }, path) {
    if (!(await caches.match(mark(clientId), { cacheName: remote }))) return fromCache(request, path);
    // A worker belongs to its tab.
    await comesFromServer(resultingClientId);
    return fetch(request);
  }

  worker.addEventListener('install', (/** @type {any} */ event) => event.waitUntil(keepAll()));
  worker.addEventListener('activate', (/** @type {any} */ event) => event.waitUntil(forgetOthers()));
  worker.addEventListener('fetch', (/** @type {any} */ event) => {
    const { request } = event;
    const path = request.method === 'GET' ? pathOf(request.url) : null;
    if (path === null) return;
    event.respondWith(request.mode === 'navigate' ? navigate(event, path) : deliver(event, path));
  });
  /** A tab says of which version it is, and hears which one is here. */
  worker.addEventListener('message', (/** @type {any} */ event) => {
    const { version } = event.data ?? {};
    if (typeof version !== 'string') return;
    event.source?.postMessage({ version: VERSION });
    event.waitUntil(
      (async () => {
        const windows = await worker.clients.matchAll({ type: 'window', includeUncontrolled: true });
        if (version === VERSION && windows.length <= 1) await worker.skipWaiting();
      })(),
    );
  });
}
