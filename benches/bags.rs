//! The cost of checking a long drive, compared with a linear pass of the mcap crate, decompression only, and other tools.
//!
//! The drives are generated: lidar 10 Hz, camera 30 Hz, IMU 200 Hz, TF 100 Hz. `FRAMES_LINT_BENCH_GB` is the size of their
//! messages (4 without it), `FRAMES_LINT_BENCH_TENFOLD=1` adds a drive ten times as long, `FRAMES_LINT_BENCH_DIR` is where
//! they are kept (`target/bench`). Then drives of a large lidar, 128 x 2048 points at 10 Hz: `FRAMES_LINT_BENCH_CLOUD_S` lists their
//! seconds (15,60; 600 are ten minutes, in 25 GB), `FRAMES_LINT_BENCH_GB=0` skips the others. Other tools are run if they are on PATH:
//! `mcap doctor`, `pymcap-cli tftree`. Measured are user plus system time of a separate process, and its peak of resident memory; the best
//! of several runs.

#![allow(
    clippy::print_stdout,
    clippy::expect_used,
    clippy::indexing_slicing,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::panic,
    clippy::unwrap_used
)]

#[path = "clouds/drive.rs"]
mod clouds;
#[path = "../tests/support/encode.rs"]
#[allow(dead_code, unreachable_pub)]
mod encode;
#[path = "../tests/support/schemas.rs"]
#[allow(dead_code, unreachable_pub)]
mod schemas;

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufReader, BufWriter, Read};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use encode::{Body, Endian, Field, Header, Transform};
use fastrand::Rng;
use mcap::records::MessageHeader;
use mcap::{Compression, WriteOptions, Writer};
use nix::sys::resource::{Resource, UsageWho, getrusage, setrlimit};

const START_NS: i64 = 1_700_000_000_000_000_000;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        ["measure", program, rest @ ..] => measure(program, rest),
        ["linear", file] => linear(Path::new(file)),
        ["inflate", file] => inflate(Path::new(file)),
        _ => compare(),
    }
}

fn compare() {
    let gigabytes: f64 = std::env::var("FRAMES_LINT_BENCH_GB").map_or(4.0, |text| text.parse().expect("a number"));
    let folder = std::env::var_os("FRAMES_LINT_BENCH_DIR").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("target/bench"),
        PathBuf::from,
    );
    std::fs::create_dir_all(&folder).expect("the folder can be made");
    let zstd = Some(Compression::Zstd);
    let lz4 = Some(Compression::Lz4);
    let mut drives = vec![
        ("zstd, 768 KiB chunks", zstd, 768 << 10, 1.0),
        ("zstd, 8 MiB chunks", zstd, 8 << 20, 1.0),
        ("lz4, 768 KiB chunks", lz4, 768 << 10, 1.0),
        ("lz4, 8 MiB chunks", lz4, 8 << 20, 1.0),
    ];
    if std::env::var_os("FRAMES_LINT_BENCH_TENFOLD").is_some() {
        drives.push(("zstd, 768 KiB chunks, ten times as long", zstd, 768 << 10, 10.0));
    }
    if gigabytes <= 0.0 {
        drives.clear();
    }
    for (what, compression, chunk, times) in drives {
        let size = gigabytes * times;
        let name = format!("drive-{compression:?}-{chunk}-{size}.mcap").replace(['(', ')'], "-");
        let path = folder.join(name);
        if !path.exists() {
            write_drive(&path, compression, chunk, (size * 1e9) as u64);
        }
        let bytes = path.metadata().expect("the drive is there").len();
        println!("\n{what}: {size} GB of messages in {:.2} GB", bytes as f64 / 1e9);
        let file = path.to_str().expect("a path in UTF-8");
        let itself = std::env::current_exe().expect("this program has a path");
        let itself = itself.to_str().expect("a path in UTF-8").to_owned();
        let ours = env!("CARGO_BIN_EXE_frames-lint");
        // Once, so that every run finds the file in the page cache, if there is room.
        run(&itself, &["inflate", file]);
        let linear = best("linear pass of the mcap crate", 3, &itself, &["linear", file]);
        let alone = best("decompressing alone", 3, &itself, &["inflate", file]);
        let check = ["check", "--format", "json", "--output", "/dev/null", file];
        let default = best("frames-lint check", 5, ours, &check);
        let full = best("frames-lint check --full", 3, ours, &[&check[..], &["--full"]].concat());
        best("mcap doctor", 1, "mcap", &["doctor", file]);
        if times < 2.0 {
            best("pymcap-cli tftree", 1, "pymcap-cli", &["tftree", file]);
        }
        if let (Some(linear), Some(alone), Some(default), Some(full)) = (linear, alone, default, full) {
            println!("  the linear pass costs {:.1} times the check", linear / default);
            println!("  --full costs {:.2} times decompressing alone", full / alone);
        }
    }
    compare_clouds(&folder);
}

/// Limits for ten minutes of clouds: CPU seconds and MB.
const MOST: (f64, f64) = (10.0, 400.0);

/// Drives of a large lidar, of several lengths: by default, the amount read does not grow with the length.
fn compare_clouds(folder: &Path) {
    let lengths = std::env::var("FRAMES_LINT_BENCH_CLOUD_S").unwrap_or_else(|_| "15,60".to_owned());
    for seconds in lengths.split(',').filter(|word| !word.is_empty()) {
        let seconds: u32 = seconds.parse().expect("a number");
        let path = folder.join(format!("clouds-{seconds}.mcap"));
        if !path.exists() {
            clouds::write(&path, seconds);
        }
        let bytes = path.metadata().expect("the drive is there").len();
        let held = f64::from(seconds) * 10.0 * clouds::CLOUD_BYTES as f64;
        println!(
            "\nclouds of 128 x 2048 points, {seconds} s: {:.2} GB of points in {:.2} GB",
            held / 1e9,
            bytes as f64 / 1e9
        );
        let file = path.to_str().expect("a path in UTF-8");
        let itself = std::env::current_exe().expect("this program has a path");
        let itself = itself.to_str().expect("a path in UTF-8").to_owned();
        let ours = env!("CARGO_BIN_EXE_frames-lint");
        run(&itself, &["inflate", file]);
        let linear = best("linear pass of the mcap crate", 1, &itself, &["linear", file]);
        best("decompressing alone", 1, &itself, &["inflate", file]);
        let check = ["check", "--format", "json", "--output", "/dev/null", file];
        let default = best("frames-lint check", 3, ours, &check);
        if seconds <= 60 {
            best("frames-lint check --full", 1, ours, &[&check[..], &["--full"]].concat());
        }
        best("mcap doctor", 1, "mcap", &["doctor", file]);
        if let (Some(linear), Some(default)) = (linear, default) {
            println!(
                "  the linear pass costs {:.1} times the check; allowed are {} s and {} MB",
                linear / default,
                MOST.0,
                MOST.1
            );
        }
    }
}

/// Runs a program several times in a process that measures it; prints and returns the best CPU time, seconds.
fn best(what: &str, runs: u32, program: &str, arguments: &[&str]) -> Option<f64> {
    let found: Vec<(f64, f64)> = (0..runs).filter_map(|_| run(program, arguments)).collect();
    let Some((cpu, _)) = found.iter().copied().reduce(|a, b| if b.0 < a.0 { b } else { a }) else {
        println!("  {what}: not on PATH, or it failed");
        return None;
    };
    let memory = found.iter().map(|(_, memory)| *memory).fold(0.0, f64::max);
    println!("  {what}: {cpu:.3} s CPU, {memory:.0} MB");
    Some(cpu)
}

fn run(program: &str, arguments: &[&str]) -> Option<(f64, f64)> {
    let output = Command::new(std::env::current_exe().ok()?)
        .args(["measure", program])
        .args(arguments)
        .output()
        .ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    let mut numbers = text.split_whitespace().filter_map(|word| word.parse::<f64>().ok());
    Some((numbers.next()?, numbers.next()?))
}

/// Runs one program and prints its CPU time, seconds, and its peak of memory, MB.
fn measure(program: &str, arguments: &[&str]) {
    let _ = setrlimit(Resource::RLIMIT_CORE, 0, 0);
    let status = Command::new(program)
        .args(arguments)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    // Findings give exit code 1; only a program that did not run is not a measurement.
    if !status.is_ok_and(|status| status.code().is_some_and(|code| code < 3)) {
        return;
    }
    let usage = getrusage(UsageWho::RUSAGE_CHILDREN).expect("getrusage");
    let time = |t: nix::sys::time::TimeVal| {
        Duration::from_secs(t.tv_sec().unsigned_abs()) + Duration::from_micros(t.tv_usec().unsigned_abs())
    };
    let cpu = time(usage.user_time()) + time(usage.system_time());
    println!("{} {}", cpu.as_secs_f64(), usage.max_rss() as f64 / 1024.0);
}

/// Reads every message once, with the mcap crate, from a memory map.
fn linear(path: &Path) {
    use mcap::sans_io::{LinearReadEvent, LinearReader};
    let mut file = BufReader::with_capacity(1 << 18, File::open(path).expect("the drive opens"));
    let mut reader = LinearReader::new();
    let (mut messages, mut bytes) = (0_u64, 0_u64);
    while let Some(event) = reader.next_event() {
        match event.expect("the drive is sound") {
            LinearReadEvent::ReadRequest(wanted) => {
                let read = file.read(reader.insert(wanted)).expect("the drive is readable");
                reader.notify_read(read);
            }
            LinearReadEvent::Record { data, opcode } => {
                if opcode == mcap::records::op::MESSAGE {
                    messages += 1;
                    bytes += data.len() as u64;
                }
            }
        }
    }
    assert!(messages > 0 && bytes > 0);
}

/// Decompresses every chunk, without reading it.
fn inflate(path: &Path) {
    let mut file = BufReader::with_capacity(1 << 18, File::open(path).expect("the drive opens"));
    let mut zstd = zstd::bulk::Decompressor::new().expect("a decompressor");
    let (mut packed, mut plain) = (Vec::new(), Vec::new());
    let mut magic = [0; 8];
    file.read_exact(&mut magic).expect("the magic");
    let mut frame = [0; 9];
    while file.read_exact(&mut frame).is_ok() {
        let length = u64::from_le_bytes(frame[1..].try_into().unwrap()) as usize;
        packed.resize(length, 0);
        if file.read_exact(&mut packed).is_err() {
            break;
        }
        if frame[0] != mcap::records::op::CHUNK {
            continue;
        }
        let size = u64::from_le_bytes(packed[16..24].try_into().unwrap()) as usize;
        let name = u32::from_le_bytes(packed[28..32].try_into().unwrap()) as usize;
        let data = &packed[32 + name + 8..];
        plain.clear();
        plain.reserve(size);
        match &packed[32..32 + name] {
            b"zstd" => {
                zstd.decompress_to_buffer(data, &mut plain).expect("a sound chunk");
            }
            b"lz4" => {
                lz4::Decoder::new(data)
                    .and_then(|mut decoder| decoder.read_to_end(&mut plain))
                    .expect("a sound chunk");
            }
            _ => plain.extend_from_slice(data),
        }
        assert_eq!(plain.len(), size);
    }
}

/// Points of a spinning lidar: x y z intensity as f32, in steps of a millimetre, so that they compress like real ones.
fn cloud(random: &mut Rng) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(65_536 * 16);
    for point in 0..65_536_u32 {
        let azimuth = f64::from(point / 64) / 1024.0 * std::f64::consts::TAU;
        let range = 5.0 + f64::from(point % 64) * 0.7 + f64::from(random.u32(..100)) * 0.001;
        for value in [
            range * azimuth.cos(),
            range * azimuth.sin(),
            -1.8 + f64::from(point % 64) * 0.02,
        ] {
            bytes.extend(((value * 1000.0).round() as f32 / 1000.0).to_le_bytes());
        }
        bytes.extend(f32::from(random.u8(..64)).to_le_bytes());
    }
    bytes
}

/// A compressed image: bytes that do not compress again.
fn image(random: &mut Rng) -> Vec<u8> {
    let mut bytes = vec![0; 262_144];
    random.fill(&mut bytes);
    bytes
}

/// Where the vehicle is: on a circle of 50 m, at 10 m/s, to the left.
struct Circle {
    position: [f64; 3],
    orientation: [f64; 4],
}

const RADIUS_M: f64 = 50.0;
const SPEED_M_S: f64 = 10.0;

impl Circle {
    fn at(seconds: f64) -> Self {
        let yaw = seconds * SPEED_M_S / RADIUS_M;
        Self {
            position: [RADIUS_M * yaw.sin(), RADIUS_M * (1.0 - yaw.cos()), 0.0],
            orientation: [0.0, 0.0, (yaw / 2.0).sin(), (yaw / 2.0).cos()],
        }
    }

    /// Orientation, rate and specific force, each with its covariance.
    fn imu(&self) -> Vec<f64> {
        let covariance = |variance: f64| [variance, 0.0, 0.0, 0.0, variance, 0.0, 0.0, 0.0, variance];
        let mut numbers = self.orientation.to_vec();
        numbers.extend(covariance(1e-4));
        numbers.extend([0.0, 0.0, SPEED_M_S / RADIUS_M]);
        numbers.extend(covariance(1e-6));
        numbers.extend([0.0, SPEED_M_S * SPEED_M_S / RADIUS_M, 9.806_65]);
        numbers.extend(covariance(1e-3));
        numbers
    }

    /// Latitude, longitude and altitude, and the covariance.
    fn fix(&self) -> Vec<f64> {
        let [x, y, _] = self.position;
        let (north, east) = (111_200.0, 111_200.0 * 48f64.to_radians().cos());
        let mut numbers = vec![48.0 + y / north, 11.0 + x / east, 500.0];
        numbers.extend([4e-4, 0.0, 0.0, 0.0, 4e-4, 0.0, 0.0, 0.0, 1e-3]);
        numbers
    }
}

struct BagWriter {
    writer: Writer<BufWriter<File>>,
    channels: BTreeMap<&'static str, u16>,
    sequence: u32,
    bytes: u64,
}

impl BagWriter {
    fn channel(&mut self, topic: &'static str, message_type: &str) {
        let schema = schemas::definition(message_type);
        let schema = self
            .writer
            .add_schema(message_type, "ros2msg", schema.as_bytes())
            .expect("a schema");
        let channel = self
            .writer
            .add_channel(schema, topic, "cdr", &BTreeMap::new())
            .expect("a channel");
        self.channels.insert(topic, channel);
    }

    fn message(&mut self, topic: &str, at_ns: i64, data: &[u8]) {
        self.sequence += 1;
        self.bytes += data.len() as u64;
        let time = at_ns.unsigned_abs();
        let header = MessageHeader {
            channel_id: self.channels[topic],
            sequence: self.sequence,
            log_time: time,
            publish_time: time,
        };
        self.writer.write_to_known_channel(&header, data).expect("a message");
    }
}

fn write_drive(path: &Path, compression: Option<Compression>, chunk_bytes: u64, size: u64) {
    println!("writing {}", path.display());
    let unfinished = path.with_extension("unfinished");
    let file = BufWriter::new(File::create(&unfinished).expect("the drive can be written"));
    let writer = WriteOptions::new()
        .profile("ros2")
        .compression(compression)
        .chunk_size(Some(chunk_bytes))
        .create(file)
        .expect("a writer");
    let mut out = BagWriter {
        writer,
        channels: BTreeMap::new(),
        sequence: 0,
        bytes: 0,
    };
    for (topic, message_type) in [
        ("/tf_static", "tf2_msgs/msg/TFMessage"),
        ("/tf", "tf2_msgs/msg/TFMessage"),
        ("/imu", "sensor_msgs/msg/Imu"),
        ("/points", "sensor_msgs/msg/PointCloud2"),
        ("/image", "sensor_msgs/msg/CompressedImage"),
        ("/fix", "sensor_msgs/msg/NavSatFix"),
    ] {
        out.channel(topic, message_type);
    }
    let mut random = Rng::with_seed(7);
    let clouds: Vec<Vec<u8>> = (0..8).map(|_| cloud(&mut random)).collect();
    let mount = |child, z, rotation| Transform {
        header: Header {
            stamp_ns: START_NS,
            frame_id: "base_link",
        },
        child,
        translation: [0.3, 0.0, z],
        rotation,
    };
    let straight = [0.0, 0.0, 0.0, 1.0];
    let mounts = [
        mount("imu", 0.3, straight),
        mount("lidar", 1.8, straight),
        mount("camera_optical_frame", 1.5, [-0.5, 0.5, -0.5, 0.5]),
        mount("gps", 1.9, straight),
    ];
    out.message("/tf_static", START_NS, &Body::Tf(&mounts).encode(Endian::Little));
    let large = |frame_id, stamp_ns, data: &[u8]| {
        let mut message = Body::Padded(Header { stamp_ns, frame_id }).encode(Endian::Little);
        message.extend_from_slice(data);
        message
    };
    for tick in 0_i64.. {
        if out.bytes >= size {
            break;
        }
        // 600 ticks a second.
        let now = START_NS + tick * 1_000_000_000 / 600;
        let header = |frame_id| Header {
            stamp_ns: now,
            frame_id,
        };
        let number = usize::try_from(tick).expect("positive");
        let at = Circle::at(tick as f64 / 600.0);
        if tick % 3 == 0 {
            let imu = vec![Field::F64s(at.imu())];
            out.message("/imu", now, &Body::Fields(header("imu"), imu).encode(Endian::Little));
        }
        if tick % 6 == 0 {
            let transform = Transform {
                header: header("odom"),
                child: "base_link",
                translation: at.position,
                rotation: at.orientation,
            };
            out.message("/tf", now, &Body::Tf(&[transform]).encode(Endian::Little));
        }
        if tick % 60 == 0 {
            out.message(
                "/points",
                now,
                &large("lidar", now, &clouds[number / 60 % clouds.len()]),
            );
        }
        if tick % 20 == 0 {
            let image = image(&mut random);
            out.message("/image", now, &large("camera_optical_frame", now, &image));
        }
        if tick % 120 == 0 {
            let fix = vec![Field::I8(2), Field::U16(1), Field::F64s(at.fix()), Field::U8(2)];
            out.message("/fix", now, &Body::Fields(header("gps"), fix).encode(Endian::Little));
        }
    }
    out.writer.finish().expect("the drive is written");
    std::fs::rename(&unfinished, path).expect("the drive gets its name");
}
