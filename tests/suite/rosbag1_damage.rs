//! Damaged and lying ROS 1 bags: what stands before and behind the fault is read, the fault is told with its place, and
//! nothing a file claims is believed.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::cast_possible_truncation)]

use crate::support;
use crate::support::damage::{cut, patched};
use crate::support::heard::{are_some_of, read};
use crate::support::rosbag1::{BagFile, Compression, Ending, Layout, Rosbag1};
use crate::support::rosbag1_drive::{drive, layouts};
use frames_lint::source::{ReadStatus, Source};

/// Bag header: magic 13, length 4, then fields of 4 + name + `=` + value each, `op` first.
const INDEX_POS: usize = 13 + 4 + 8 + 14;
const CONN_COUNT: usize = INDEX_POS + 8 + 15;
const CHUNK_COUNT: usize = CONN_COUNT + 4 + 16;

/// Byte behind the next place of some text.
fn behind(bytes: &[u8], from: usize, text: &[u8]) -> usize {
    let found = bytes[from..].windows(text.len()).position(|window| window == text);
    from + found.unwrap() + text.len()
}

fn u32_at(bytes: &[u8], at: usize) -> usize {
    u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize
}

/// Byte of the length of a chunk's data, and that length.
fn data_of(bytes: &[u8], chunk: usize) -> (usize, usize) {
    let at = chunk + 4 + u32_at(bytes, chunk);
    (at, u32_at(bytes, at))
}

fn is_reported(source: &Source, text: &str) -> bool {
    source.problems.iter().any(|problem| problem.message.contains(text))
}

/// Messages of the largest chunk.
fn largest_chunk(layout: Layout) -> usize {
    if layout.chunk_bytes > 4000 { 300 } else { 45 }
}

#[test]
fn a_bag_cut_at_any_percent_gives_what_stands_before_the_cut() {
    for layout in layouts() {
        for ending in [Ending::Closed, Ending::Unindexed] {
            let (BagFile { bytes, index, .. }, written) = drive(Layout { ending, ..layout });
            let mut before = 0;
            for percent in 1..100 {
                let part = cut(&bytes, percent);
                let (source, extent, heard) = read(part);
                let cut = part.len();
                let what = format!("{layout:?} {ending:?} cut at {percent} %, byte {cut} of {index}: {source:?}");
                let expected = if heard.messages.is_empty() {
                    ReadStatus::Unreadable
                } else {
                    ReadStatus::Partial
                };
                assert_eq!(source.status, expected, "{what}");
                assert!(written.starts_with(&heard.messages), "{what}");
                assert!(heard.messages.len() >= before, "{what}");
                assert_eq!(extent.truncated, cut < index || ending == Ending::Unindexed, "{what}");
                assert!(is_reported(&source, "the bag was scanned from its start"), "{what}");
                before = heard.messages.len();
            }
            assert!(
                before * 10 >= 300 * 8 || layout.compression == Compression::Bz2,
                "{layout:?}: {before}"
            );
        }
    }
}

#[test]
fn a_cut_is_told_with_its_byte() {
    let (BagFile { bytes, chunks, .. }, written) = drive(Layout::default());
    let cut = chunks[2] + 700;
    let (source, extent, heard) = read(&bytes[..cut]);
    let detail = source.detail.clone().unwrap();
    assert!(
        detail.starts_with(&format!(
            "read up to byte {cut} of {cut}: the file ends inside a chunk of"
        )),
        "{detail}"
    );
    assert!(
        is_reported(&source, "past the end of the file; the bag was scanned from its start"),
        "{source:?}"
    );
    assert!(extent.truncated && heard.messages.len() > 60 && written.starts_with(&heard.messages));
}

#[test]
fn a_flipped_bit_costs_one_chunk_at_most_and_is_told() {
    for layout in layouts() {
        let (BagFile { bytes, .. }, written) = drive(layout);
        let mut seen = 0;
        for place in 0..120 {
            let at = 13 + (bytes.len() - 14) * place / 119;
            let mut broken = bytes.clone();
            broken[at] ^= 1 << (place % 8);
            let (source, extent, heard) = read(&broken);
            let what = format!("{layout:?}, byte {at} of {}: {source:?}", bytes.len());
            let is_same = heard.messages == written;
            seen += u32::from(source.status != ReadStatus::Read);
            assert!(heard.messages.len() + largest_chunk(layout) >= 300, "{what}");
            if layout.compression == Compression::None {
                // Without compression there is no checksum to see it by.
                assert!(
                    heard.messages.len() == 300 || source.status != ReadStatus::Read,
                    "{what}"
                );
            } else {
                assert!(is_same || source.status != ReadStatus::Read, "{what}");
                assert!(are_some_of(&heard.messages, &written), "{what}");
            }
            assert!(heard.messages.len() == 300 || extent.truncated, "{what}");
        }
        assert!(seen > 5, "{layout:?}: {seen}");
    }
}

#[test]
fn a_flipped_bit_without_an_index_to_hold_it_against() {
    for layout in layouts() {
        let (BagFile { bytes, .. }, written) = drive(Layout {
            ending: Ending::Unindexed,
            ..layout
        });
        for place in 0..100 {
            let at = 13 + (bytes.len() - 14) * place / 99;
            let mut broken = bytes.clone();
            broken[at] ^= 1 << (place % 8);
            let (source, extent, heard) = read(&broken);
            let what = format!("{layout:?}, byte {at} of {}: {source:?}", bytes.len());
            assert!(extent.truncated && source.status != ReadStatus::Read, "{what}");
            assert!(
                layout.compression == Compression::None || are_some_of(&heard.messages, &written),
                "{what}"
            );
        }
    }
}

#[test]
fn reading_goes_on_behind_a_damaged_chunk() {
    for compression in [Compression::Bz2, Compression::Lz4] {
        for ending in [Ending::Closed, Ending::Unindexed] {
            let layout = Layout {
                compression,
                ending,
                ..Layout::default()
            };
            let (BagFile { bytes, chunks, .. }, written) = drive(layout);
            let (at, len) = data_of(&bytes, chunks[2]);
            let mut broken = bytes.clone();
            for byte in &mut broken[at + 4 + len / 2..at + 4 + len / 2 + 20] {
                *byte ^= 0x55;
            }
            let (source, extent, heard) = read(&broken);
            let what = format!("{layout:?} {source:?}");
            let lost = 300 - heard.messages.len();
            assert!(lost > 20 && lost <= 45 && heard.seams == 1, "{what}");
            assert!(are_some_of(&heard.messages, &written) && extent.truncated, "{what}");
            let expected = format!("bytes {} to {} ", chunks[2], at + 4 + len);
            let detail = source.detail.clone().unwrap();
            assert!(detail.starts_with(&expected), "{what}");
            assert!(detail.contains("were skipped: a chunk is damaged: "), "{what}");
        }
    }
}

#[test]
fn blocks_that_were_never_written_are_stepped_over_with_an_index() {
    for layout in layouts().into_iter().filter(|layout| layout.chunk_bytes == 4000) {
        let (BagFile { bytes, chunks, .. }, _) = drive(layout);
        let mut holed = bytes.clone();
        holed[chunks[2]..chunks[2] + 200].fill(0);
        let (source, extent, heard) = read(&holed);
        assert!(heard.messages.len() >= 255 && heard.seams == 1, "{source:?}");
        let expected = format!("bytes {} to {} ", chunks[2], chunks[3]);
        assert!(source.detail.clone().unwrap().starts_with(&expected), "{source:?}");
        assert!(extent.truncated && source.status == ReadStatus::Partial);
        // Without the index nobody knows where the next record is.
        holed[INDEX_POS..INDEX_POS + 8].fill(0);
        let (source, _, heard) = read(&holed);
        assert!(heard.messages.len() < 150, "{source:?}");
        let expected = format!("read up to byte {} ", chunks[2]);
        assert!(source.detail.unwrap().starts_with(&expected));
    }
}

#[test]
fn an_index_that_lies_costs_no_message() {
    for layout in layouts() {
        let (BagFile { bytes, chunks, index }, written) = drive(layout);
        let len = bytes.len() as u64;
        let mut lies: Vec<(String, Vec<u8>)> = Vec::new();
        let places = [
            1,
            12,
            13,
            4117,
            chunks[0] as u64 + 9,
            index as u64 - 1,
            index as u64 + 1,
        ];
        for place in places
            .into_iter()
            .chain([len - 1, len, len + 1, 1 << 31, 1 << 62, u64::MAX])
        {
            lies.push((
                format!("index at {place}"),
                patched(&bytes, INDEX_POS, &place.to_le_bytes()),
            ));
        }
        for count in [0_u32, 1, 99, 1 << 31, u32::MAX] {
            lies.push((
                format!("{count} connections"),
                patched(&bytes, CONN_COUNT, &count.to_le_bytes()),
            ));
            if chunks.len() != count as usize {
                lies.push((
                    format!("{count} chunks"),
                    patched(&bytes, CHUNK_COUNT, &count.to_le_bytes()),
                ));
            }
            // There are connections 0 to 2.
            let other = count.wrapping_add(2) | 3;
            let info = behind(&bytes, index, b"chunk_pos=");
            lies.push((
                format!("{count} counts in a chunk info"),
                patched(&bytes, behind(&bytes, info, b"\x0a\0\0\0count="), &count.to_le_bytes()),
            ));
            let data = behind(&bytes, info, b"\x0a\0\0\0count=") + 4;
            lies.push((
                format!("{count} bytes in a chunk info"),
                patched(&bytes, data, &count.to_le_bytes()),
            ));
            lies.push((
                format!("{count} messages in a chunk"),
                patched(&bytes, data + 8, &count.to_le_bytes()),
            ));
            lies.push((
                format!("connection {other} in a chunk"),
                patched(&bytes, data + 4, &other.to_le_bytes()),
            ));
        }
        for place in [0, 1, 4117 + 1, chunks[0] as u64 + 9, len, 1 << 31, u64::MAX] {
            let info = behind(&bytes, index, b"chunk_pos=");
            lies.push((
                format!("a chunk at {place}"),
                patched(&bytes, info, &place.to_le_bytes()),
            ));
        }
        for (what, lying) in lies {
            let (source, _, heard) = read(&lying);
            assert!(heard.messages == written, "{layout:?} {what}: {source:?}");
            assert_eq!(source.status, ReadStatus::Partial, "{layout:?} {what}: {source:?}");
        }
    }
}

#[test]
fn times_are_held_against_the_index() {
    let (BagFile { bytes, index, .. }, _) = drive(Layout::default());
    let end = behind(&bytes, index, b"end_time=");
    let (source, _, heard) = read(&patched(&bytes, end, &0_u64.to_le_bytes()));
    assert_eq!((source.status, heard.messages.len()), (ReadStatus::Partial, 300));
    assert!(
        is_reported(
            &source,
            "messages have a log time outside of the range that the index gives for their chunk"
        ),
        "{source:?}"
    );
}

#[test]
fn a_chunk_that_lies_about_its_size_costs_that_chunk_at_most() {
    for layout in layouts() {
        let (BagFile { bytes, chunks, .. }, written) = drive(layout);
        let chunk = chunks[chunks.len() / 2];
        let size = behind(&bytes, chunk, b"size=");
        let (len, true_len) = data_of(&bytes, chunk);
        for lie in [
            0,
            1,
            7,
            true_len as u32 - 1,
            1 << 20,
            1 << 30,
            (1 << 30) + 1,
            1 << 31,
            u32::MAX,
        ] {
            for (what, at) in [("size", size), ("length", len)] {
                let (source, extent, heard) = read(&patched(&bytes, at, &lie.to_le_bytes()));
                let what = format!("{layout:?} {what} = {lie}: {source:?}");
                assert_ne!(source.status, ReadStatus::Read, "{what}");
                assert!(are_some_of(&heard.messages, &written), "{what}");
                assert!(heard.messages.len() + largest_chunk(layout) >= 300, "{what}");
                assert!(heard.messages.len() == 300 || extent.truncated, "{what}");
                if at == size && lie > 1 << 30 {
                    let limit = format!("a chunk claims {lie} bytes of messages, above the limit of 1073741824");
                    assert!(is_reported(&source, &limit), "{what}");
                }
            }
        }
    }
}

#[test]
fn a_record_that_claims_more_than_its_chunk_is_refused() {
    let (BagFile { bytes, chunks, .. }, written) = drive(Layout::default());
    let (at, _) = data_of(&bytes, chunks[1]);
    // The first record of the second chunk is a message: op, conn, time.
    let header = at + 4;
    let data = header + 4 + u32_at(&bytes, header);
    for (place, lie) in [
        (header, 0_u32),
        (header, 1 << 20),
        (header, u32::MAX),
        (data, 1 << 27),
        (data, u32::MAX),
    ] {
        let (source, extent, heard) = read(&patched(&bytes, place, &lie.to_le_bytes()));
        assert!(
            are_some_of(&heard.messages, &written) && heard.messages.len() >= 255,
            "{source:?}"
        );
        assert!(
            extent.truncated && source.status == ReadStatus::Partial && heard.seams == 1,
            "{source:?}"
        );
    }
}

#[test]
fn messages_of_an_unknown_connection_are_missed() {
    let mut bag = Rosbag1::new(Layout::default());
    let known = bag.connection(&support::rosbag1::Connection::default());
    bag.message(known, 1_000, b"known");
    bag.message(7, 2_000, b"unknown");
    let (source, extent, heard) = read(&bag.finish().bytes);
    assert_eq!((heard.messages.len(), extent.truncated), (1, true));
    assert!(
        is_reported(
            &source,
            "1 messages belong to connections that the file does not define"
        ),
        "{source:?}"
    );
}

#[test]
fn records_of_no_known_kind_are_told() {
    let strange = support::rosbag1::record(&[("op", &[0x42])], b"strange");
    for ending in [Ending::Closed, Ending::Unindexed] {
        let mut bag = Rosbag1::new(Layout {
            ending,
            ..Layout::default()
        });
        let known = bag.connection(&support::rosbag1::Connection::default());
        bag.message(known, 1_000, b"before");
        bag.raw(&strange);
        bag.message(known, 2_000, b"behind");
        bag.close_chunk();
        bag.message(known, 3_000, b"later");
        let (source, _, heard) = read(&bag.finish().bytes);
        assert_eq!(heard.messages.len(), 2, "{source:?}");
        assert!(
            is_reported(&source, "a record of kind 0x42 among messages"),
            "{source:?}"
        );
    }
}

#[test]
fn rubbish_behind_the_magic_ends_the_reading_at_once() {
    for filler in [0_u8, 0xff, b' '] {
        let mut bytes = b"#ROSBAG V2.0\n".to_vec();
        bytes.resize(1 << 20, filler);
        let (source, extent, heard) = read(&bytes);
        assert_eq!(
            (source.status, source.examined.bytes),
            (ReadStatus::Unreadable, 13),
            "{source:?}"
        );
        assert!(extent.truncated && heard.messages.is_empty());
    }
}
