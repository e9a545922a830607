// @ts-check
/** What the import says about a place in a file and about an address, without a page. */
import assert from 'node:assert/strict';
import { createServer } from 'node:http';
import { describe, test } from 'node:test';

import { fetchBytes, nameOf, NotFetched, requestedAddress, webAddress } from '../../www/common/fetching.js';
import { offending } from '../../www/playground/import/offending.js';

/** The marked part of the line that is wrong. @param {string} text @param {number} line @param {number | null} column */
function marked(text, line, column) {
  const found = offending(text, { line, column }).find(({ number }) => number === line);
  return found && (found.mark ? found.text.slice(...found.mark) : null);
}

describe('the place of an error', () => {
  test('is a field of a table, whatever separates them', () => {
    assert.equal(marked('x,y\n0.5,oops\n1,2', 2, 2), 'oops');
    assert.equal(marked('x;y\r\n0,5;oops', 2, 2), 'oops');
    assert.equal(marked('x\ty\r0.5\toops', 2, 2), 'oops');
    assert.equal(marked('# a, b\n0.5  0.25\n  0.5 oops', 3, 2), 'oops');
    assert.equal(marked('name,x,y\n"a, ""b""",nope,2', 2, 2), 'nope');
    assert.equal(marked('x,y\n0.5,', 2, 2), ' ', 'an empty field is pointed at');
    assert.equal(marked('x y\n0.5', 2, 2), null, 'a missing one can not be');
  });

  test('is a character of JSON and SVG', () => {
    assert.equal(marked('[[0, 1],\n [2, x]]', 2, 6), 'x');
    assert.equal(marked(' <svg>\n<circle r="?"/>', 2, 12), '?');
  });

  test('comes with the lines around it, and a long line is cut there', () => {
    const lines = offending('a\nb\nc\nd', { line: 2, column: null });
    assert.deepEqual(lines.map(({ number, text }) => [number, text]), [[1, 'a'], [2, 'b'], [3, 'c']]);
    const long = `[${'[0.5,0.5],'.repeat(3000)}x`;
    const [cut] = offending(long, { line: 1, column: long.length });
    assert.ok(cut.text.length < 110 && cut.text.startsWith('…'));
    assert.equal(marked(long, 1, long.length), 'x');
    const middle = `[${'[0.5,0.5],'.repeat(300)}?${'[0.5,0.5],'.repeat(300)}`;
    assert.equal(marked(middle, 1, middle.indexOf('?') + 1), '?');
    assert.deepEqual(offending('a', { line: 7, column: 1 }), []);
  });
});

describe('an address', () => {
  test('is told from points', () => {
    assert.equal(webAddress(' https://example.org/a.csv\n')?.href, 'https://example.org/a.csv');
    for (const text of ['0.5 0.5', 'https://a.org\nhttps://b.org', 'javascript:alert(1)', 'see https://a.org', 'file:///etc/passwd']) {
      assert.equal(webAddress(text), null, text);
    }
  });

  test('may be relative, but must be of the web and without a password', () => {
    const base = 'https://points.example/app/index.html';
    assert.equal(requestedAddress('../data/a.csv', base).href, 'https://points.example/data/a.csv');
    assert.equal(requestedAddress('http://other.example/a', base).host, 'other.example');
    for (const text of ['javascript:alert(1)', 'data:text/csv,1', 'file:///etc/passwd', 'https://me:secret@other.example/', 'https://']) {
      assert.throws(() => requestedAddress(text, base), NotFetched, text);
    }
  });

  test('names its file', () => {
    assert.equal(nameOf(new URL('https://a.org/some/my%20trees.csv?x=1')), 'my trees.csv');
    assert.equal(nameOf(new URL('https://a.org/some/')), 'some');
    assert.equal(nameOf(new URL('https://a.org/')), 'a.org');
    assert.equal(nameOf(new URL('https://a.org/%ff')), '%ff');
  });
});

describe('a file from an address', () => {
  test('is read up to a limit, whatever the site says of its length', { timeout: 30_000 }, async () => {
    Object.assign(globalThis, { location: new URL('https://page.example/') });
    let sent = 0;
    const server = createServer((request, response) => {
      if (request.url === '/missing') return void response.writeHead(404).end();
      if (request.url === '/short') return void response.end('1 2\n3 4\n');
      if (request.url === '/announced') return void response.writeHead(200, { 'Content-Length': 5000 }).flushHeaders();
      // Without a length, and without an end.
      const timer = setInterval(() => {
        response.write('x'.repeat(400));
        sent += 400;
      }, 5);
      response.on('close', () => clearInterval(timer));
    });
    await new Promise((resolve) => server.listen(0, '127.0.0.1', () => resolve(undefined)));
    const { port } = /** @type {import('node:net').AddressInfo} */ (server.address());
    const get = (/** @type {string} */ path, signal = new AbortController().signal) => fetchBytes(new URL(`http://127.0.0.1:${port}${path}`), 1000, signal);
    try {
      assert.equal(new TextDecoder().decode(await get('/short')), '1 2\n3 4\n');
      await assert.rejects(get('/missing'), /answers 404/);
      await assert.rejects(get('/announced'), NotFetched, 'nothing of it has to come first');
      await assert.rejects(get('/endless'), NotFetched);
      assert.ok(sent < 100_000, `${sent} bytes were sent`);
      const abort = new AbortController();
      const waits = get('/endless', abort.signal);
      abort.abort();
      await assert.rejects(waits, (error) => !(error instanceof NotFetched), 'who gives up is not told that it failed');
    } finally {
      server.close();
      server.closeAllConnections();
    }
  });
});
