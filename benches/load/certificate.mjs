// @ts-check
/** A certificate for one start of the server: browsers speak HTTP/2 over TLS only. */
import { createHash, generateKeyPairSync, sign } from 'node:crypto';

/** DER: a tag, a length, a value. @param {number} tag @param {Uint8Array[]} parts */
function der(tag, ...parts) {
  const value = Buffer.concat(parts);
  const { length } = value;
  const size = length < 128 ? [length] : length < 256 ? [0x81, length] : [0x82, length >> 8, length & 255];
  return Buffer.concat([Buffer.from([tag, ...size]), value]);
}

const sequence = (/** @type {Uint8Array[]} */ ...parts) => der(0x30, ...parts);
const integer = (/** @type {number[]} */ ...bytes) => der(0x02, Buffer.from(bytes));
const bits = (/** @type {Uint8Array} */ value) => der(0x03, Buffer.from([0]), value);
/** ecdsa-with-SHA256, 1.2.840.10045.4.3.2 */
const ALGORITHM = sequence(der(0x06, Buffer.from('2a8648ce3d040302', 'hex')));
/** commonName, 2.5.4.3 */
const NAME = sequence(der(0x31, sequence(der(0x06, Buffer.from('550403', 'hex')), der(0x0c, Buffer.from('127.0.0.1')))));

/** @param {number} days from now */
const time = (days) => der(0x18, Buffer.from(new Date(Date.now() + days * 86_400_000).toISOString().replace(/[-:T]|\.\d+/g, '')));

/** @returns {{ key: string, cert: string, pin: string }} `pin`: the hash of its public key, for `--ignore-certificate-errors-spki-list` */
export function makeCertificate() {
  const { privateKey, publicKey } = generateKeyPairSync('ec', { namedCurve: 'P-256' });
  const spki = publicKey.export({ type: 'spki', format: 'der' });
  const body = sequence(der(0xa0, integer(2)), integer(1), ALGORITHM, NAME, sequence(time(-1), time(1)), NAME, spki);
  const whole = sequence(body, ALGORITHM, bits(sign('sha256', body, privateKey)));
  return {
    key: /** @type {string} */ (privateKey.export({ type: 'pkcs8', format: 'pem' })),
    cert: `-----BEGIN CERTIFICATE-----\n${whole.toString('base64')}\n-----END CERTIFICATE-----\n`,
    pin: createHash('sha256').update(spki).digest('base64'),
  };
}
