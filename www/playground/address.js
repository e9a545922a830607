// @ts-check
/** What the page's address says: a link to open, a file to load, and what a test wants. */

const query = new URLSearchParams(location.search);

/** `?test=1` lets a test make the worker die; `&patience=` says after how many milliseconds of silence it counts as dead. */
export const isTest = query.get('test') === '1';
export const patience = isTest ? Number(query.get('patience')) || 30_000 : 30_000;

/** `&with=channels:4,grid-max:16` replaces parameters, so that a test can have a run that a slow device gets through. */
export const replaced = Object.fromEntries(
  ((isTest && query.get('with')) || '').split(',').map((pair) => pair.split(':')).filter(([, value]) => value)
    .map(([name, value]) => [name, Number(value)]),
);

/**
 * Whether a fragment is meant to be a link, also one whose signs were escaped on its way: the reader mends that, or says what is
 * wrong with it.
 *
 * @param {string} hash
 */
const isLink = (hash) => /^#?(.*(&|;|%26))?v(=|%(25)*3D)/i.test(hash);

/** The address's link, if it has one. */
export const linkInAddress = () => (isLink(location.hash) ? location.hash.slice(1) : '');

/** The page has moved on from the link in its address. */
export function leaveLink() {
  if (linkInAddress() === '') return;
  const rest = new URLSearchParams(location.hash.slice(1));
  const kept = ['embed', 'hide'].flatMap((name) => (rest.has(name) ? [`${name}=${rest.get(name)}`] : []));
  history.replaceState(history.state, '', location.pathname + location.search + (kept.length > 0 ? `#${kept.join('&')}` : ''));
}

/** The file that the address asks to load, once: a reload is no second question. @returns {string | null} */
export function takeRequestedFile() {
  const requested = query.get('url');
  if (requested === null) return null;
  const asked = new URL(location.href);
  asked.searchParams.delete('url');
  history.replaceState(history.state, '', asked);
  return requested;
}
