// @ts-check
/**
 * The messages between the page and the worker for files: the JavaScript side of `src/web/files/protocol.rs`, member by member.
 * A Rust unit test checks that every message there has its typedef here. The page asks through `files.js`.
 */

/** @typedef {import('./messages.js').PatternData} PatternData */
/** @typedef {import('./messages.js').Parameters} Parameters */
/** @typedef {'csv' | 'tsv' | 'json' | 'geojson' | 'svg' | 'npy'} FileFormat */
/** @typedef {'auto' | 'dark' | 'light'} Ink which pixels are points; `auto` takes the side with fewer pixels */
/** @typedef {[number, number, number, number]} Corners x0, y0, x1, y1 */
/**
 * Which column holds what, by name; null is left to the reader, and no class is ''. Of `attributes` each is the attribute's name and
 * its column; columns that are not named are left out.
 * @typedef {{ x?: string | null, y?: string | null, class?: string | null, attributes?: [string, string][] | null }} ColumnChoice
 */
/**
 * What a person knows better than the file. `keepsDegrees` takes longitudes and latitudes as they are.
 * @typedef {{ domain?: Corners | null, boundary?: 'open' | 'periodic' | null, columns?: ColumnChoice, keepsDegrees?: boolean }} ReadOptions
 */
/**
 * `threshold` from 0 (black) to 255 (white), null for Otsu's; areas in pixels, null for no limit.
 * @typedef {{ threshold?: number | null, ink?: Ink, minArea?: number | null, maxArea?: number | null }} BlobOptions
 */
/** @typedef {{ gallery: string } | { pattern: PatternData }} LinkExemplar */

// What the page asks.
/** @typedef {{ type: 'read', name: string, bytes: Uint8Array, options: ReadOptions }} ReadRequest */
/** @typedef {{ type: 'blobs', width: number, height: number, pixels: Uint8Array, options: BlobOptions }} BlobsRequest */
/** @typedef {{ type: 'write', format: FileFormat, pattern: PatternData, title: string, tile: boolean, glyphs: Record<string, string>, palette: string, origin: Origin }} WriteRequest */
/** @typedef {{ type: 'glyph', name: string }} GlyphRequest */
/**
 * @typedef {{ type: 'write-project', title: string, method: string, preset: string, overrides: Parameters, exemplar: PatternData,
 *   origin: Origin, output: PatternData | null, state: string | null }} WriteProjectRequest
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
/**
 * `columns`: what there is to choose from, when another choice of columns may help.
 * @typedef {{ type: 'error', message: string, place: { line: number, column: number | null } | null, columns: Column[] }} FilesErrorResponse
 */
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
/**
 * How the exemplar's file named and placed things: kept with the exemplar and handed back with what is written. `projection` says
 * where degrees became metres, in degrees.
 * @typedef {{ projection?: { longitude: number, latitude: number } | null } & Record<string, unknown>} Origin
 */
/**
 * `format` as a person calls it; `declared` says whether the file or the person tells the domain or it was found from the points;
 * `domains` are others that the points may have been cut from, with a word for each; `notes` tell what was left out, changed or looks odd.
 * @typedef {{ format: string, points: number, classes: { name: string, count: number }[],
 *   attributes: { name: string, min: number, max: number }[], domain: Corners, declared: boolean, boundary: 'open' | 'periodic',
 *   spacing: number | null, domains: { name: string, domain: Corners }[], columns: Column[], origin: Origin,
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
