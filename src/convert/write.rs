//! Templates filled with the numbers of a transform.

use nalgebra::{Isometry3, Matrix4};

use crate::math::rotation::to_rpy;
use crate::tables::{Angle, FileTemplate, Length};

use super::kinds::Assignment;

/// A number as every reader of YAML and JSON accepts it: with a point, without an exponent.
pub(super) fn number(value: f64) -> String {
    // Rounding errors of zero.
    if value.abs() < 1e-14 {
        return "0.0".to_owned();
    }
    let text = value.to_string();
    if text.contains('.') { text } else { text + ".0" }
}

fn joined(values: impl IntoIterator<Item = f64>, between: &str) -> String {
    values.into_iter().map(number).collect::<Vec<_>>().join(between)
}

/// The text of one transform.
pub(super) fn item(cast: &Assignment<'_>, target_from_source: &Isometry3<f64>) -> Result<String, String> {
    let length = cast.keyed.as_ref().map_or(Length::Metres, |keyed| keyed.length);
    let angle = cast.keyed.as_ref().map_or(Angle::Radians, |keyed| keyed.angle);
    let scale = match length {
        Length::Metres => 1.0,
        Length::Millimetres => 1000.0,
    };
    let turn = |radians: f64| match angle {
        Angle::Radians => radians,
        Angle::Degrees => radians.to_degrees(),
    };
    let t = target_from_source.translation.vector * scale;
    let inverse = target_from_source.inverse().translation.vector * scale;
    let q = target_from_source.rotation.coords;
    let (roll, pitch, yaw) = to_rpy(&target_from_source.rotation);
    let mut matrix: Matrix4<f64> = target_from_source.to_homogeneous();
    matrix.fixed_view_mut::<3, 1>(0, 3).copy_from(&t);
    let rows: Vec<Vec<f64>> = matrix.row_iter().map(|row| row.iter().copied().collect()).collect();
    let flat = || rows.iter().flatten().copied();
    let rotation = || rows.iter().take(3).flat_map(|row| row.iter().take(3)).copied();
    let list: Vec<String> = rows
        .iter()
        .map(|row| format!("- [{}]", joined(row.iter().copied(), ", ")))
        .collect();
    let lines: Vec<String> = rows.iter().map(|row| joined(row.iter().copied(), " ")).collect();
    let values: [(&str, String); 26] = [
        ("{tx}", number(t.x)),
        ("{ty}", number(t.y)),
        ("{tz}", number(t.z)),
        ("{itx}", number(inverse.x)),
        ("{ity}", number(inverse.y)),
        ("{itz}", number(inverse.z)),
        ("{qx}", number(q.x)),
        ("{qy}", number(q.y)),
        ("{qz}", number(q.z)),
        ("{qw}", number(q.w)),
        ("{roll}", number(turn(roll))),
        ("{pitch}", number(turn(pitch))),
        ("{yaw}", number(turn(yaw))),
        ("{t}", joined([t.x, t.y, t.z], ", ")),
        ("{t_}", joined([t.x, t.y, t.z], " ")),
        ("{xyzw}", joined([q.x, q.y, q.z, q.w], ", ")),
        ("{wxyz}", joined([q.w, q.x, q.y, q.z], ", ")),
        ("{R}", joined(rotation(), ", ")),
        ("{R_}", joined(rotation(), " ")),
        ("{T}", joined(flat(), ", ")),
        ("{T12_}", joined(flat().take(12), " ")),
        ("{Tlist}", list.join("\n")),
        ("{Tlines}", lines.join("\n")),
        ("{n}", cast.number.to_string()),
        ("{name}", spelled(&cast.name)?),
        ("{target}", spelled(&cast.target)?),
    ];
    Ok(filled(&cast.transform.write, &values))
}

/// A frame's name, if any of the files may contain it.
fn spelled(frame: &str) -> Result<String, String> {
    let is_plain = !frame.contains(['"', '\\', ':', ',', '{', '}', '[', ']', '#', '\n']);
    if is_plain {
        Ok(frame.to_owned())
    } else {
        Err(format!(
            "the frame name `{}` contains characters that cannot be written",
            frame.escape_debug()
        ))
    }
}

/// Inserts values; each line of a value is indented like its place.
fn filled(template: &str, values: &[(&str, String)]) -> String {
    let mut out = String::with_capacity(template.len() * 2);
    for (index, line) in template.split('\n').enumerate() {
        if index > 0 {
            out.push('\n');
        }
        let mut line = line.to_owned();
        for (place, value) in values {
            while let Some(at) = line.find(place) {
                let before = line.get(..at).unwrap_or_default();
                let blanks: String = before.chars().take_while(|letter| letter.is_whitespace()).collect();
                let value = value.replace('\n', &format!("\n{blanks}"));
                line.replace_range(at..at + place.len(), &value);
            }
        }
        out.push_str(&line);
    }
    out
}

/// The file around its transforms; those that begin with the same key are grouped under it.
pub(super) fn file(writing: &FileTemplate, items: &[String]) -> String {
    let mut grouped: Vec<String> = Vec::new();
    for item in items {
        let (key, rest) = item.split_once('\n').unwrap_or((item, ""));
        let known = grouped.iter_mut().find(|group| group.lines().next() == Some(key));
        match known.filter(|_| key.ends_with(':')) {
            Some(group) => {
                group.push('\n');
                group.push_str(rest);
            }
            None => grouped.push(item.clone()),
        }
    }
    let all = grouped.join(writing.join.as_deref().unwrap_or("\n"));
    filled(&writing.file, &[("{items}", all)])
}
