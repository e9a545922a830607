// @ts-check
/**
 * The exemplar and the result at one scale. The points glide from where they are drawn to where they are, so that
 * ten batches a second look like a movement; a paused run is drawn exactly.
 */
import { areThings, drawPoints, markRadius, prepare, readColours } from './draw.js';

/** @typedef {import('./messages.js').PatternView} PatternView */
/** @typedef {import('./messages.js').Points} Points */

/** Room around the domain inside a canvas, so that marks on the border are whole. */
const MARGIN = 8;
/** The drawn points cover this share of their way in about 60 ms. */
const GLIDE_MS = 70;
/** Narrower than this, exemplar and result stand above each other. */
const STACK_BELOW = 520;
/** Room around the result in a picture of its own, as a share of its width. */
const PICTURE_MARGIN = 0.02;
/** The words below the exemplar need this much. */
const CAPTION_WIDTH = 170;
/** While the exemplar is edited the editor takes its place; this share of the width is left for the result. */
const RESULT_SHARE = 0.37;
/** The editor needs more width to have the result beside it. */
const STACK_EDITOR_BELOW = 680;

export class Stage {
  #figures = /** @type {HTMLElement} */ (document.getElementById('figures'));
  #exemplarCanvas = /** @type {HTMLCanvasElement} */ (document.getElementById('exemplar-canvas'));
  #outputCanvas = /** @type {HTMLCanvasElement} */ (document.getElementById('output-canvas'));
  #colours = readColours();
  /** Where the page is as high as the window, the figures must fit into what is left of it; see the style sheet. */
  #fits = matchMedia('(min-width: 1120px)');
  #reducedMotion = matchMedia('(prefers-reduced-motion: reduce)');
  /** @type {PatternView | null} */
  #exemplar = null;
  /** @type {PatternView | null} */
  #output = null;
  /** Where the points are drawn; on the way to where they are. */
  #drawn = new Float32Array();
  #tiles = false;
  #editing = false;
  #scale = 100;
  #frame = 0;
  #lastFrame = 0;

  #look;

  /** @param {import('./look.js').Look} look */
  constructor(look) {
    this.#look = look;
    new ResizeObserver(() => this.#layout()).observe(this.#figures);
    window.addEventListener('themechange', () => this.restyle());
  }

  /** Draws with the colours and glyphs as they are now. */
  restyle() {
    this.#colours = readColours();
    this.#layout();
  }

  /** Where the points are, in exemplar units. */
  get positions() {
    return this.#output?.points.positions ?? new Float32Array();
  }

  /**
   * Shows another run.
   *
   * @param {PatternView} exemplar
   * @param {PatternView} output
   */
  show(exemplar, output) {
    this.#exemplar = exemplar;
    this.#output = output;
    this.#drawn = output.points.positions.slice();
    this.#layout();
  }

  /** @param {Points} points */
  move(points) {
    if (!this.#output) return;
    this.#output.points = points;
    if (this.#drawn.length !== points.positions.length || this.#reducedMotion.matches) {
      this.#drawn = points.positions.slice();
    }
    this.#animate();
  }

  /** How high a picture of that width is. @param {number} width in pixels @param {boolean} tile */
  heightOf(width, tile) {
    const [wide, high] = this.#output?.size ?? [1, 1];
    // A tile has no margin.
    const margin = tile ? 0 : 2 * PICTURE_MARGIN * width;
    return Math.max(1, Math.round(((width - margin) * high) / wide + margin));
  }

  /**
   * The result as a picture of its own, in the page's colours.
   *
   * @param {number} width in pixels
   * @param {number} height
   * @param {boolean} tile whether it ends at the domain's border, so that copies side by side are seamless
   */
  render(width, height, tile) {
    const canvas = document.createElement('canvas');
    [canvas.width, canvas.height] = [width, height];
    const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
    context.fillStyle = this.#colours.card;
    context.fillRect(0, 0, width, height);
    if (!this.#output || !this.#exemplar) return canvas;
    const { points, size } = this.#output;
    const styles = this.#look.styles(this.#exemplar, this.#colours);
    const margin = tile ? 0 : PICTURE_MARGIN * width;
    const scale = (width - 2 * margin) / size[0];
    const radius = markRadius(this.#exemplar.spacing, scale, areThings(points, styles), Infinity);
    // Whole pixels on both sides: what a tile's height was rounded by, its points follow.
    context.setTransform(1, 0, 0, tile ? height / (size[1] * scale) : 1, 0, 0);
    // What reaches over a tile's border comes in on the other side.
    const around = tile ? [-1, 0, 1] : [0];
    for (const row of around) {
      for (const column of around) {
        const [left, top] = [margin + column * size[0] * scale, margin + row * size[1] * scale];
        drawPoints(context, this.#colours, points, { left, top, scale, radius, styles });
      }
    }
    return canvas;
  }

  /** @param {boolean} tiles whether to show the result three by three times */
  set tiles(tiles) {
    this.#tiles = tiles;
    this.#drawOutput();
  }

  /** @param {boolean} editing whether the editor stands in the exemplar's place */
  set editing(editing) {
    this.#editing = editing;
    this.#figures.toggleAttribute('data-editing', editing);
    this.#layout();
  }

  /** Finds the one scale at which both fit. */
  #layout() {
    if (!this.#exemplar || !this.#output) return;
    const { clientWidth: width, clientHeight: height } = this.#figures;
    const [exemplarWidth, exemplarHeight] = this.#exemplar.size;
    const [outputWidth, outputHeight] = this.#output.size;
    const figure = /** @type {HTMLElement} */ (this.#exemplarCanvas.parentElement);
    const alone = figure.offsetParent === null && !this.#editing;
    const stacked = width < (this.#editing ? STACK_EDITOR_BELOW : STACK_BELOW) && !alone;
    this.#figures.dataset.shape = stacked ? 'stacked' : 'beside';
    const head = 30;
    // A frame is as high as it is.
    const framed = document.documentElement.hasAttribute('data-embed');
    const room = this.#fits.matches || framed ? Math.max(height, framed ? 120 : 300) : 0.8 * window.innerHeight;
    let scale;
    if (alone) {
      scale = Math.min((width - 2 * MARGIN) / outputWidth, (room - head - 2 * MARGIN) / outputHeight);
    } else if (stacked) {
      scale = (width - 2 * MARGIN) / Math.max(outputWidth, exemplarWidth);
      scale = Math.min(scale, (window.innerHeight * 0.8) / outputHeight);
    } else {
      const gap = Number.parseFloat(getComputedStyle(this.#figures).columnGap) || 0;
      const free = width - gap - 4 * MARGIN;
      scale = free / (exemplarWidth + outputWidth);
      if (scale * exemplarWidth < CAPTION_WIDTH) scale = (free + 2 * MARGIN - CAPTION_WIDTH) / outputWidth;
      if (this.#editing) scale = (RESULT_SHARE * width - 2 * MARGIN) / outputWidth;
      scale = Math.min(scale, (room - head - 2 * MARGIN) / Math.max(outputHeight, exemplarHeight));
    }
    this.#scale = Math.max(scale, 8);
    const captionWidth = Math.max(this.#scale * exemplarWidth + 2 * MARGIN, CAPTION_WIDTH);
    figure.style.width = stacked ? '' : `${captionWidth}px`;
    this.#drawExemplar();
    this.#drawOutput();
  }

  /**
   * @param {HTMLCanvasElement} canvas
   * @param {PatternView} pattern
   */
  #size(canvas, pattern) {
    const width = pattern.size[0] * this.#scale + 2 * MARGIN;
    const height = pattern.size[1] * this.#scale + 2 * MARGIN;
    canvas.style.width = `${width}px`;
    canvas.style.height = `${height}px`;
    return { width, height, context: prepare(canvas, width, height) };
  }

  #drawExemplar() {
    if (!this.#exemplar) return;
    const { context } = this.#size(this.#exemplarCanvas, this.#exemplar);
    const { points, spacing } = this.#exemplar;
    const styles = this.#look.styles(this.#exemplar, this.#colours);
    drawPoints(context, this.#colours, points, {
      left: MARGIN,
      top: MARGIN,
      scale: this.#scale,
      radius: markRadius(spacing, this.#scale, areThings(points, styles)),
      styles,
      wrap: this.#wrap(this.#exemplar),
    });
  }

  /**
   * Marks wider than the margin come in on the other side of a tile.
   *
   * @param {PatternView} pattern
   */
  #wrap({ points, size, boundary }) {
    return boundary === 'periodic' && (points.radii.length > 0 || points.scales.length > 0) ? size : null;
  }

  #drawOutput() {
    if (!this.#output || !this.#exemplar) return;
    const { width, height, context } = this.#size(this.#outputCanvas, this.#output);
    const { size } = this.#output;
    const points = { ...this.#output.points, positions: this.#drawn };
    const periodic = this.#output.boundary === 'periodic';
    const tiles = this.#tiles && periodic ? 3 : 1;
    const scale = this.#scale / tiles;
    const styles = this.#look.styles(this.#exemplar, this.#colours);
    const radius = markRadius(this.#exemplar.spacing, scale, areThings(points, styles));
    const wrap = tiles === 1 ? this.#wrap(this.#output) : null;
    const [tileWidth, tileHeight] = [size[0] * scale, size[1] * scale];
    if (tiles === 1) {
      this.#ruler(context, width, height);
    }
    for (let row = 0; row < tiles; row++) {
      for (let column = 0; column < tiles; column++) {
        const centre = tiles === 1 || (row === 1 && column === 1);
        context.globalAlpha = centre ? 1 : 0.35;
        const left = MARGIN + column * tileWidth;
        const top = MARGIN + row * tileHeight;
        drawPoints(context, this.#colours, points, { left, top, scale, radius, styles, wrap });
      }
    }
    context.globalAlpha = 1;
    if (tiles > 1) {
      context.strokeStyle = this.#colours.lineStrong;
      context.strokeRect(MARGIN + tileWidth, MARGIN + tileHeight, tileWidth, tileHeight);
    }
  }

  /**
   * Small ticks on the frame, one an exemplar side, so that the expansion can be seen.
   *
   * @param {CanvasRenderingContext2D} context
   * @param {number} width
   * @param {number} height
   */
  #ruler(context, width, height) {
    if (!this.#exemplar || !this.#output) return;
    const [stepX, stepY] = this.#exemplar.size.map((side) => side * this.#scale);
    const tick = 5;
    context.beginPath();
    for (let x = MARGIN + stepX; x < width - MARGIN - 1; x += stepX) {
      context.moveTo(x, 0);
      context.lineTo(x, tick);
      context.moveTo(x, height);
      context.lineTo(x, height - tick);
    }
    for (let y = MARGIN + stepY; y < height - MARGIN - 1; y += stepY) {
      context.moveTo(0, y);
      context.lineTo(tick, y);
      context.moveTo(width, y);
      context.lineTo(width - tick, y);
    }
    context.strokeStyle = this.#colours.lineStrong;
    context.lineWidth = 1;
    context.stroke();
  }

  /** Draws until the drawn points have arrived. */
  #animate() {
    if (this.#frame) return;
    this.#lastFrame = performance.now();
    const step = (/** @type {number} */ now) => {
      this.#frame = 0;
      const arrived = this.#glide(Math.max(0, now - this.#lastFrame));
      this.#lastFrame = now;
      this.#drawOutput();
      if (!arrived) this.#frame = requestAnimationFrame(step);
    };
    this.#frame = requestAnimationFrame(step);
  }

  /** @param {number} elapsedMs */
  #glide(elapsedMs) {
    if (!this.#output) return true;
    const target = this.#output.points.positions;
    const periodic = this.#output.boundary === 'periodic';
    const share = 1 - Math.exp(-elapsedMs / GLIDE_MS);
    // A twentieth of a device pixel is not seen.
    const close = 0.05 / this.#scale;
    let arrived = true;
    for (let i = 0; i < target.length; i++) {
      const side = this.#output.size[i % 2];
      let way = target[i] - this.#drawn[i];
      // On a torus the short way may lead across the border.
      if (periodic) way -= side * Math.round(way / side);
      if (Math.abs(way) <= close) {
        this.#drawn[i] = target[i];
        continue;
      }
      arrived = false;
      let next = this.#drawn[i] + share * way;
      if (periodic) next -= side * Math.floor(next / side);
      this.#drawn[i] = next;
    }
    return arrived;
  }
}
