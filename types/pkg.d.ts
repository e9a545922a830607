// The wasm package is made by the build and not in the repository.
declare module '*/pkg/pointweave.js' {
  export default function init(options?: { module_or_path: WebAssembly.Module }): Promise<unknown>;
  /** For those who hold the bytes of the module already. */
  export function initSync(options: { module: BufferSource }): unknown;
  /** A workload as JSON in, a report as JSON out. */
  export function bench_iterations(workload: string): string;
  export class WorkerSession {
    handle(request: unknown): unknown;
    /** The same, waiting for a device where that takes waiting. One request at a time. */
    answer(request: unknown): Promise<any>;
    /** Computes from now on with what the other one chose, which is gone then. */
    takeEngine(other: WorkerSession): void;
    destroyDevice(): void;
    free(): void;
  }
}

declare module '*/pkg/pointweave_files.js' {
  export default function init(): Promise<unknown>;
  /** For those who hold the bytes of the module already. */
  export function initSync(options: { module: BufferSource }): unknown;
  /** Answers one request, see `www/common/files-messages.js`. */
  export function answer(request: unknown): any;
}
