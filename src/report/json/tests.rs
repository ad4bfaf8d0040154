//! The document against its schema, and what it says of hand-made runs.

use serde_json::{Value, json};

use super::super::samples::everything;
use super::*;

fn schema() -> Value {
    serde_json::from_str(include_str!("../../../schema/frames-lint-1.json")).unwrap()
}

fn document(run: &Run) -> Value {
    serde_json::from_str(&render(run, FailOn::Error).unwrap()).unwrap()
}

#[test]
fn documents_are_valid_by_the_schema() {
    let validator = jsonschema::draft202012::new(&schema()).unwrap();
    for run in [everything(), Run::default()] {
        let document = document(&run);
        let errors: Vec<String> = validator
            .iter_errors(&document)
            .map(|error| error.to_string())
            .collect();
        assert_eq!(errors, Vec::<String>::new());
    }
    // The schema is no rubber stamp: it wants every key, and no other.
    for pointer in [
        "/inputs/0/path",
        "/findings/0/fix/edits/0/line",
        "/findings/0/places/1/stamp_ns",
    ] {
        let mut lacking = document(&everything());
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        lacking
            .pointer_mut(parent)
            .unwrap()
            .as_object_mut()
            .unwrap()
            .remove(key)
            .unwrap();
        assert!(!validator.is_valid(&lacking), "{pointer}");
        lacking.pointer_mut(parent).unwrap()[key] = json!({"unknown": 1});
        assert!(!validator.is_valid(&lacking), "{pointer}");
    }
    let mut more = document(&everything());
    more["findings"][0]["extra"] = json!(1);
    assert!(!validator.is_valid(&more));
}

#[test]
fn places_have_lines_messages_or_both() {
    let document = document(&everything());
    let places = document["findings"][0]["places"].as_array().unwrap();
    assert_eq!(
        places[0],
        json!({"role": "primary", "path": "robot.urdf", "line": 4, "column": 18, "end_line": 4, "end_column": 26,
               "topic": null, "index": null, "stamp_ns": null, "field": null, "note": "written here"})
    );
    assert_eq!(
        places[1],
        json!({"role": "related", "path": "drive.mcap", "line": null, "column": null, "end_line": null,
               "end_column": null, "topic": "/tf_static", "index": 3, "stamp_ns": 1_700_000_000_000_000_000_i64,
               "field": "transforms[0]", "note": "published here"})
    );
    // Text inside a recording: the message and the line in its text.
    assert_eq!(places[2]["path"], "drive.mcap");
    assert_eq!(places[2]["topic"], "/robot_description");
    assert_eq!(places[2]["line"], 3);
    // Lines of an expansion are not lines of the file.
    assert_eq!(places[3]["line"], Value::Null);
    assert_eq!(places[3]["note"], "expanded here (line 3 of the expansion)");
    assert_eq!(places[4]["path"], "calib.yaml");
}

#[test]
fn numbers_that_json_cannot_hold_are_null() {
    let document = document(&everything());
    assert_eq!(
        document["findings"][0]["measured"][0],
        json!({"what": "rotation", "value": null, "unit": "deg", "limit": null, "spread": 0.0, "n": 3})
    );
}

#[test]
fn problems_of_inputs_have_their_place() {
    let input = &document(&everything())["inputs"][4];
    assert_eq!(input["status"], "partial");
    assert_eq!(input["detail"], "the list is never closed");
    assert_eq!(input["problems"][0]["help"], "close it with `]`");
    assert_eq!(
        (&input["problems"][0]["line"], &input["problems"][0]["column"]),
        (&json!(2), &json!(4))
    );
}

#[test]
fn only_files_can_be_edited() {
    let mut run = everything();
    assert_eq!(document(&run)["findings"][0]["fix"]["edits"][0]["column"], 18);
    let fix = run.verdict.findings[0].fix.as_mut().unwrap();
    fix.edits[0].place.source = crate::source::SourceId(2);
    assert_eq!(document(&run)["findings"][0]["fix"], Value::Null);
}

#[test]
fn the_summary_counts() {
    assert_eq!(
        document(&everything())["summary"],
        json!({"errors": 0, "warnings": 1, "notes": 0, "hints": 1, "applicable": 6, "judged": 4, "passed": 1, "explained": 0, "not_evaluated": 1, "not_applicable": 0, "waived": 1, "crashed": 1,
               "verdict": "incomplete"})
    );
}
