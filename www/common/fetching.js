// @ts-check
/** Points from a web address: asked for without cookies, never more than a file may have. */

/** A web address that can't be used, in words. */
export class NotFetched extends Error {}

/**
 * @param {string} text
 * @returns {URL | null} null when it is no web address
 */
export function webAddress(text) {
  const trimmed = text.trim();
  return /^https?:\/\/\S+$/i.test(trimmed) && URL.canParse(trimmed) ? new URL(trimmed) : null;
}

/**
 * What `?url=` names, relative to the page if it is of the same site.
 *
 * @param {string} text
 * @param {string} base
 * @returns {URL}
 */
export function requestedAddress(text, base) {
  if (!URL.canParse(text, base)) throw new NotFetched(`‘${text.slice(0, 200)}’ is no web address`);
  const url = new URL(text, base);
  if (url.protocol !== 'https:' && url.protocol !== 'http:') {
    throw new NotFetched(`an address must begin with https, not with ‘${url.protocol.slice(0, 20)}’`);
  }
  if (url.username || url.password) throw new NotFetched('an address with a name or password in it is not asked');
  return url;
}

/** The last part of the path, which may tell the format. @param {URL} url */
export function nameOf(url) {
  const last = url.pathname.split('/').findLast((part) => part !== '') ?? '';
  try {
    return decodeURIComponent(last) || url.hostname;
  } catch {
    return last;
  }
}

/**
 * @param {URL} url
 * @param {number} most bytes
 * @param {AbortSignal} signal
 */
export async function fetchBytes(url, most, signal) {
  /** @type {Response} */
  let response;
  try {
    response = await fetch(url, { mode: 'cors', credentials: 'omit', referrerPolicy: 'no-referrer', cache: 'no-store', signal });
  } catch (error) {
    if (signal.aborted) throw error;
    throw new NotFetched(
      url.origin === location.origin
        ? `the address ${url.href} can't be reached`
        : `the site ${url.host} can't be reached, or does not let other pages read its files; download the file and drop it here instead`,
    );
  }
  if (!response.ok) throw new NotFetched(`the site ${url.host} answers ${response.status}${response.statusText ? ` (${response.statusText})` : ''}`);
  const tooLarge = () => new NotFetched(`the file at ${url.host} has more than ${Math.round(most / 1e6)} MB; at most that many are read`);
  if (Number(response.headers.get('content-length')) > most) {
    // Nobody waits for the rest, also not for its end.
    response.body?.cancel().catch(() => {});
    throw tooLarge();
  }
  const chunks = [];
  let length = 0;
  const reader = /** @type {ReadableStream<Uint8Array>} */ (response.body ?? new Blob([]).stream()).getReader();
  try {
    for (;;) {
      const { done, value } = await reader.read();
      if (done) break;
      length += value.length;
      if (length > most) {
        reader.cancel().catch(() => {});
        throw tooLarge();
      }
      chunks.push(value);
    }
  } catch (error) {
    if (error instanceof NotFetched || signal.aborted) throw error;
    throw new NotFetched(`the site ${url.host} broke off in the middle of the file`);
  }
  const bytes = new Uint8Array(length);
  let offset = 0;
  for (const chunk of chunks) {
    bytes.set(chunk, offset);
    offset += chunk.length;
  }
  return bytes;
}
