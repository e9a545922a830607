//! Plain JavaScript objects ⇄ Rust's tagged unions.

use js_sys::{Array, Object};
use serde::Serialize;
use serde::de::DeserializeOwned;
use wasm_bindgen::prelude::{JsValue, wasm_bindgen};

#[wasm_bindgen]
extern "C" {
    /// A message: a plain object whose `type` says which one it is.
    pub type Message;
    /// Its `type`; undefined where it has none.
    ///
    /// # Errors
    /// When it is no object at all.
    #[wasm_bindgen(method, getter, catch, js_name = "type")]
    fn kind(this: &Message) -> Result<JsValue, JsValue>;
}

/// Reads a request: its `type` says which, so it becomes the key.
pub(super) fn read<T: DeserializeOwned>(request: &Message) -> Result<T, serde_wasm_bindgen::Error> {
    // A key that is no string becomes one that no request has.
    let keyed = Object::from_entries(&Array::of1(&Array::of2(&request.kind()?, request)))?;
    serde_wasm_bindgen::from_value(keyed.into())
}

pub(super) fn misunderstood(error: &serde_wasm_bindgen::Error) -> String {
    format!("the worker does not understand the page: {error}")
}

pub(super) fn to_js(response: &impl Serialize) -> JsValue {
    let serializer =
        serde_wasm_bindgen::Serializer::new().serialize_maps_as_objects(true).serialize_missing_as_null(true);
    response.serialize(&serializer).unwrap_or_else(|error| error.into())
}
