// @ts-check
/**
 * A person's line to a host, and the host: serves a folder as static hosts do, as slowly as asked for.
 *
 * - All answers share one line down: packets of all requests under way take turns at so many bits a second. A packet
 *   arrives half a round trip after it was sent.
 * - A request takes half a round trip. The first one on a connection waits two round trips more, for TCP and TLS 1.3.
 *   All of a page's requests share a connection, as HTTP/2 has it.
 * - Bodies are compressed with gzip or brotli at the levels hosts use, headers are those of the folder's `_headers`, and
 *   files have an ETag, so that what the browser has already is answered with 304.
 *
 * Not imitated: TCP's slow start, loss, the browser's priorities (all answers under way get the same share), the line up.
 */
import { createHash } from 'node:crypto';
import { readFile, readdir } from 'node:fs/promises';
import { createSecureServer } from 'node:http2';
import { extname, join } from 'node:path';
import { brotliCompressSync, constants, gzipSync } from 'node:zlib';

import { makeCertificate } from './certificate.mjs';

/** What fits into a packet of Ethernet. */
const PACKET_BYTES = 1460;

/** @type {Record<string, string>} */
const TYPES = {
  '.html': 'text/html; charset=utf-8',
  '.js': 'text/javascript; charset=utf-8',
  '.css': 'text/css; charset=utf-8',
  '.json': 'application/json',
  '.svg': 'image/svg+xml',
  '.png': 'image/png',
  '.wasm': 'application/wasm',
};

/** @typedef {'gzip' | 'br' | 'identity'} Encoding */
/** @typedef {{ path: string, status: number, bytes: number, asked: number, begun: number, arrived: number | null }} Transfer
 *   `asked`, `begun` and `arrived` in milliseconds since the epoch, at the browser's end of the line */

/** @typedef {{ size: number, deliver: () => void }} Packet */

/** Sends packets of several senders by turns; what was sent first arrives first. */
class Line {
  /** Those that have something to send; the first is next. @type {Packet[][]} */
  #senders = [];
  /** When the line has sent what it was given. */
  #free = 0;
  /** @type {{ due: number, deliver: () => void }[]} */
  #underWay = [];
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  #timer;

  /** @param {number} bitsPerSecond @param {number} delayMs from one end to the other */
  constructor(bitsPerSecond, delayMs) {
    this.bytesPerMs = bitsPerSecond / 8000;
    this.delayMs = delayMs;
  }

  /** @param {Packet[]} packets in their order */
  send(packets) {
    // A line that had nothing to send saves nothing up; a timer that came late may catch up.
    if (this.#senders.length === 0) this.#free = Math.max(this.#free, performance.now());
    this.#senders.push(packets);
    this.#pump();
  }

  #pump() {
    clearTimeout(this.#timer);
    const now = performance.now();
    while (this.#senders.length > 0 && this.#free <= now) {
      const sender = /** @type {Packet[]} */ (this.#senders.shift());
      const packet = sender.shift();
      if (!packet) continue;
      this.#free += packet.size / this.bytesPerMs;
      this.#underWay.push({ due: this.#free + this.delayMs, deliver: packet.deliver });
      this.#senders.push(sender);
    }
    while (this.#underWay.length > 0 && this.#underWay[0].due <= now) this.#underWay.shift()?.deliver();
    const next = Math.min(this.#senders.length > 0 ? this.#free : Infinity, this.#underWay[0]?.due ?? Infinity);
    if (next < Infinity) this.#timer = setTimeout(() => this.#pump(), Math.max(1, next - now));
  }
}

/** @param {Buffer} bytes @param {Encoding} encoding */
function compress(bytes, encoding) {
  if (encoding === 'gzip') return gzipSync(bytes, { level: 6 });
  if (encoding === 'br') return brotliCompressSync(bytes, { params: { [constants.BROTLI_PARAM_QUALITY]: 5 } });
  return bytes;
}

/** The headers of all files, in the layout of `_headers`. @param {string} folder @returns {Promise<Record<string, string>>} */
async function readHeaders(folder) {
  const lines = (await readFile(join(folder, '_headers'), 'utf8')).split('\n');
  return Object.fromEntries(
    lines.filter((line) => line.startsWith('  ')).map((line) => {
      const [name, ...value] = line.trim().split(': ');
      return [name, value.join(': ')];
    }),
  );
}

/** @param {string} folder @returns {Promise<string[]>} */
async function list(folder, prefix = '') {
  const entries = await readdir(join(folder, prefix), { withFileTypes: true });
  const nested = entries.map((entry) => {
    const path = prefix === '' ? entry.name : `${prefix}/${entry.name}`;
    return entry.isDirectory() ? list(folder, path) : [path];
  });
  return (await Promise.all(nested)).flat();
}

/**
 * Serves a built page on a free port.
 *
 * @param {string} folder
 * @param {{ bitsPerSecond: number, roundTripMs: number, encoding: Encoding }} options
 */
export async function serveSlowly(folder, { bitsPerSecond, roundTripMs, encoding }) {
  const headers = await readHeaders(folder);
  /** @type {Map<string, { body: Buffer, head: Record<string, string> }>} */
  const files = new Map();
  for (const path of await list(folder)) {
    const type = TYPES[extname(path)];
    if (!type) continue;
    const bytes = await readFile(join(folder, path));
    // Pictures of pixels are compressed as they are.
    const coding = extname(path) === '.png' ? 'identity' : encoding;
    const head = { ...headers, 'content-type': type, etag: `"${createHash('sha256').update(bytes).digest('hex').slice(0, 20)}"` };
    files.set(path, {
      body: compress(bytes, coding),
      head: coding === 'identity' ? head : { ...head, 'content-encoding': coding, vary: 'accept-encoding' },
    });
  }

  const half = roundTripMs / 2;
  const line = new Line(bitsPerSecond, half);
  /** @type {Transfer[]} */
  const transfers = [];
  let underWay = 0;
  const greeted = new WeakSet();
  const { key, cert, pin } = makeCertificate();
  const server = createSecureServer({ key, cert }, (request, response) => {
    const { pathname } = new URL(request.url ?? '/', 'http://page');
    const path = decodeURIComponent(pathname).replace(/^\//, '').replace(/(^|\/)$/, '$1index.html');
    const file = files.get(path);
    const status = !file ? 404 : request.headers['if-none-match'] === file.head.etag ? 304 : 200;
    const head = file?.head ?? { 'content-type': 'text/plain' };
    const body = status === 200 && file ? file.body : Buffer.alloc(0);
    const text = Object.entries(head).reduce((length, [name, value]) => length + name.length + value.length + 4, 60);
    /** @type {Transfer} */
    const transfer = { path, status, bytes: text + body.length, asked: Date.now(), begun: 0, arrived: null };
    transfers.push(transfer);
    underWay++;
    const connection = request.stream.session ?? request;
    const handshakes = greeted.has(connection) ? 0 : 2 * roundTripMs;
    greeted.add(connection);

    /** @type {Packet[]} */
    const packets = [];
    for (let sent = 0; sent === 0 || sent < body.length; sent += PACKET_BYTES) {
      const piece = body.subarray(sent, sent + PACKET_BYTES);
      const isLast = sent + PACKET_BYTES >= body.length;
      const isFirst = sent === 0;
      packets.push({
        size: piece.length + (isFirst ? text : 0),
        deliver: () => {
          if (isFirst) {
            transfer.begun = Date.now();
            response.writeHead(status, status === 304 ? head : { ...head, 'content-length': body.length });
          }
          if (piece.length > 0) response.write(piece);
          if (!isLast) return;
          response.end();
          transfer.arrived = Date.now();
          underWay--;
        },
      });
    }
    setTimeout(() => line.send(packets), half + handshakes);
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', () => resolve(undefined)));
  const { port } = /** @type {import('node:net').AddressInfo} */ (server.address());
  return {
    url: `https://127.0.0.1:${port}/`,
    /** For `--ignore-certificate-errors-spki-list`. */
    pin,
    transfers,
    get isIdle() {
      return underWay === 0;
    },
    close: () => new Promise((resolve) => server.close(() => resolve(undefined))),
  };
}
