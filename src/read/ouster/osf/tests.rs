//! Tests of OSF files: against what ouster-sdk 1.0 made of `fixtures/ouster` (written by `verify/fixtures.py`), images of
//! our own making, and damaged files, also with CRCs that fit the damage.

use std::io::Cursor;

use super::flat::Table;
use super::image::Image;
use super::{LidarScan, Osf, OsfError};
use crate::read::ouster::tests::{assert_like_sdk, fixture, random, tiny};
use crate::read::ouster::{Axes, Metadata};

const FILES: [&str; 2] = ["tiny-png.osf", "tiny-zpng.osf"];

fn open(bytes: &[u8]) -> Result<Osf<Cursor<&[u8]>>, OsfError> {
    Osf::new(Cursor::new(bytes))
}

/// All lidar scans that can be read, and how many chunks and messages cannot.
fn scans(bytes: &[u8], metadata: &Metadata) -> Result<(Vec<LidarScan>, usize), OsfError> {
    let mut file = open(bytes)?;
    let (mut scans, mut refused) = (Vec::new(), 0);
    for chunk in file.index.chunks.clone() {
        let Ok(chunk) = file.read(&chunk) else {
            refused += 1;
            continue;
        };
        for message in chunk.messages() {
            let Ok(message) = message else {
                refused += 1;
                continue;
            };
            if file.sensor(message.stream).is_some() {
                match LidarScan::read(&message, metadata, None) {
                    Ok(scan) => scans.push(scan),
                    Err(_) => refused += 1,
                }
            }
        }
    }
    Ok((scans, refused))
}

#[test]
fn scans_as_ouster_sdk_decodes_them() {
    for name in FILES {
        let bytes = fixture(name);
        let file = open(&bytes).unwrap();
        assert_eq!(
            (
                file.version,
                file.index.start_ns % 1000,
                file.index.end_ns - file.index.start_ns
            ),
            ((2, 2), 7, 100_000_000)
        );
        assert_eq!(file.index.sensors.len(), 1);
        assert_eq!(Metadata::parse(&file.index.sensors[0].json).unwrap(), tiny());
        let stream = file.index.streams.iter().find(|s| s.sensor.is_some()).unwrap();
        assert_eq!(stream.kind, "ouster/v1/os_sensor/LidarScanStream");
        let indexed: Vec<_> = file
            .index
            .chunks
            .iter()
            .filter(|c| c.messages.is_some_and(|m| m.0 == stream.id))
            .collect();
        assert_eq!((indexed.len(), indexed[0].messages.unwrap().1), (2, 1));
        let (scans, refused) = scans(&bytes, &tiny()).unwrap();
        assert_eq!((scans.len(), refused), (2, 0));
        for (scan, turn) in scans.iter().zip(0_i64..) {
            let clouds = [Axes::Sensor, Axes::Lidar].map(|axes| scan.scan(&tiny(), axes));
            assert_like_sdk([&clouds[0], &clouds[1]]);
            assert_eq!(scan.size, (16, 4));
            assert_eq!(
                clouds[0].received_ns,
                Some(1_000_000_000_000_000_007 + turn * 100_000_000)
            );
            assert_eq!(scan.status[5], 0);
            assert_eq!(
                scan.imu.iter().map(|m| m.timestamp_ns % 10).collect::<Vec<_>>(),
                [0, 1, 3]
            );
            assert!(scan.field("NEAR_IR").is_some() && scan.field("RAW").is_none());
        }
    }
}

#[test]
fn wanted_fields_alone_are_decoded() {
    let bytes = fixture(FILES[1]);
    let mut file = open(&bytes).unwrap();
    let stream = file.index.streams.iter().find(|s| s.sensor.is_some()).unwrap().id;
    let indexed = *file
        .index
        .chunks
        .iter()
        .find(|c| c.messages.is_some_and(|m| m.0 == stream))
        .unwrap();
    let chunk = file.read(&indexed).unwrap();
    let message = chunk.messages().next().unwrap().unwrap();
    let scan = LidarScan::read(&message, &tiny(), Some(&["RANGE"])).unwrap();
    assert!(scan.field("RANGE").is_some() && scan.field("RANGE2").is_none());
    assert_eq!(scan.scan(&tiny(), Axes::Lidar).returns.len(), 59);
    let mut other = tiny();
    other.pixels_per_column = 5;
    let text = LidarScan::read(&message, &other, None).unwrap_err().to_string();
    assert_eq!(text, "an image of RANGE with 16 x 4 pixels; the sensor has 16 x 5");
    other.columns_per_frame = 17;
    let text = LidarScan::read(&message, &other, None).unwrap_err().to_string();
    assert_eq!(text, "a scan with 16 entries of timestamps; the sensor has 17 columns");
}

/// ZPNG of pixels with `width` bytes, by its description in `zpng.h`.
fn zpng(columns: u16, values: &[u64], width: u8) -> Vec<u8> {
    let rows = u16::try_from(values.len()).unwrap() / columns;
    let steps = values.chunks_exact(columns.into()).flat_map(|row| {
        let left = std::iter::once(&0).chain(row);
        row.iter().zip(left).map(|(value, left)| {
            let (value, left) = (value.to_le_bytes(), left.to_le_bytes());
            std::array::from_fn::<u8, 8, _>(|i| value[i].wrapping_sub(left[i]))
        })
    });
    let steps: Vec<_> = steps.collect();
    let planes = |s: &[u8; 8]| [s[2], s[1].wrapping_sub(s[2]), s[1].wrapping_sub(s[0]), s[3]];
    let packed: Vec<u8> = if width == 3 || width == 4 {
        (0..usize::from(width))
            .flat_map(|plane| steps.iter().map(move |s| planes(s)[plane]))
            .collect()
    } else {
        steps.iter().flat_map(|s| s[..width.into()].to_vec()).collect()
    };
    let mut bytes = vec![0xF8, 0xFB];
    bytes.extend([columns.to_le_bytes(), rows.to_le_bytes(), [width, 1]].as_flattened());
    bytes.extend(zstd::bulk::compress(&packed, 1).unwrap());
    bytes
}

fn png(values: &[u64], width: usize, color: png::ColorType, depth: png::BitDepth) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 5, 3);
    encoder.set_color(color);
    encoder.set_depth(depth);
    let wide = depth == png::BitDepth::Sixteen;
    let data: Vec<u8> = values
        .iter()
        .flat_map(|v| {
            let mut bytes = v.to_le_bytes();
            bytes.as_chunks_mut::<2>().0.iter_mut().for_each(|pair| {
                if wide {
                    pair.reverse();
                }
            });
            bytes[..width].to_vec()
        })
        .collect();
    encoder.write_header().unwrap().write_image_data(&data).unwrap();
    bytes
}

#[test]
fn images_of_all_widths() {
    use png::{BitDepth::Eight, BitDepth::Sixteen, ColorType::Grayscale, ColorType::Rgb, ColorType::Rgba};
    let mut state = 3;
    let same = |values: &[u64]| values.iter().map(|v| u32::try_from(*v).unwrap()).collect::<Vec<_>>();
    let image = Image {
        field: "RANGE",
        size: (5, 3),
    };
    let mut values = |width: u8| -> Vec<u64> {
        let mask = u64::from(u32::MAX) >> (32 - 8 * u32::from(width.min(4)));
        (0..15)
            .map(|_| u64::from_le_bytes(std::array::from_fn(|_| random(&mut state))) & mask)
            .collect()
    };
    for width in 1..=8 {
        let values = values(width);
        assert_eq!(
            image.decode(&zpng(5, &values, width)).unwrap(),
            (same(&values), false),
            "{width}"
        );
    }
    for (width, color, depth) in [
        (1, Grayscale, Eight),
        (2, Grayscale, Sixteen),
        (3, Rgb, Eight),
        (4, Rgba, Eight),
        (8, Rgba, Sixteen),
    ] {
        let values = values(width);
        let bytes = png(&values, width.into(), color, depth);
        assert_eq!(image.decode(&bytes).unwrap(), (same(&values), true), "{width}");
        (0..bytes.len() - 20).for_each(|end| assert!(image.decode(&bytes[..end]).is_err()));
    }
    let text = |bytes: &[u8]| image.decode(bytes).unwrap_err().to_string();
    let wide = text(&zpng(15, &values(1), 1));
    assert_eq!(wide, "an image of RANGE with 15 x 1 pixels; the sensor has 5 x 3");
    let alpha = png(&values(2), 2, png::ColorType::GrayscaleAlpha, Eight);
    assert_eq!(
        text(&alpha),
        "an image of RANGE that cannot be decoded: GrayscaleAlpha with Eight bits a sample"
    );
    let large = zpng(5, &[1 << 32; 15], 8);
    assert_eq!(
        text(&large),
        "an image of RANGE that cannot be decoded: a value of 4294967296"
    );
    let mut bomb = zpng(5, &values(8), 8);
    bomb.truncate(8);
    bomb.extend(zstd::bulk::compress(&vec![0; 1 << 20], 1).unwrap());
    assert!(text(&bomb).starts_with("an image of RANGE that cannot be decoded: "));
    bomb[6] = 9;
    assert_eq!(
        text(&bomb),
        "an image of RANGE that cannot be decoded: pixels of 9 bytes"
    );
}

/// Makes the CRC of the block that has this byte fit its content again.
fn mend(bytes: &mut [u8], blocks: &[(usize, usize)], at: usize) {
    let (start, end) = *blocks.iter().find(|(start, end)| (*start..*end).contains(&at)).unwrap();
    let crc = crc32fast::hash(&bytes[start..end - 4]);
    bytes[end - 4..end].copy_from_slice(&crc.to_le_bytes());
}

#[test]
fn damaged_files_are_refused_or_read_but_end() {
    let metadata = tiny();
    for name in FILES {
        let bytes = fixture(name);
        let (mut blocks, mut at) = (Vec::new(), 0);
        while at < bytes.len() {
            let size = u32::from_le_bytes(*bytes[at..].first_chunk().unwrap()) as usize + 8;
            blocks.push((at, at + size));
            at += size;
        }
        let (base, index) = (blocks[1].0, blocks.last().unwrap().0);
        // Without the index, the chunks that are whole are found; the first one has the sensors.
        for end in 0..bytes.len() {
            let whole = blocks[1..4].iter().filter(|block| block.1 <= end).count();
            match open(&bytes[..end]) {
                Ok(file) => assert!(whole == file.index.chunks.len() && file.rebuilt.is_some()),
                Err(_) => assert!(whole == 0),
            }
        }
        let mut rebuilt = open(&bytes[..index]).unwrap().index;
        let stated = open(&bytes).unwrap().index;
        rebuilt.streams.sort_by_key(|stream| stream.id);
        assert!(stated.streams.iter().all(|stream| rebuilt.streams.contains(stream)));
        rebuilt.streams.clone_from(&stated.streams);
        assert_eq!(rebuilt, stated);
        let mut state = 2;
        for at in (0..bytes.len()).step_by(5) {
            let mut damaged = bytes.clone();
            damaged[at] ^= random(&mut state) | 1;
            match scans(&damaged, &metadata) {
                Ok((scans, refused)) => assert!(at >= base && scans.len() <= 2 && refused <= 1, "{at}"),
                Err(error) => assert!(at < base && !error.to_string().is_empty(), "{at}"),
            }
            mend(&mut damaged, &blocks, at);
            let (scans, _) = scans(&damaged, &metadata).unwrap_or_default();
            assert!(
                scans
                    .iter()
                    .all(|scan| scan.scan(&metadata, Axes::Sensor).returns.len() <= 128)
            );
        }
        let mut last = bytes.clone();
        let size = last.len();
        last[index - 1] ^= 1;
        assert_eq!(scans(&last, &metadata).unwrap().1, 1);
        last[size - 1] ^= 1;
        let file = open(&last).unwrap();
        let text = file.rebuilt.unwrap().to_string();
        assert!(
            text.starts_with(&format!("a damaged block at byte {index}: its CRC is 0x")),
            "{text}"
        );
        assert_eq!(file.index.chunks.len(), 2);
    }
}

#[test]
fn other_files_are_refused() {
    let refusal = |bytes: &[u8]| open(bytes).unwrap_err().to_string();
    assert_eq!(refusal(b""), "a block of 8 bytes at byte 0, where 0 can be");
    assert_eq!(
        refusal(b"\xd4\xc3\xb2\xa1\x02\0\x04\0"),
        "no OSF file: its first block is not a header"
    );
    let with = |at: usize, value: [u8; 8]| {
        let mut bytes = fixture(FILES[0]);
        bytes[at..at + 8].copy_from_slice(&value);
        mend(&mut bytes, &[(0, 60)], at);
        bytes
    };
    let version = 32; // Its place in the header; the status is right before it.
    assert_eq!(
        refusal(&with(version, 14_u64.to_le_bytes())),
        "an OSF file of version 1; 2 is known"
    );
    assert_eq!(
        refusal(&with(version, (3_u64 << 48).to_le_bytes())),
        "an OSF file of version 3; 2 is known"
    );
    assert_eq!(open(&with(version, 20_u64.to_le_bytes())).unwrap().version, (2, 0));
    let unfinished = with(version - 8, [12, 0, 0, 0, 0, 0, 0, 1]);
    let reason = open(&unfinished).unwrap().rebuilt.unwrap().to_string();
    assert_eq!(reason, "an OSF file that was not finished; its index is missing");
    assert_eq!(refusal(&unfinished[..60]), reason);
}

#[test]
fn random_bytes_are_no_flatbuffer_that_misleads() {
    let mut state = 9;
    for _ in 0..20_000 {
        let mut bytes: Vec<u8> = (0..96).map(|_| random(&mut state) & 0x1F).collect();
        bytes[..4].copy_from_slice(&[92, 0, 0, 0]);
        bytes[5..8].fill(0);
        if let Some(table) = Table::root(&bytes, None) {
            assert!((0..16).all(|slot| table.vector(slot, 1).is_none_or(|v| v.len() < 96)));
            assert!((0..16).all(|slot| table.tables(slot).flatten().count() < 96));
            let _ = (
                table.u64(0),
                table.u32(1),
                table.u8(2),
                table.text(3),
                table.numbers(4, f64::from_le_bytes),
            );
        }
    }
}
