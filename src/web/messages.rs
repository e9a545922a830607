//! Plain JavaScript objects ⇄ Rust's tagged unions.

use serde::Serialize;
use serde::de::DeserializeOwned;
use wasm_bindgen::prelude::JsValue;

/// Reads a request: its `type` says which, so it becomes the key.
pub(super) fn read<T: DeserializeOwned>(request: &JsValue) -> Result<T, serde_wasm_bindgen::Error> {
    let keyed = js_sys::Object::new();
    let key = js_sys::Reflect::get(request, &"type".into()).unwrap_or(JsValue::UNDEFINED);
    // Setting a member of a plain object can't fail; a key that is no string becomes one that no request has.
    let _ = js_sys::Reflect::set(&keyed, &key, request);
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
