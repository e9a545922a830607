// @ts-check
/**
 * The messages between the page and the worker for files: the JavaScript side of `src/web/files/protocol.rs`, member by member.
 * A Rust unit test checks that every message there has its typedef here. The page asks through `files.js`.
 */

/** @typedef {import('./messages.js').PatternData} PatternData */
/** @typedef {import('./messages.js').Parameters} Parameters */
/** @typedef {'csv' | 'tsv' | 'json' | 'svg' | 'npy'} FileFormat */
/** @typedef {'auto' | 'dark' | 'light'} Ink which pixels are points; `auto` takes the side with fewer pixels */
/** @typedef {{ domain?: [number, number, number, number] | null, boundary?: 'open' | 'periodic' | null }} ReadOptions `domain` is x0, y0, x1, y1 */
/**
 * `threshold` from 0 (black) to 255 (white), null for Otsu's; areas in pixels, null for no limit.
 * @typedef {{ threshold?: number | null, ink?: Ink, minArea?: number | null, maxArea?: number | null }} BlobOptions
 */
/** @typedef {{ gallery: string } | { pattern: PatternData }} LinkExemplar */

// What the page asks.
/** @typedef {{ type: 'read', name: string, bytes: Uint8Array, options: ReadOptions }} ReadRequest */
/** @typedef {{ type: 'blobs', width: number, height: number, pixels: Uint8Array, options: BlobOptions }} BlobsRequest */
/** @typedef {{ type: 'write', format: FileFormat, pattern: PatternData, title: string, tile: boolean, glyphs: Record<string, string>, palette: string }} WriteRequest */
/** @typedef {{ type: 'glyph', name: string }} GlyphRequest */
/**
 * @typedef {{ type: 'write-project', title: string, method: string, preset: string, overrides: Parameters, exemplar: PatternData,
 *   output: PatternData | null, state: string | null }} WriteProjectRequest
 */
/** @typedef {{ type: 'write-link', exemplar: LinkExemplar, method: string, preset: string, overrides: Parameters }} WriteLinkRequest */
/** @typedef {{ type: 'read-link', fragment: string }} ReadLinkRequest */
/** @typedef {ReadRequest | BlobsRequest | WriteRequest | GlyphRequest | WriteProjectRequest | WriteLinkRequest | ReadLinkRequest} FilesRequest */

// What the worker answers.
/** @typedef {{ type: 'read', pattern: PatternData, preview: Preview, project: Project | null }} ReadResponse */
/** The file is a picture: its pixels have to come as `blobs`. @typedef {{ type: 'picture', kind: string }} PictureResponse */
/** @typedef {{ type: 'blobs', pattern: PatternData, preview: Preview, threshold: number, local: boolean, ink: 'dark' | 'light' }} BlobsResponse */
/** @typedef {{ type: 'written', bytes: Uint8Array, mime: string, extension: string }} WrittenResponse */
/** @typedef {{ type: 'glyph', outline: string }} GlyphResponse */
/** @typedef {{ type: 'link-written', fragment: string, pattern: PatternData, exact: boolean, note: string | null }} LinkWrittenResponse */
/**
 * @typedef {{ type: 'link-read', exemplar: LinkExemplar, method: string, preset: string, overrides: Parameters, parameters: Parameters,
 *   notes: Note[], preview: Preview, cost: Cost }} LinkReadResponse
 */
/** @typedef {{ type: 'error', message: string, place: { line: number, column: number | null } | null }} FilesErrorResponse */
/**
 * @typedef {ReadResponse | PictureResponse | BlobsResponse | WrittenResponse | GlyphResponse | LinkWrittenResponse | LinkReadResponse
 *   | FilesErrorResponse} FilesResponse
 */

// What they hold.
/** What was left out, changed or looks odd, in a sentence or two. @typedef {{ kind: 'left-out' | 'changed' | 'odd', text: string }} Note */
/**
 * A column of a table as a person chooses among them.
 * @typedef {{ name: string, role: { kind: 'x' | 'y' | 'place' | 'class' | 'left-out' } | { kind: 'attribute', name: string },
 *   examples: string[], isNumeric: boolean }} Column
 */
/** How the exemplar's file named and placed things; only handed back. @typedef {Record<string, unknown>} Origin */
/**
 * `format` as a person calls it; `domain` is x0, y0, x1, y1; `declared` says whether the file tells the domain or it was found from
 * the points; `notes` are sentences about what was left out or looks odd.
 * @typedef {{ format: string, points: number, classes: { name: string, count: number }[],
 *   attributes: { name: string, min: number, max: number }[], domain: [number, number, number, number], declared: boolean,
 *   boundary: 'open' | 'periodic', spacing: number | null, domains: { name: string, domain: [number, number, number, number] }[], columns: Column[], origin: Origin,
 *   notes: Note[] }} Preview
 */
/**
 * A saved session; the pattern beside it is the exemplar. `state` is for the engine's `resume`.
 * @typedef {{ title: string, method: string, preset: string, overrides: Parameters, output: PatternData | null, state: string | null }} Project
 */
/**
 * What a run would take: points of the output, billions of operations, and about how many seconds on the processor. `autoRun` says
 * whether a page may start it unasked.
 * @typedef {{ points: number, iterations: number, gigaOperations: number, seconds: number, autoRun: boolean }} Cost
 */

export {};
