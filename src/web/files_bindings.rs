//! JavaScript values ⇄ messages of the module for files.

use wasm_bindgen::prelude::{JsValue, wasm_bindgen};

use super::files::{FilesResponse, respond};
use super::messages::{self, Message};

/// Answers one request. Requests and responses are plain objects, see `www/common/files-messages.js`.
#[wasm_bindgen]
pub fn answer(request: &Message) -> JsValue {
    console_error_panic_hook::set_once();
    let response = match messages::read(request) {
        Ok(request) => respond(request),
        Err(error) => {
            FilesResponse::Error { message: messages::misunderstood(&error), place: None, columns: Vec::new() }
        }
    };
    messages::to_js(&response)
}
