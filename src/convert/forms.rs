//! Forms of a transform that belong to no dialect.

use std::fmt::Write;

use crate::math::rotation::to_rpy;

use super::Item;
use super::write::number;

/// Their words.
pub(super) const FORMS: [&str; 5] = ["urdf", "tf", "matrix", "quaternion", "rpy"];

/// The transforms in a form, one after the other.
pub(super) fn write(form: &str, items: &[Item]) -> String {
    let mut out = String::new();
    for item in items {
        one(form, item, &mut out);
    }
    out
}

fn one(form: &str, item: &Item, out: &mut String) {
    let Item {
        target,
        source,
        target_from_source,
        ..
    } = item;
    let t = target_from_source.translation.vector;
    let q = target_from_source.rotation.coords;
    let (roll, pitch, yaw) = to_rpy(&target_from_source.rotation);
    let list = |values: &[f64]| values.iter().map(|value| number(*value)).collect::<Vec<_>>().join(" ");
    let name = format!("{target}_from_{source}");
    let _ = match form {
        "urdf" => writeln!(
            out,
            "<joint name=\"{}_to_{}\" type=\"fixed\">\n  <parent link=\"{}\"/>\n  <child link=\"{}\"/>\n  <origin xyz=\"{}\" rpy=\"{}\"/>\n</joint>",
            escaped(target),
            escaped(source),
            escaped(target),
            escaped(source),
            list(&[t.x, t.y, t.z]),
            list(&[roll, pitch, yaw]),
        ),
        "tf" => writeln!(
            out,
            "ros2 run tf2_ros static_transform_publisher --x {} --y {} --z {} --qx {} --qy {} --qz {} --qw {} --frame-id {target} --child-frame-id {source}",
            number(t.x),
            number(t.y),
            number(t.z),
            number(q.x),
            number(q.y),
            number(q.z),
            number(q.w),
        ),
        "matrix" => {
            let rows = target_from_source.to_homogeneous();
            let lines: Vec<String> = rows
                .row_iter()
                .map(|row| list(&row.iter().copied().collect::<Vec<_>>()))
                .collect();
            writeln!(out, "# {name}\n{}", lines.join("\n"))
        }
        "quaternion" => writeln!(
            out,
            "# {name}: x y z (m), qx qy qz qw (Hamilton)\n{}",
            list(&[t.x, t.y, t.z, q.x, q.y, q.z, q.w])
        ),
        _ => writeln!(
            out,
            "# {name}: x y z (m), roll pitch yaw (rad), R = Rz(yaw) Ry(pitch) Rx(roll); in degrees {}\n{}",
            list(&[roll.to_degrees(), pitch.to_degrees(), yaw.to_degrees()]),
            list(&[t.x, t.y, t.z, roll, pitch, yaw])
        ),
    };
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}
