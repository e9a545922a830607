// The wasm package is made by the build and not in the repository.
declare module '*/pkg/pointweave.js' {
  export default function init(): Promise<unknown>;
  export class WorkerSession {
    handle(request: unknown): unknown;
  }
}
