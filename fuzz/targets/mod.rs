//! The fuzz targets: each takes any bytes, and panics if a promise is broken.
//!
//! The fuzzer runs them on the inputs of libFuzzer, the tests on every input in `fuzz/seeds`.

mod cdr;
mod choices;
mod code;
mod config;
mod db3;
mod definition;
mod evidence;
mod feather;
mod foxglove;
mod json;
mod launch;
mod made_bag;
mod made_calibration;
mod made_urdf;
mod mcap;
mod metadata;
mod osf;
mod ouster;
mod packets;
mod pcap;
mod plain;
mod points;
mod rosbag1;
mod urdf;
mod yaml;

use std::io::Write;

use frames_lint::collect::{CollectOptions, collect};
use frames_lint::read::bag::Sampling;
use frames_lint::read::text;
use frames_lint::source::{ReadStatus, Source, SourceId, SourceKind};

/// Bytes as a source, if they are a text.
fn source(bytes: &[u8], name: &str, kind: SourceKind) -> Option<Source> {
    let (text, _note) = text::decode(bytes.to_vec()).ok()?;
    let mut source = Source::new(SourceId(0), name, kind);
    source.text = text;
    Some(source)
}

/// Collects a recording of these bytes, after the magic bytes of its format. Parts that were not read must be reported.
fn recorded(magic: &[u8], bytes: &[u8], kind: SourceKind, sampling: Option<Sampling>) {
    let mut file = tempfile::NamedTempFile::new().expect("a temporary file");
    file.write_all(magic).expect("writable");
    file.write_all(bytes).expect("writable");
    let mut source = Source::new(SourceId(0), "fuzz", kind);
    let how = CollectOptions {
        sampling,
        ..CollectOptions::default()
    };
    drop(collect(file.path(), &how, &mut source, &|_, _| {}));
    assert!(source.status == ReadStatus::Read || !source.problems.is_empty());
    assert!(source.examined.bytes <= source.examined.bytes_total);
}

/// A target.
pub type Target = fn(&[u8]);

/// Every target by its name, which is the name of the folder of its seeds.
pub const TARGETS: &[(&str, Target)] = &[
    ("cdr", cdr::run),
    ("code", code::run),
    ("config", config::run),
    ("db3", db3::run),
    ("definition", definition::run),
    ("evidence", evidence::run),
    ("feather", feather::run),
    ("foxglove", foxglove::run),
    ("json", json::run),
    ("launch", launch::run),
    ("made_bag", made_bag::run),
    ("made_calibration", made_calibration::run),
    ("made_urdf", made_urdf::run),
    ("mcap", mcap::run),
    ("metadata", metadata::run),
    ("osf", osf::run),
    ("ouster", ouster::run),
    ("packets", packets::run),
    ("pcap", pcap::run),
    ("plain", plain::run),
    ("points", points::run),
    ("rosbag1", rosbag1::run),
    ("urdf", urdf::run),
    ("yaml", yaml::run),
];
