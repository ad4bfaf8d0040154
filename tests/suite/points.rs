//! Files of points: every format gives the numbers that were written, large files are read in bounded time, and damaged ones say what is wrong.

#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use std::io::Cursor;

use frames_lint::engine::{self, Options};
use frames_lint::read::points;
use frames_lint::source::{ReadStatus, Source, SourceId, SourceKind};
use frames_lint::world::PointFile;

use crate::support::point_files::PointsRecipe;

fn read(bytes: &[u8]) -> (Source, Option<PointFile>) {
    let mut source = Source::new(SourceId(0), "map", SourceKind::Points);
    let mut facts = points::read(Cursor::new(bytes), &mut source);
    (source, facts.point_files.pop())
}

/// Every form that is written, with its ending.
const FORMS: &[(&str, &str)] = &[
    ("pcd", "data: ascii"),
    ("pcd", "data: binary"),
    ("pcd", "data: binary_compressed"),
    ("pcd", "{data: binary_compressed, double: true}"),
    ("ply", "data: ascii"),
    ("ply", "data: binary_little_endian"),
    ("ply", "{data: binary_big_endian, double: true}"),
    ("las", "scale: 0.001"),
    ("las", "layered: true"),
    ("laz", "scale: 0.001"),
    ("laz", "layered: true"),
];

#[test]
fn every_form_has_the_same_points() {
    for (ending, text) in FORMS {
        let recipe = PointsRecipe::parse(text);
        let (source, file) = read(&recipe.bytes(ending));
        assert_eq!(
            (source.status, source.problems.len()),
            (ReadStatus::Read, 0),
            "{ending} {text} {source:?}"
        );
        let file = file.unwrap();
        assert_eq!((file.stated, file.read), (2000, 2000), "{ending} {text}");
        let seen = file.seen.unwrap();
        for axis in 0..3 {
            let values = || recipe.xyz().into_iter().map(move |point| point[axis]);
            let off = (seen.least[axis] - values().fold(f64::MAX, f64::min)).abs();
            assert!(off <= 0.001, "{ending} {text} {axis}");
            assert!(
                (seen.most[axis] - values().fold(f64::MIN, f64::max)).abs() <= 0.001,
                "{ending} {text}"
            );
        }
    }
}

#[test]
fn a_large_file_is_sampled() {
    for ending in ["pcd", "las", "laz"] {
        let recipe = PointsRecipe::parse("{points: 500000, size: [600, 150]}");
        let bytes = recipe.bytes(ending);
        let (source, file) = read(&bytes);
        let file = file.unwrap();
        assert_eq!(source.status, ReadStatus::Read, "{ending} {source:?}");
        assert!((30_000..=200_000).contains(&file.read), "{ending} {}", file.read);
        assert!(
            ending == "laz" || source.examined.bytes < source.examined.bytes_total / 2 + 100_000,
            "{ending}"
        );
        let seen = file.seen.unwrap();
        assert!(seen.most[0] - seen.least[0] > 595.0, "{ending}: the sample is spread");
    }
}

#[test]
fn damage_is_said_and_nothing_panics() {
    for (ending, text) in FORMS {
        let whole = PointsRecipe::parse(text).bytes(ending);
        for share in [0, 1, 2, 5, 9] {
            let cut = &whole[..whole.len() * share / 10];
            let (source, _) = read(cut);
            assert!(
                source.status != ReadStatus::Read,
                "{ending} {text}: cut at {share} tenths"
            );
            assert!(!source.problems.is_empty(), "{ending} {text}");
        }
        let mut rng = fastrand::Rng::with_seed(11);
        for _ in 0..60 {
            let mut damaged = whole.clone();
            for _ in 0..rng.usize(1..6) {
                // Most damage in the header.
                let end = if rng.bool() {
                    damaged.len().min(500)
                } else {
                    damaged.len()
                };
                let at = rng.usize(..end);
                damaged[at] = rng.u8(..);
            }
            let (source, file) = read(&damaged);
            assert!(
                file.is_some() || source.status == ReadStatus::Unreadable,
                "{ending} {text}"
            );
        }
    }
}

#[test]
fn faults_of_headers_have_a_place() {
    let header = |line: &str, instead: &str| {
        let text = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 1\nDATA ascii\n1 2 3\n";
        let (source, _) = read(text.replace(line, instead).as_bytes());
        let problem = source.problems.into_iter().next().unwrap();
        let span = problem
            .place
            .span()
            .map(|span| source.text[span.start..span.end].to_owned());
        (source.status, problem.message, span)
    };
    let (status, message, span) = header("POINTS 1", "POINTS 4");
    assert_eq!(
        (status, span.as_deref()),
        (ReadStatus::Partial, Some("POINTS 4")),
        "{message}"
    );
    let (status, message, span) = header("VIEWPOINT 0 0 0 1 0 0 0", "VIEWPOINT 0 0 0");
    assert_eq!(
        (status, span.as_deref()),
        (ReadStatus::Unreadable, Some("VIEWPOINT 0 0 0")),
        "{message}"
    );
    let (_, message, span) = header("DATA ascii", "DATA zip");
    assert_eq!(span.as_deref(), Some("DATA zip"), "{message}");
    let (_, message, span) = header("SIZE 4 4 4", "SIZE 4 4");
    assert_eq!(span.as_deref(), Some("SIZE 4 4"), "{message}");
    let (_, message, _) = header("FIELDS x y z", "FIELDS x y a");
    assert!(message.contains("no `z`"), "{message}");
    let (_, message, _) = header("WIDTH 1", "WIDTH 99999999999999999999");
    assert!(message.contains("not a number of points"), "{message}");
}

#[test]
fn meshes_and_splats_are_no_clouds_and_series_are_thinned() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    let head = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
    write(
        "mesh.ply",
        format!("{head}element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n3 0 0 0\n")
            .as_bytes(),
    );
    write(
        "splat.ply",
        format!("{head}property float f_dc_0\nend_header\n0 0 0 1\n").as_bytes(),
    );
    let scan = PointsRecipe::parse("points: 50").bytes("pcd");
    for index in 0..40 {
        write(&format!("{index:03}.pcd"), &scan);
    }
    let options = Options {
        paths: vec![folder.path().to_path_buf()],
        ..Options::default()
    };
    let run = engine::check(&options).unwrap();
    let names: Vec<&str> = run
        .sources
        .iter()
        .map(|source| source.path.rsplit('/').next().unwrap())
        .collect();
    assert_eq!(names, ["000.pcd", "010.pcd", "020.pcd", "030.pcd", "039.pcd"]);
    assert_eq!(run.skipped.get("ply"), Some(&2));
    assert_eq!(run.skipped.get("pcd of a series (5 are read)"), Some(&35));
}
