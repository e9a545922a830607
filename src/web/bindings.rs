//! JavaScript values ⇄ messages.

use wasm_bindgen::JsCast as _;
use wasm_bindgen::prelude::{JsValue, wasm_bindgen};
use web_sys::WorkerGlobalScope;

use super::messages::{self, Message, read, to_js};
use super::protocol::Response;
use super::session::Session;

/// Milliseconds on the clock of the worker; 0 where there is none.
fn now() -> f64 {
    let scope: WorkerGlobalScope = js_sys::global().unchecked_into();
    scope.performance().map_or(0.0, |clock| clock.now())
}

/// The session of one worker.
#[derive(Debug)]
#[wasm_bindgen]
pub struct WorkerSession(Session);

#[wasm_bindgen]
impl WorkerSession {
    /// A session without a run. A panic will be written to the console before it becomes a trap.
    #[wasm_bindgen(constructor)]
    #[expect(clippy::new_without_default, reason = "JavaScript calls the constructor")]
    pub fn new() -> Self {
        console_error_panic_hook::set_once();
        Self(Session::new())
    }

    /// Answers one request. Requests and responses are plain objects, see `www/common/messages.js`.
    pub fn handle(&mut self, request: Message) -> JsValue {
        let response = match read(&request) {
            Ok(request) => self.0.handle(request, &now),
            Err(error) => misunderstood(&error),
        };
        to_js(&response)
    }

    /// The same as a promise: what takes a device can only be answered this way. One request at a time.
    pub async fn answer(&mut self, request: Message) -> JsValue {
        let response = match read(&request) {
            Ok(request) => self.0.answer(request, &now).await,
            Err(error) => misunderstood(&error),
        };
        to_js(&response)
    }

    /// Computes from now on with what another session chose: a run can go on here while a device is opened there.
    #[wasm_bindgen(js_name = takeEngine)]
    pub fn take_engine(&mut self, other: Self) {
        self.0.take_engine(other.0);
    }

    /// Makes the device stop working, as unplugging it would; for tests.
    #[wasm_bindgen(js_name = destroyDevice)]
    pub fn destroy_device(&self) {
        self.0.destroy_device();
    }
}

fn misunderstood(error: &serde_wasm_bindgen::Error) -> Response {
    Response::Error { message: messages::misunderstood(error), place: None }
}

/// Times an iteration: a workload as JSON in, a report as JSON out (see [`crate::bench`]).
///
/// # Errors
/// When the workload can't be read or is out of range.
#[cfg(feature = "bench")]
#[wasm_bindgen]
pub fn bench_iterations(workload: &str) -> Result<String, String> {
    let workload = serde_json::from_str(workload).map_err(|error| error.to_string())?;
    let report = crate::bench::run(&workload, &|| now() / 1000.0).map_err(|error| error.to_string())?;
    serde_json::to_string(&report).map_err(|error| error.to_string())
}
