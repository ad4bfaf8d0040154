//! Transforms written in dialects, for tests.

use std::fs;
use std::path::{Path, PathBuf};

use frames_lint::convert::{Conversion, ConvertRequest, convert};
use frames_lint::engine;
use frames_lint::run::Run;
use frames_lint::tables::{FileTemplate, Tables, TransformTemplate};
use nalgebra::Isometry3;

/// What is read of a file or folder.
pub fn read(path: &Path) -> Run {
    engine::read(&engine::Options {
        paths: vec![path.to_path_buf()],
        ..engine::Options::default()
    })
    .unwrap()
}

/// Converts what was read.
pub fn to(run: &Run, wish: &ConvertRequest) -> Result<Conversion, String> {
    convert(run, Tables::default().dialects(), wish)
}

/// A file whose keys say their frames, which no dialect has written.
pub fn plain(folder: &Path, links: &[(&str, &str, Isometry3<f64>)]) -> PathBuf {
    let link = |(target, source, pose): &(&str, &str, Isometry3<f64>)| {
        let (t, q) = (pose.translation.vector, pose.rotation.coords);
        format!(
            "- parent: {target}\n  child: {source}\n  translation: {{x: {:?}, y: {:?}, z: {:?}}}\n  rotation: {{x: {:?}, y: {:?}, z: {:?}, w: {:?}}}\n",
            t.x, t.y, t.z, q.x, q.y, q.z, q.w
        )
    };
    let text: String = links.iter().map(link).collect();
    let path = folder.join("plain.yaml");
    fs::write(&path, text).unwrap();
    path
}

/// The frames that a transform of a dialect has in a file, `(target, source)`.
pub fn frames(writing: &FileTemplate, transform: &TransformTemplate) -> (String, String) {
    let tables = Tables::default();
    let mut rows = tables.dialects().iter().filter(|row| row.name == writing.dialect);
    let is = transform.is.clone().or_else(|| {
        let keyed = rows.find_map(|row| row.transforms.iter().find(|keyed| keyed.keys.contains(&transform.key)))?;
        keyed.is.clone()
    });
    let is = is.unwrap_or_else(|| {
        let name = frames_lint::world::transform_name::parse(&transform.key).unwrap();
        format!("{} from {}", name.target, name.source)
    });
    let (target, source) = is.split_once(" from ").unwrap();
    let first = if is.contains("#-1") { "1" } else { "0" };
    let frame = |word: &str, any: &str| {
        if word == "*" || word.starts_with('@') {
            any.to_owned()
        } else {
            word.replace("#-1", "0").replace("#2", first).replace('#', first)
        }
    };
    // Autoware's parents are known by their names.
    let reference = if writing.dialect == "autoware" {
        "base_link"
    } else {
        "reference"
    };
    (frame(target, reference), frame(source, "sensor_a"))
}

/// What one transform is in the dialect.
pub fn converted(
    writing: &FileTemplate,
    transform: &TransformTemplate,
    target_from_source: Isometry3<f64>,
) -> Conversion {
    let (target, source) = frames(writing, transform);
    let folder = tempfile::tempdir().unwrap();
    let run = read(&plain(folder.path(), &[(&target, &source, target_from_source)]));
    let wish = ConvertRequest {
        to: writing.dialect.clone(),
        frames: Some((target, source)),
        key: Some(transform.key.clone()),
        ..ConvertRequest::default()
    };
    to(&run, &wish).unwrap()
}

/// Puts it into a folder under the name that it must have.
pub fn written(folder: &Path, writing: &FileTemplate, transform: &TransformTemplate, text: &str) -> PathBuf {
    let name = transform
        .named
        .clone()
        .unwrap_or_else(|| format!("written.{}", writing.ending));
    let path = folder.join(name);
    fs::write(&path, text).unwrap();
    path
}
