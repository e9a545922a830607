// @ts-check
/**
 * The result with what room there is, and the exemplar small beside or below it. The points glide from where they are drawn to where they are, so that
 * ten batches a second look like a movement; a paused run is drawn exactly.
 */
import { areThings, drawPoints, markRadius, prepare, readColours } from '../common/draw.js';
import { carried, glide } from './glide.js';

/** @typedef {import('../common/messages.js').PatternView} PatternView */
/** @typedef {import('../common/messages.js').Points} Points */

/** A twentieth of a pixel is not seen. */
const NOT_SEEN = 0.05;
/** Room around the domain inside a canvas, so that marks on the border are whole. */
const MARGIN = 8;
/** Narrower than this, result, tools and exemplar stand one below the other; the editor needs more. */
const STACK_BELOW = 560;
const STACK_EDITOR_BELOW = 680;
/** Width of the exemplar's column beside the result, at least and at most. */
const COMPANION = { least: 150, most: 260 };
/** Height of the exemplar below a wide result, at least and at most. */
const BELOW = { least: 112, most: 240 };
/** However little the words beside the result leave, the exemplar has this height. */
const LEAST_EXEMPLAR = 66;
/** The exemplar stands below the result only where that gives it so many times the size. */
const WORTH_IT = 1.25;
/** Where the page scrolls, the result takes so much of the window's height, at least and at most. */
const SHARE_OF_WINDOW = { least: 0.5, most: 0.8 };
/** Height of the buttons that stay in sight below it. */
const DECK = 76;
/** Room around the result in a picture of its own, as a share of its width. */
const PICTURE_MARGIN = 0.02;
/** With less height than this the exemplar beside the result goes without its caption, and the tools without their hint. */
const LOW = 340;
/** Room for the shadow below a canvas. */
const SHADOW = 6;
/** However low the window, the results have this height. */
const LEAST_ROOM = 100;
/** While the exemplar is edited the editor takes the middle; this share of the width is left for the result. */
const RESULT_SHARE = 0.37;
/** Narrower than this, the result kept is only seen in the place of the one at hand. */
const APART_FROM = 620;

export class Stage {
  #figures = /** @type {HTMLElement} */ (document.getElementById('figures'));
  #results = /** @type {HTMLElement} */ (document.getElementById('results'));
  /** What stands below the results and takes of their height. @type {HTMLElement | null} */
  #below = null;
  #exemplarCanvas = /** @type {HTMLCanvasElement} */ (document.getElementById('exemplar-canvas'));
  #outputCanvas = /** @type {HTMLCanvasElement} */ (document.getElementById('output-canvas'));
  /** What there is to touch the result with. */
  #tools = /** @type {HTMLElement} */ (document.getElementById('touch'));
  #colours = readColours();
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
  /** The exemplar's own: it is smaller than the result where there is not room for both. */
  #exemplarScale = 100;
  #frame = 0;
  #lastFrame = 0;

  /** The result kept for comparison. @type {PatternView | null} */
  #kept = null;
  /** Whether that is drawn in the result's place. */
  #showsKept = false;
  #keptCanvas = /** @type {HTMLCanvasElement} */ (document.getElementById('kept-canvas'));
  /** A point in a hand, and where that is. @type {{ index: number, place: [number, number] } | null} */
  #held = null;
  /** Draws over the result. @type {(context: CanvasRenderingContext2D) => void} */
  overlay = () => {};

  #resized = new ResizeObserver(() => this.#layout());
  #look;

  /** @param {import('./look.js').Look} look */
  constructor(look) {
    this.#look = look;
    const caption = /** @type {HTMLElement} */ (this.#exemplarCanvas.nextElementSibling);
    for (const part of [this.#figures, this.#tools, caption]) this.#resized.observe(part);
    window.addEventListener('themechange', () => this.restyle());
  }

  /** Where the result is drawn, for hands and keys. */
  get surface() {
    return this.#outputCanvas;
  }

  /** Says what is drawn to those who can't see it. @param {'exemplar' | 'output'} which @param {string} words */
  label(which, words) {
    (which === 'exemplar' ? this.#exemplarCanvas : this.#outputCanvas).setAttribute('aria-label', words);
  }

  /** Leaves room for a part below the results. @param {HTMLElement} part */
  leaveRoomFor(part) {
    this.#below = part;
    this.#resized.observe(part);
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

  /** What the points are called, in the order of `positions`. */
  get ids() {
    return this.#output?.points.ids ?? new Uint32Array();
  }

  /** Which of the points are pinned, as places in `positions`. */
  get pinned() {
    if (!this.#output) return new Uint32Array();
    const { ids, pinned } = this.#output.points;
    const held = new Set(pinned);
    return Uint32Array.from(ids.keys()).filter((index) => held.has(ids[index]));
  }

  /** Whether a place on the canvas is one place in the pattern. */
  get touchable() {
    return this.#output !== null && !this.#showsKept && !(this.#tiles && this.#output.boundary === 'periodic');
  }

  get showsKept() {
    return this.#showsKept;
  }

  /** @param {boolean} shows whether the result that was kept is drawn in the place of the one at hand */
  set showsKept(shows) {
    this.#showsKept = shows && this.#kept !== null;
    this.#drawOutput();
  }

  /** Pixels an exemplar unit. */
  get scale() {
    return this.#scale;
  }

  /** The exemplar's mean spacing in exemplar units. */
  get spacing() {
    return this.#exemplar?.spacing ?? 0.05;
  }

  /** Radius of a mark in pixels. */
  get radius() {
    return markRadius(this.spacing, this.#scale);
  }

  /**
   * Where a point of the window lies, in exemplar units.
   *
   * @param {number} clientX
   * @param {number} clientY
   * @returns {[number, number]}
   */
  place(clientX, clientY) {
    const { left, top } = this.#outputCanvas.getBoundingClientRect();
    return [(clientX - left - MARGIN) / this.#scale, (clientY - top - MARGIN) / this.#scale];
  }

  /** @param {[number, number]} place @returns {[number, number]} where it is drawn */
  toCanvas([x, y]) {
    return [MARGIN + x * this.#scale, MARGIN + y * this.#scale];
  }

  /** @param {number} index */
  drawnAt(index) {
    return this.toCanvas([this.#drawn[2 * index], this.#drawn[2 * index + 1]]);
  }

  /**
   * The nearest place in the output: on the border, or in a tile where it comes in again.
   *
   * @param {[number, number]} place
   * @returns {[number, number]}
   */
  inside(place) {
    if (!this.#output) return place;
    const { size, boundary } = this.#output;
    const [x, y] = place.map((value, axis) =>
      boundary === 'periodic' ? value - size[axis] * Math.floor(value / size[axis]) : Math.min(Math.max(value, 0), size[axis]),
    );
    return [x, y];
  }

  /**
   * The point drawn nearest to a place, within `reach` pixels; −1 where there is none.
   *
   * @param {[number, number]} place
   * @param {number} reach
   */
  pointAt([x, y], reach) {
    let [best, least] = [-1, (reach / this.#scale) ** 2];
    for (let i = 0; i < this.#drawn.length / 2; i++) {
      const distance = (this.#drawn[2 * i] - x) ** 2 + (this.#drawn[2 * i + 1] - y) ** 2;
      if (distance <= least) [best, least] = [i, distance];
    }
    return best;
  }

  nearestToMiddle() {
    const [width, height] = this.#output?.size ?? [0, 0];
    return this.pointAt([width / 2, height / 2], Number.POSITIVE_INFINITY);
  }

  /**
   * Draws a point where a hand is until it is let go of.
   *
   * @param {number} index negative: none
   * @param {[number, number]} place
   */
  hold(index, place = [0, 0]) {
    this.#held = index < 0 ? null : { index, place };
    this.#animate();
  }

  redraw() {
    this.#animate();
  }

  /** Keeps the result as it is now, to be seen beside the next. */
  keep() {
    if (!this.#output) return;
    const { points } = this.#output;
    this.#kept = { ...this.#output, points: { ...points, positions: points.positions.slice() } };
    this.#layout();
  }

  unkeep() {
    if (!this.#kept) return;
    this.#kept = null;
    this.#showsKept = false;
    this.#layout();
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
    const before = this.#output.points.ids;
    this.#output.points = points;
    if (this.#reducedMotion.matches) this.#drawn = points.positions.slice();
    else this.#drawn = carried(this.#drawn, before, points);
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

  /** Gives the result what room there is, and the exemplar what that leaves. */
  #layout() {
    if (!this.#exemplar || !this.#output) return;
    const figure = /** @type {HTMLElement} */ (this.#exemplarCanvas.parentElement);
    const alone = getComputedStyle(figure).display === 'none' && !this.#editing;
    const width = this.#figures.clientWidth;
    const stacked = width < (this.#editing ? STACK_EDITOR_BELOW : STACK_BELOW) && !alone;
    const apart = this.#kept !== null && !stacked && !alone && !this.#editing && width >= APART_FROM;
    this.#figures.toggleAttribute('data-apart', apart);
    const gap = Number.parseFloat(getComputedStyle(this.#figures).columnGap) || 0;
    const room = this.#room(stacked);
    let shape = stacked ? 'stacked' : alone ? 'alone' : 'beside';
    let { scale, column } = this.#fit(apart, width, room, gap);
    if (this.#editing) {
      if (!stacked) scale = Math.min(scale, (RESULT_SHARE * width - 2 * MARGIN) / this.#output.size[0]);
    } else if (shape === 'beside') {
      const beside = this.#fit(apart, width - COMPANION.least - gap, room, gap);
      const below = this.#fit(apart, width, this.#bounded ? room - this.#belowHeight(BELOW.least) : room, gap);
      if (below.scale > WORTH_IT * beside.scale) shape = 'below';
      ({ scale, column } = shape === 'below' ? below : beside);
    }
    this.#scale = Math.max(scale, 8);
    this.#figures.dataset.shape = shape;
    this.#figures.toggleAttribute('data-low', shape === 'beside' && room < LOW);
    this.#results.toggleAttribute('data-column', column);
    this.#fitExemplar(shape, width, room, gap, column);
    this.#drawExemplar();
    this.#drawKept();
    this.#drawOutput();
  }

  /** Height for the results' canvases, with the heads above them left out. @param {boolean} stacked */
  #room(stacked) {
    if (!this.#bounded) {
      const most = SHARE_OF_WINDOW.most * window.innerHeight;
      if (stacked) return most;
      // The result and the buttons are to be seen at once, without scrolling.
      const top = this.#results.getBoundingClientRect().top + window.scrollY + this.#head;
      return Math.min(most, Math.max(window.innerHeight - top - DECK, SHARE_OF_WINDOW.least * window.innerHeight));
    }
    return Math.max(this.#figures.clientHeight - (this.#below?.offsetHeight ?? 0) - this.#head - SHADOW, LEAST_ROOM);
  }

  /** Whether the style sheet gives the figures the height that is left in the window; else the page scrolls. */
  get #bounded() {
    return getComputedStyle(this.#figures).flexBasis === '0px';
  }

  /** How far below its figure's upper edge a canvas begins. */
  get #head() {
    const figure = /** @type {HTMLElement} */ (this.#outputCanvas.parentElement);
    return this.#outputCanvas.getBoundingClientRect().top - figure.getBoundingClientRect().top;
  }

  /** Height of the exemplar's figure below the result. @param {number} canvas */
  #belowHeight(canvas) {
    return canvas + 16;
  }

  /**
   * The largest scale at which the results fit, one beside the other or one above the other.
   *
   * @param {boolean} apart whether the result that was kept has a canvas of its own
   * @param {number} width
   * @param {number} height
   * @param {number} gap
   */
  #fit(apart, width, height, gap) {
    const [outputWidth, outputHeight] = this.#output?.size ?? [1, 1];
    const [keptWidth, keptHeight] = this.#kept?.size ?? [0, 0];
    const widest = Math.max(outputWidth, keptWidth);
    const highest = Math.max(outputHeight, keptHeight);
    if (!apart) return { scale: Math.min((width - 2 * MARGIN) / widest, (height - 2 * MARGIN) / highest), column: false };
    const row = Math.min((width - gap - 4 * MARGIN) / (outputWidth + keptWidth), (height - 2 * MARGIN) / highest);
    const column = Math.min((width - 2 * MARGIN) / widest, (height - this.#head - 4 * MARGIN) / (outputHeight + keptHeight));
    return column > row ? { scale: column, column: true } : { scale: row, column: false };
  }

  /**
   * The exemplar is never larger than the result, and fits into what that leaves.
   *
   * @param {string} shape
   * @param {number} width
   * @param {number} room
   * @param {number} gap
   * @param {boolean} column
   */
  #fitExemplar(shape, width, room, gap, column) {
    if (!this.#exemplar || !this.#output) return;
    const [exemplarWidth, exemplarHeight] = this.#exemplar.size;
    const apart = this.#figures.hasAttribute('data-apart');
    const [keptWidth, keptHeight] = (apart && this.#kept?.size) || [0, 0];
    const size = (/** @type {number} */ units) => units * this.#scale + 2 * MARGIN;
    let [mostWidth, mostHeight] = [0.4 * width, BELOW.most];
    if (shape === 'beside') {
      const results = column ? size(Math.max(this.#output.size[0], keptWidth)) : size(this.#output.size[0]) + (apart ? gap + size(keptWidth) : 0);
      mostWidth = Math.min(Math.max(width - gap - results, COMPANION.least), COMPANION.most);
      this.#figures.style.setProperty('--companion', `${mostWidth}px`);
      const caption = /** @type {HTMLElement} */ (this.#exemplarCanvas.nextElementSibling);
      mostHeight = Math.max(room - caption.offsetHeight - this.#tools.offsetHeight, LEAST_EXEMPLAR);
    } else if (shape === 'below' && this.#bounded) {
      const results = column ? size(this.#output.size[1]) + this.#head + size(keptHeight) : size(Math.max(this.#output.size[1], keptHeight));
      mostHeight = Math.min(Math.max(room - results - this.#belowHeight(0), BELOW.least), BELOW.most);
    } else if (shape === 'stacked') {
      mostHeight = 150;
    }
    const most = Math.min((mostWidth - 2 * MARGIN) / exemplarWidth, (mostHeight - 2 * MARGIN) / exemplarHeight);
    this.#exemplarScale = Math.min(this.#scale, most);
  }

  /**
   * @param {HTMLCanvasElement} canvas
   * @param {PatternView} pattern
   * @param {number} [scale]
   */
  #size(canvas, pattern, scale = this.#scale) {
    const width = pattern.size[0] * scale + 2 * MARGIN;
    const height = pattern.size[1] * scale + 2 * MARGIN;
    canvas.style.width = `${width}px`;
    canvas.style.height = `${height}px`;
    return { width, height, context: prepare(canvas, width, height) };
  }

  #drawExemplar() {
    if (!this.#exemplar) return;
    const scale = this.#exemplarScale;
    const { context } = this.#size(this.#exemplarCanvas, this.#exemplar, scale);
    const { points, spacing } = this.#exemplar;
    const styles = this.#look.styles(this.#exemplar, this.#colours);
    drawPoints(context, this.#colours, points, {
      left: MARGIN,
      top: MARGIN,
      scale,
      radius: markRadius(spacing, scale, areThings(points, styles)),
      styles,
      wrap: this.#wrap(this.#exemplar),
    });
  }

  #drawKept() {
    if (!this.#kept || !this.#exemplar) return;
    const { context } = this.#size(this.#keptCanvas, this.#kept);
    const styles = this.#look.styles(this.#exemplar, this.#colours);
    const { points } = this.#kept;
    const radius = markRadius(this.#exemplar.spacing, this.#scale, areThings(points, styles));
    const wrap = this.#wrap(this.#kept);
    drawPoints(context, this.#colours, points, { left: MARGIN, top: MARGIN, scale: this.#scale, radius, styles, wrap });
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
    const shown = this.#showsKept && this.#kept ? this.#kept : this.#output;
    const { width, height, context } = this.#size(this.#outputCanvas, shown);
    const { size } = shown;
    const points = shown === this.#output ? { ...shown.points, positions: this.#drawn } : shown.points;
    const periodic = shown.boundary === 'periodic';
    const tiles = this.#tiles && periodic ? 3 : 1;
    const scale = this.#scale / tiles;
    const styles = this.#look.styles(this.#exemplar, this.#colours);
    const radius = markRadius(this.#exemplar.spacing, scale, areThings(points, styles));
    const wrap = tiles === 1 ? this.#wrap(shown) : null;
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
    if (shown === this.#output) this.overlay(context);
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
      const arrived = !this.#output || glide(this.#drawn, this.#output, Math.max(0, now - this.#lastFrame), NOT_SEEN / this.#scale, this.#held);
      this.#lastFrame = now;
      this.#drawOutput();
      if (!arrived) this.#frame = requestAnimationFrame(step);
    };
    this.#frame = requestAnimationFrame(step);
  }
}
