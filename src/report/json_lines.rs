//! The JSON document of a run, a line for each of its parts: `{"type": "finding", ...}`. The keys are those of
//! `schema/frames-lint-1.json`; the last line is the summary.

use serde_json::{Value, json};

use crate::run::{FailOn, Run};

use super::json;

pub(super) fn render(run: &Run, fail_on: FailOn) -> Result<String, serde_json::Error> {
    let mut out = String::new();
    let mut line = |kind: &str, value: &Value| -> Result<(), serde_json::Error> {
        let mut object = serde_json::Map::new();
        object.insert("type".to_owned(), kind.into());
        if let Value::Object(keys) = value {
            object.extend(keys.clone());
        }
        out.push_str(&serde_json::to_string(&object)?);
        out.push('\n');
        Ok(())
    };
    let document = json::document(run, fail_on)?;
    let part = |key: &str| document.get(key).cloned().unwrap_or_default();
    line("run", &json!({"schema": part("schema"), "tool": part("tool")}))?;
    for (key, kind) in [
        ("inputs", "input"),
        ("outcomes", "outcome"),
        ("findings", "finding"),
        ("required", "required"),
    ] {
        for item in document.get(key).and_then(Value::as_array).into_iter().flatten() {
            line(kind, item)?;
        }
    }
    line("summary", &part("summary"))?;
    Ok(out)
}
