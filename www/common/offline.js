// @ts-check
/** Keeps the page for when there is no network, and says so; see `sw.js`. */

/** @param {string} id */
const element = (id) => /** @type {HTMLElement} */ (document.getElementById(id));

/** Which build this tab is of. */
const version = document.documentElement.dataset.build ?? '';

/** @param {string} text */
const say = (text) => void (element('offline').textContent = text);

/** Tells a service worker which build this is. @param {ServiceWorker | null} worker */
function greet(worker) {
  worker?.postMessage({ version });
}

/** Registers the service worker. A browser without one has the page as long as there is a network. */
export async function keepForOffline() {
  if (!('serviceWorker' in navigator) || version === '') return;
  navigator.serviceWorker.addEventListener('message', ({ data }) => {
    // Only one that waits is asked.
    if (data?.version && data.version !== version) say('A newer version of this page is ready: reload to use it.');
  });
  try {
    // Both come to nothing where they are not allowed, as in a private window.
    const registration = await navigator.serviceWorker.register('./sw.js', { updateViaCache: 'none' });
    if (!registration) return;
    greet(registration.waiting);
    const follow = (/** @type {ServiceWorker | null} */ installing) =>
      installing?.addEventListener('statechange', () => {
        if (installing.state === 'installed') greet(registration.waiting);
      });
    follow(registration.installing);
    registration.addEventListener('updatefound', () => follow(registration.installing));
    await navigator.serviceWorker.ready;
    if (element('offline').textContent === '') say('Kept in this browser: it opens without a network, too.');
  } catch {
    // Then there is only what the browser's own cache holds.
  }
}
