//! A calibration made from any bytes, in YAML or JSON: every transform is read as it was made; damage breaks nothing.

use std::fmt::Write;

use frames_lint::read::calibration;
use frames_lint::source::{ReadStatus, Source, SourceKind};
use frames_lint::tables::Tables;
use frames_lint::world::Facts;

use super::choices::Choices;

/// A transform by its child.
struct ChildTransform {
    child: String,
    xyz: [f64; 3],
    xyzw: [f64; 4],
}

/// Runs the target.
pub fn run(bytes: &[u8]) {
    let mut choices = Choices::new(bytes);
    let all: Vec<ChildTransform> = (0..=choices.below(12))
        .map(|at| ChildTransform {
            child: format!("{}_{at}", choices.of(&["lidar", "camera", "imu"])),
            xyz: choices.vector(),
            xyzw: choices.quaternion(),
        })
        .collect();
    let is_json = choices.below(2) == 1;
    let written = if is_json { json(&all) } else { yaml(&all, &mut choices) };
    let (source, facts) = read(written.as_bytes(), is_json).expect("UTF-8");
    assert_eq!(source.status, ReadStatus::Read, "{source:?}\n{written}");
    assert_eq!(facts.claims.len(), all.len(), "{written}");
    for (claim, made) in facts.claims.iter().zip(&all) {
        let (parent, child) = claim.frames.as_ref().expect("both frames are named");
        assert_eq!(
            (parent.as_str(), child.as_str()),
            ("base_link", made.child.as_str()),
            "{written}"
        );
        let pose = claim.pose.as_ref().expect("the numbers make one");
        assert_eq!(pose.translation_m, made.xyz, "{written}");
        // The dot product of two unit quaternions is 1 or -1 if they are the same rotation.
        let same: f64 = pose.rotation_xyzw.iter().zip(made.xyzw).map(|(a, b)| a * b).sum();
        assert!((same.abs() - 1.0).abs() < 1e-9, "{same}: {written}");
    }
    let mut bent = written.into_bytes();
    choices.bend(&mut bent);
    let _ = read(&bent, is_json);
}

fn yaml(all: &[ChildTransform], choices: &mut Choices<'_>) -> String {
    let mut out = choices
        .of(&["", "---\n", "# calibration\n", "%YAML 1.2\n---\n"])
        .to_owned();
    out.push_str("base_link:\n");
    let indent = choices.of(&["  ", "    "]);
    for made in all {
        let quote = choices.of(&["", "'", "\""]);
        let comment = choices.of(&["", "  # mounted", "   "]);
        let _ = writeln!(out, "{indent}{quote}{}{quote}:{comment}", made.child);
        for (key, numbers) in [("translation", made.xyz.as_slice()), ("rotation", &made.xyzw)] {
            match choices.below(3) {
                0 => {
                    let _ = writeln!(out, "{indent}{indent}{key}: {numbers:?}");
                }
                1 => {
                    let _ = writeln!(out, "{indent}{indent}{key}:");
                    for number in numbers {
                        let _ = writeln!(out, "{indent}{indent}- {number:?}");
                    }
                }
                _ => {
                    let _ = writeln!(out, "{indent}{indent}{key}:");
                    for (name, number) in ["x", "y", "z", "w"].iter().zip(numbers) {
                        let _ = writeln!(out, "{indent}{indent}{indent}{name}: {number:?}");
                    }
                }
            }
        }
    }
    out
}

fn json(all: &[ChildTransform]) -> String {
    let each = all.iter().map(|made| {
        format!(
            "{:?}: {{\"translation\": {:?}, \"rotation\": {:?}}}",
            made.child, made.xyz, made.xyzw
        )
    });
    format!("{{\"base_link\": {{{}}}}}", each.collect::<Vec<_>>().join(", "))
}

/// What is read of a file; `None` if it is not a text.
fn read(bytes: &[u8], is_json: bool) -> Option<(Source, Facts)> {
    let kind = if is_json { SourceKind::Json } else { SourceKind::Yaml };
    let mut source = super::source(bytes, "made", kind)?;
    let tables = Tables::default();
    let facts = match kind {
        SourceKind::Json => calibration::read_json(&mut source, tables.dialects()),
        _ => calibration::read_yaml(&mut source, tables.dialects()),
    };
    Some((source, facts))
}
