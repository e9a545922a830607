// @ts-check
/**
 * The messages between the page and its worker: the JavaScript side of `src/web/protocol.rs`, member by member.
 * A Rust unit test checks that every message there has its typedef here.
 *
 * Positions are in exemplar units (the exemplar's longer side is 1) from the lower corner of their domain.
 */

/**
 * A pattern to the last digit, in its own unit: `domain` is the lower corner, width and height, `positions` x, y, x, y, …
 * @typedef {{ domain: [number, number, number, number], boundary: 'open' | 'periodic', positions: Float64Array, classes: Uint16Array,
 *   classNames: string[], attributes: { name: string, values: Float64Array }[] }} PatternData
 */
/** `name` of a pattern is what the page calls it. @typedef {{ source: 'gallery', name: string } | { source: 'pattern', name: string, pattern: PatternData }} Source */
/** @typedef {'auto' | 'cpu' | 'gpu'} EngineChoice */
/** @typedef {{ name: string, software: boolean }} AdapterView */

// What the page asks.
/** @typedef {{ type: 'describe' }} DescribeRequest */
/** @typedef {{ type: 'engine', choice: EngineChoice, adapter?: AdapterView | null }} EngineRequest */
/** @typedef {{ type: 'gallery' }} GalleryRequest */
/** @typedef {{ type: 'open', exemplar: Source }} OpenRequest */
/** @typedef {{ type: 'start', exemplar: Source, method: string, preset: string, overrides: Record<string, number | string> }} StartRequest */
/** @typedef {{ type: 'run', budgetMs: number, maxIterations: number }} RunRequest */
/** Points are named by their ids; without positions they stay where they are. @typedef {{ type: 'touch', points: Uint32Array, positions: Float64Array, pinned: boolean }} TouchRequest */
/** Corners of a polygon, x, y, x, y, … @typedef {{ type: 'resynthesize', region: Float64Array }} ResynthesizeRequest */
/** @typedef {{ type: 'continue', method: string, preset: string, overrides: Record<string, number | string> }} ContinueRequest */
/** @typedef {{ type: 'analyze' }} AnalyzeRequest */
/** @typedef {{ type: 'export' }} ExportRequest */
/** @typedef {{ type: 'save' }} SaveRequest */
/** @typedef {{ type: 'resume', state: string }} ResumeRequest */
/**
 * @typedef {DescribeRequest | EngineRequest | GalleryRequest | OpenRequest | StartRequest | RunRequest | TouchRequest
 *   | ResynthesizeRequest | ContinueRequest | AnalyzeRequest | ExportRequest
 *   | SaveRequest | ResumeRequest} Request
 */

// What the worker answers.
/** @typedef {{ type: 'description', version: string, engine: EngineView, methods: MethodView[], glyphs: GlyphView[] }} DescriptionResponse */
/** @typedef {{ type: 'engine', engine: EngineView, note: string | null, adapter: AdapterView | null }} EngineResponse the worker adds `adapter` */
/** @typedef {{ type: 'gallery', entries: GalleryEntryView[] }} GalleryResponse */
/** @typedef {{ type: 'opened', exemplar: PatternView, pattern: PatternData }} OpenedResponse */
/** @typedef {{ type: 'started', method: string, exemplar: PatternView, output: PatternView, parameters: Parameters, progress: Progress }} StartedResponse */
/**
 * @typedef {{ type: 'batch', events: RunEvent[], progress: Progress, points: Points | null,
 *   iterationsPerSecond: number | null, secondsLeft: number | null,
 *   engine: EngineView | null, note: string | null, finished: boolean }} BatchResponse
 */
/**
 * Lengths in mean spacings d of the exemplar, frequencies in cycles per d.
 * @typedef {{ type: 'analyzed', exemplar: CurvesView, output: CurvesView,
 *   periodogram: { exemplar: SpectrumView, output: SpectrumView }, distance: Float32Array, interval: number,
 *   quality: QualityView, defects: DefectsView, verdict: string, iterations: number, workMs: number }} AnalyzedResponse
 */
/** @typedef {{ type: 'exported', pattern: PatternData }} ExportedResponse */
/** @typedef {{ type: 'saved', state: string, progress: Progress }} SavedResponse */
/** @typedef {{ type: 'error', message: string, place: { line: number, column: number | null } | null }} ErrorResponse */
/**
 * @typedef {DescriptionResponse | EngineResponse | GalleryResponse | OpenedResponse | StartedResponse | BatchResponse
 *   | AnalyzedResponse | ExportedResponse | SavedResponse | ErrorResponse} Response
 */

/**
 * Which answer belongs to which question.
 * @typedef {{ describe: DescriptionResponse, engine: EngineResponse, gallery: GalleryResponse, open: OpenedResponse, start: StartedResponse,
 *   run: BatchResponse, touch: BatchResponse, resynthesize: BatchResponse, continue: StartedResponse, analyze: AnalyzedResponse, export: ExportedResponse, save: SavedResponse, resume: StartedResponse }} Answers
 */

// What they hold.
/** @typedef {{ gpu: boolean, name: string, meaning: string }} EngineView */
/** @typedef {{ name: string, title: string, meaning: string, parameters: Parameters }} PresetView */
/**
 * A method in its own words: what the page offers of it is built from this.
 * @typedef {{ name: string, title: string, meaning: string, presets: PresetView[], parameters: ParameterView[], tools: Tool[],
 *   losses: LossView[] }} MethodView
 */
/** @typedef {'move' | 'pin' | 'redo-region' | 'continue' | 'gpu'} Tool */
/** @typedef {{ name: string, title: string, meaning: string, place: 'main' | 'advanced', group: string, kind: KindView }} ParameterView */
/** @typedef {{ number: { min: number, max: number, whole: boolean } } | { choice: { options: OptionView[] } }} KindView */
/** @typedef {{ name: string, title: string, meaning: string }} OptionView */
/** @typedef {{ name: string, title: string }} LossView */
/** @typedef {{ name: string, title: string, caption: string, pattern: PatternView }} GalleryEntryView */
/** @typedef {{ name: string, outline: string }} GlyphView */
/** @typedef {{ glyph: string, color: number }} ClassLookView */
/**
 * An id stays with its point while others come and go; `pinned` holds ids. Radii, scales, turns and depths are empty where the
 * pattern does not say; see `src/web/protocol.rs` for their units.
 * @typedef {{ ids: Uint32Array, positions: Float32Array, classes: Uint16Array, radii: Float32Array, scales: Float32Array,
 *   turns: Float32Array, depths: Float32Array, pinned: Uint32Array }} Points
 */
/**
 * @typedef {{ points: Points, classNames: string[], looks: ClassLookView[], size: [number, number], min: [number, number], unit: number,
 *   boundary: 'open' | 'periodic', spacing: number | null }} PatternView
 */
/**
 * @typedef {{ pairCorrelation: Float32Array, nearest: Float32Array, spacing: number, frequency: Float32Array,
 *   power: Float32Array, relativeRadius: number }} CurvesView
 */
/**
 * Power, row after row from the lowest frequency along y on; the middle is the frequency 0, `reach` the highest along x and y in
 * cycles per d.
 * @typedef {{ width: number, height: number, power: Float32Array, reach: [number, number] }} SpectrumView
 */
/** @typedef {{ score: number, arrangement: number, detail: number, variety: number, independent: number }} QualityView */
/** @typedef {{ stacked: number, holes: number, border: number | null }} DefectsView */
/** @typedef {Record<string, number | string>} Parameters */
/**
 * @typedef {{ class: number, turn: number, classes: number, scale: number, scales: number, restart: number, restarts: number, redoing: boolean,
 *   iteration: number, iterations: number, totalIterations: number, done: number }} Progress
 */
/** A named term of the loss. @typedef {{ name: string, value: number }} Loss */
/** @typedef {{ type: 'scale-started', progress: Progress, sigma: number, grid: [number, number] }} ScaleStartedEvent */
/** @typedef {{ type: 'iterated', progress: Progress, losses: Loss[] }} IteratedEvent */
/** @typedef {{ type: 'scale-finished', progress: Progress, converged: boolean }} ScaleFinishedEvent */
/** @typedef {{ type: 'finished' }} FinishedEvent */
/** @typedef {ScaleStartedEvent | IteratedEvent | ScaleFinishedEvent | FinishedEvent} RunEvent */

export {};
