//! The JSON Schema of scenes, from the types that read them.

use serde_json::Value;

use crate::scene::Scene;

impl Scene {
    /// The JSON Schema of scenes, as indented text: fields, choices and the ranges of single numbers. Only
    /// [`Scene::build`] checks conditions between several fields.
    pub fn json_schema() -> String {
        let mut schema = schemars::schema_for!(Scene).to_value();
        without_null(&mut schema);
        let version = env!("CARGO_PKG_VERSION");
        schema["$id"] = Value::String(format!("urn:signorini:scene:{version}"));
        format!("{schema:#}\n")
    }
}

/// Removes `null` from the allowed values: a field that is left out is absent, not null.
fn without_null(schema: &mut Value) {
    match schema {
        Value::Object(map) => {
            if let Some(Value::Array(kinds)) = map.get_mut("type") {
                kinds.retain(|kind| kind != "null");
                if let [kind] = &kinds[..] {
                    let kind = kind.clone();
                    map.insert("type".into(), kind);
                }
            }
            if let Some(Value::Array(choices)) = map.get_mut("anyOf") {
                choices.retain(|choice| choice["type"] != "null");
            }
            if map.get("default").is_some_and(Value::is_null) {
                map.remove("default");
            }
            map.values_mut().for_each(without_null);
        }
        Value::Array(items) => items.iter_mut().for_each(without_null),
        _ => {}
    }
}
