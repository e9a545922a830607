// @ts-check
/**
 * The periodograms of exemplar and result in two dimensions, side by side: on the same axes and the same colour scale,
 * so that what differs is the patterns.
 */
import { prepare } from '../common/draw.js';

/** @typedef {import('../common/messages.js').SpectrumView} SpectrumView */
/** @typedef {import('../common/messages.js').AnalyzedResponse['periodogram']} Periodogram */

/** Room for the numbers of the axes. */
const LEFT = 18;
const FOOT = 15;
const REST = 4;
/** The strongest share of all waves shares the last colour; without a limit one peak would leave the rest pale. */
const TOP_SHARE = 0.002;
/** In multiples of chance: of a pattern without order the scale shows chance, not noise. */
const LEAST_TOP = 4;
const SHADES = 256;

/** @param {string} id */
const element = (id) => /** @type {HTMLElement} */ (document.getElementById(id));

/** @param {number} value */
const two = (value) => value.toFixed(2);
/** @param {number} value */
const rounded = (value) => (value < 10 ? value.toFixed(1) : value.toFixed(0));

/**
 * The strongest wave: its frequency in cycles per d, the direction of its crests' normal, its power.
 *
 * @param {SpectrumView} spectrum
 */
function strongest({ width, height, power, reach: [reachX, reachY] }) {
  let best = 0;
  for (let index = 1; index < power.length; index++) if (power[index] > power[best]) best = index;
  const along = (/** @type {number} */ place, /** @type {number} */ size, /** @type {number} */ reach) =>
    size > 1 ? ((2 * place) / (size - 1) - 1) * reach : 0;
  const [x, y] = [along(best % width, width, reachX), along(Math.floor(best / width), height, reachY)];
  return { frequency: Math.hypot(x, y), degrees: Math.round((Math.atan2(y, x) * 180) / Math.PI + 180) % 180, power: power[best] };
}

/** The power that gets the last colour. @param {SpectrumView[]} spectra */
function topOf(spectra) {
  const all = Float32Array.from(spectra.flatMap(({ power }) => [...power])).sort();
  return Math.max(LEAST_TOP, all[Math.floor((1 - TOP_SHARE) * (all.length - 1))] ?? 0);
}

/** Colours from nothing to the strongest as bytes, of the page's own, in whatever form its style sheet has them. */
function shades() {
  const style = getComputedStyle(document.documentElement);
  const ramp = document.createElement('canvas');
  [ramp.width, ramp.height] = [SHADES, 1];
  const context = /** @type {CanvasRenderingContext2D} */ (ramp.getContext('2d', { willReadFrequently: true }));
  const gradient = context.createLinearGradient(0, 0, SHADES, 0);
  for (const [place, name] of /** @type {[number, string][]} */ ([[0, '--card'], [0.55, '--accent'], [1, '--ink']])) {
    gradient.addColorStop(place, style.getPropertyValue(name).trim());
  }
  context.fillStyle = gradient;
  context.fillRect(0, 0, SHADES, 1);
  return context.getImageData(0, 0, SHADES, 1).data;
}

export class Spectra {
  #canvases = /** @type {HTMLCanvasElement[]} */ ([element('spectrum-exemplar'), element('spectrum-output')]);
  /** @type {SpectrumView[]} */
  #spectra = [];
  #frame = 0;

  constructor() {
    const again = () => {
      cancelAnimationFrame(this.#frame);
      this.#frame = requestAnimationFrame(() => this.#draw());
    };
    const watcher = new ResizeObserver(again);
    for (const canvas of this.#canvases) watcher.observe(canvas);
    window.addEventListener('themechange', again);
  }

  /** @param {Periodogram} periodogram */
  show({ exemplar, output }) {
    this.#spectra = [exemplar, output];
    element('spectra').hidden = false;
    for (const [index, spectrum] of this.#spectra.entries()) {
      const { frequency, degrees, power } = strongest(spectrum);
      this.#canvases[index].setAttribute(
        'aria-label',
        `Periodogram of the ${index === 0 ? 'exemplar' : 'result'} along x and y: strongest at ${two(frequency)} cycles per d ` +
          `in the direction of ${degrees}°, ${rounded(power)} times chance.`,
      );
    }
    const scale = `Waves along x and y, in cycles per d. Strongest colour: ${rounded(topOf(this.#spectra))} times chance or more.`;
    element('spectra-scale').textContent = scale;
    this.#draw();
  }

  #draw() {
    if (this.#spectra.length === 0) return;
    const top = topOf(this.#spectra);
    const reach = Math.max(...this.#spectra.flatMap((spectrum) => spectrum.reach));
    const colours = shades();
    for (const [index, canvas] of this.#canvases.entries()) {
      if (canvas.clientWidth > 0) drawOne(canvas, this.#spectra[index], { top, reach, colours });
    }
  }
}

/**
 * @param {HTMLCanvasElement} canvas
 * @param {SpectrumView} spectrum
 * @param {{ top: number, reach: number, colours: Uint8ClampedArray }} scale `reach` of the axes in cycles per d
 */
function drawOne(canvas, { width, height, power, reach: [reachX, reachY] }, { top, reach, colours }) {
  const [across, down] = [canvas.clientWidth, canvas.clientHeight];
  const side = Math.min(across - LEFT - REST, down - FOOT - REST);
  const [left, upper] = [LEFT, REST];
  const map = document.createElement('canvas');
  [map.width, map.height] = [width, height];
  const pixels = new ImageData(width, height);
  for (let index = 0; index < power.length; index++) {
    // The root brings out weak waves beside a strong one.
    const shade = Math.round((SHADES - 1) * Math.sqrt(Math.min(Math.max(power[index] / top, 0), 1)));
    pixels.data.set(colours.subarray(4 * shade, 4 * shade + 4), 4 * index);
  }
  /** @type {CanvasRenderingContext2D} */ (map.getContext('2d')).putImageData(pixels, 0, 0);

  const context = prepare(canvas, across, down);
  const style = getComputedStyle(canvas);
  const colour = (/** @type {string} */ name) => style.getPropertyValue(name).trim();
  context.imageSmoothingEnabled = false;
  // A value stands for the square around its frequency, so the outermost reach half a step further.
  const size = (/** @type {number} */ values, /** @type {number} */ own) => (own / reach) * (values > 1 ? values / (values - 1) : 1) * side;
  const [mapWidth, mapHeight] = [size(width, reachX), size(height, reachY)];
  context.save();
  context.beginPath();
  context.rect(left, upper, side, side);
  context.clip();
  context.drawImage(map, left + (side - mapWidth) / 2, upper + (side - mapHeight) / 2, mapWidth, mapHeight);
  context.restore();

  context.strokeStyle = colour('--line-strong');
  context.strokeRect(left, upper, side, side);
  context.fillStyle = colour('--soft');
  context.font = `10px ${colour('--font')}`;
  const end = Number(reach.toPrecision(2));
  for (const value of [-end, 0, end]) {
    const place = ((value / reach + 1) / 2) * side;
    const text = value < 0 ? `−${-value}` : String(value);
    context.textAlign = value < 0 ? 'left' : value > 0 ? 'right' : 'center';
    context.textBaseline = 'top';
    context.fillText(text, left + Math.min(Math.max(place, 0), side), upper + side + 3);
    context.textAlign = 'right';
    context.textBaseline = value < 0 ? 'top' : value > 0 ? 'bottom' : 'middle';
    context.fillText(text, left - 3, upper + Math.min(Math.max(place, 0), side));
  }
}
