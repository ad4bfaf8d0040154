//! Recorded packets of real lidars, compared with what another decoder made of them.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::panic)]
#![allow(clippy::cast_possible_truncation)] // coordinates are float32, cells small

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

use frames_lint::collect::format_of;
use frames_lint::read::bag::{self, Channel, Message, Recording, Selection, Visit};
use frames_lint::read::messages::content::Body;
use frames_lint::read::messages::decoder::Decoder;
use frames_lint::read::messages::definition::Definitions;
use frames_lint::source::{Source, SourceId, SourceKind};
use frames_lint::verdict::Severity;

use crate::support;
use crate::support::at_hand::lidar_packets;

type Point = [f32; 3];

/// The points of every message.
#[derive(Default)]
struct Points {
    decoders: Vec<Decoder>,
    seen: Vec<Point>,
    models: Vec<String>,
}

impl Visit for Points {
    fn channel(&mut self, channel: &Channel) {
        let format = format_of(channel);
        self.decoders.push(Decoder::of(&format, &Definitions::builtin()));
    }

    fn message(&mut self, channel: &Channel, message: &Message<'_>) {
        let content = self.decoders[channel.number].decode(message.data).unwrap();
        let Body::Packets(scan) = content.body else { return };
        let decoded = scan.decode(content.header.unwrap().stamp_ns).unwrap();
        assert_eq!((decoded.refused, decoded.reason), (0, None));
        self.models.push(decoded.model.into_owned());
        let cloud = decoded.cloud;
        let axes = ["x", "y", "z"].map(|name| cloud.column(name).unwrap());
        let point = |number| axes.map(|axis| axis.of(cloud.point(0, number).unwrap()).unwrap() as f32);
        self.seen.extend((0..cloud.width).map(point));
    }

    fn seam(&mut self) {}
}

/// x, y and z of a PCD file with binary data.
fn reference(path: &Path) -> Vec<Point> {
    let bytes = fs::read(path).unwrap();
    let end = b"DATA binary\n";
    let data = bytes.windows(end.len()).position(|part| part == end).unwrap() + end.len();
    let head = String::from_utf8_lossy(&bytes[..data]).into_owned();
    let sizes = head.lines().find_map(|line| line.strip_prefix("SIZE ")).unwrap();
    let step: usize = sizes
        .split_whitespace()
        .map(|size| size.parse::<usize>().unwrap())
        .sum();
    assert!(head.contains("FIELDS x y z"));
    let float = |point: &[u8], at: usize| f32::from_le_bytes(point[at..at + 4].try_into().unwrap());
    let points = bytes[data..].chunks_exact(step);
    points.map(|point| [0, 4, 8].map(|at| float(point, at))).collect()
}

/// The largest distance from a reference to the nearest of the points, as far as that is below a centimetre; and how many have none.
fn farthest(references: &[Point], points: &[Point]) -> (f32, usize) {
    const CELL: f32 = 0.01;
    let cell = |point: &Point| point.map(|value| (value / CELL).floor() as i32);
    let mut cells: HashMap<[i32; 3], Vec<Point>> = HashMap::new();
    for point in points {
        cells.entry(cell(point)).or_default().push(*point);
    }
    let (mut most, mut alone) = (0.0_f32, 0);
    for one in references {
        let [x, y, z] = cell(one);
        let around = (-1..=1).flat_map(|i| (-1..=1).flat_map(move |j| (-1..=1).map(move |k| [x + i, y + j, z + k])));
        let near = around.filter_map(|cell| cells.get(&cell)).flatten();
        let squared = near.map(|point| (0..3).map(|axis| (point[axis] - one[axis]).powi(2)).sum::<f32>());
        match squared.reduce(f32::min).map(f32::sqrt).filter(|off| *off <= CELL) {
            Some(off) => most = most.max(off),
            None => alone += 1,
        }
    }
    (most, alone)
}

/// The recording and the cloud of another decoder in a folder.
fn both(folder: &Path) -> (PathBuf, PathBuf) {
    let entries = || fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let cloud = entries().find(|path| path.extension().is_some_and(|ending| ending == "pcd"));
    (entries().find(|path| path.is_dir()).unwrap(), cloud.unwrap())
}

#[test]
fn points_are_those_of_another_decoder() {
    let Some(folder) = lidar_packets() else { return };
    for (name, model) in [
        ("vlp16", "VLP-16"),
        ("vls128", "VLS-128"),
        ("40p", "Pandar40P"),
        ("xt32", "PandarXT32"),
        ("qt128", "PandarQT128"),
    ] {
        let (recording, cloud) = both(&folder.join(name));
        let mut source = Source::new(SourceId(0), name, SourceKind::Rosbag2);
        let mut read = Points::default();
        let whole = Recording {
            path: &recording,
            parts: &[],
        };
        bag::read(&whole, &Selection::ALL, &mut source, &|_, _| {}, &mut read);
        assert!(
            read.models.iter().all(|known| known == model),
            "{name}: {:?}",
            read.models
        );
        let references = reference(&cloud);
        let (off_m, alone) = farthest(&references, &read.seen);
        assert!(
            alone == 0 && off_m < 0.002,
            "{name}: {off_m} m, {alone} of {} have no point",
            references.len()
        );
    }
}

#[test]
fn real_packets_have_no_finding() {
    let Some(folder) = lidar_packets() else { return };
    for name in ["vlp16", "vls128", "40p", "xt32", "qt128"] {
        let run = support::checked(&both(&folder.join(name)).0);
        let findings = run
            .verdict
            .findings
            .iter()
            .filter(|finding| finding.severity >= Severity::Warning);
        let said: Vec<String> = findings.map(crate::bag_faults::describe).collect();
        assert!(said.is_empty(), "{name}: {said:?}");
        assert!(run.sources.iter().all(|source| source.problems.is_empty()), "{name}");
    }
}

#[test]
fn real_calibrations_of_beams_have_no_finding() {
    let Some(folder) = lidar_packets() else { return };
    let run = support::checked(&folder.join("calibration"));
    let said: Vec<String> = run.verdict.findings.iter().map(crate::bag_faults::describe).collect();
    assert!(said.is_empty(), "{said:?}");
    let rows = run.verdict.rows.iter().filter(|row| row.rule == "SENSOR11");
    // Four things are judged in most of the 18 files: numbers, elevations, azimuths, the unit of distances.
    assert!(rows.filter(|row| row.outcome.word() == "pass").count() >= 50);
}
