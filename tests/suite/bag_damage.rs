//! Damaged and hostile recordings: read up to the fault, said as such, no panic.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::cast_possible_truncation)]

use std::ops::Range;

use crate::support;
use crate::support::bag;
use crate::support::damage::{behind, cut, first_chunk, patched};
use crate::support::encode::{Body, Endian, Header};
use crate::support::raw::{Layout, RawChannel, in_memory};
use crate::support::recipe::{DRIVE, MESSAGES};
use frames_lint::source::ReadStatus;
use frames_lint::world::bag::{BagEvidence, Share};

/// The drive in small chunks, with these knobs.
fn drive(knobs: &str) -> Vec<u8> {
    support::build(&format!("chunk_size_bytes: 4000\n{knobs}{DRIVE}"))
}

/// Messages in one chunk that nothing guards.
fn loose() -> Vec<u8> {
    let layout = Layout {
        compression: None,
        checksums: false,
        ..Layout::default()
    };
    in_memory(layout, |out| {
        let channel = out.channel(&RawChannel::default());
        (0..10).for_each(|tick| out.message(channel, tick, b"0123456789"));
    })
}

/// Inertial messages, a millisecond apart, in chunks of these ticks.
fn imu(layout: Layout, chunks: &[Range<i64>]) -> Vec<u8> {
    in_memory(layout, |out| {
        let schema = support::schemas::definition("sensor_msgs/msg/Imu");
        let imu = out.channel(&RawChannel {
            topic: "/imu",
            message_type: "sensor_msgs/msg/Imu",
            schema: &schema,
            ..RawChannel::default()
        });
        for ticks in chunks {
            for tick in ticks.clone() {
                let header = Header {
                    stamp_ns: tick * 1_000_000,
                    frame_id: "imu",
                };
                out.message(imu, tick * 1_000_000, &Body::Imu(header).encode(Endian::Little));
            }
            if layout.chunks {
                out.end_chunk();
            }
        }
    })
}

/// The same recording in the layouts that fail in different ways.
fn layouts() -> Vec<(&'static str, Vec<u8>)> {
    let layout = Layout {
        chunks: false,
        ..Layout::default()
    };
    let unchunked = imu(layout, std::slice::from_ref(&(0..100)));
    vec![
        ("zstd", drive("")),
        ("lz4", drive("compression: lz4")),
        ("none", drive("compression: none")),
        (
            "one chunk",
            support::build(&format!("chunk_size_bytes: 40000000{DRIVE}")),
        ),
        ("no chunks", unchunked),
    ]
}

/// Byte offset of the record that ends the data: what stands behind it is only an index.
fn data_end(bytes: &[u8]) -> usize {
    // Footer: magic 8, then summary CRC 4, offset start 8, summary start 8.
    let at = bytes.len() - 8 - 20;
    let summary = u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap()) as usize;
    summary - 13
}

#[test]
fn a_file_cut_at_any_percent_gives_what_stands_before_the_cut() {
    for (name, bytes) in layouts() {
        let (_, whole) = support::collected(&bytes);
        let whole = bag(&whole);
        let mut before = 0;
        for percent in 0..100 {
            let cut = cut(&bytes, percent);
            let (source, collected) = support::collected(cut);
            let part = bag(&collected);
            let what = format!("{name} cut at {percent} %: {source:?}");
            let expected = if part.messages > 0 {
                ReadStatus::Partial
            } else {
                ReadStatus::Unreadable
            };
            assert_eq!(source.status, expected, "{what}");
            assert_eq!(part.truncated, cut.len() <= data_end(&bytes), "{what}");
            assert_eq!(source.examined.messages, Some(part.messages), "{what}");
            assert!(part.messages >= before && part.messages <= whole.messages, "{what}");
            before = part.messages;
            if cut.len() >= 8 {
                let detail = source.detail.unwrap();
                assert!(
                    detail.starts_with("read up to byte ")
                        && detail.contains(&format!(" of {}: the file ends", cut.len())),
                    "{detail}"
                );
            }
            for edge in &part.tf {
                let known = whole.tf.iter().find(|known| known.child == edge.child).unwrap();
                assert_eq!(edge.samples[..], known.samples[..edge.samples.len()], "{what}");
            }
            for (topic, known) in part.topics.iter().map(|(name, topic)| (topic, &whole.topics[name])) {
                let samples = &topic.stamps.samples;
                assert_eq!(samples[..], known.stamps.samples[..samples.len()], "{what}");
            }
        }
        assert!(
            before * 10 >= whole.messages * 8,
            "{name}: {before} of {}",
            whole.messages
        );
    }
}

/// All evidence as text, in which a NaN equals itself. What the summary alone tells is left out.
fn without_totals(bag: &BagEvidence) -> String {
    let mut bag = bag.clone();
    bag.share = Share::WHOLE;
    bag.topics.values_mut().for_each(|topic| topic.total = None);
    format!("{bag:#?}")
}

#[test]
fn a_missing_summary_costs_no_data() {
    for (name, bytes) in layouts() {
        let end = data_end(&bytes) + 13;
        let (source, collected) = support::collected(&bytes[..end]);
        assert_eq!(source.status, ReadStatus::Partial, "{name}");
        assert!(
            source
                .detail
                .unwrap()
                .ends_with("the file ends without a footer: the recording was not closed")
        );
        assert!(!bag(&collected).truncated);
        let (_, whole) = support::collected(&bytes);
        assert!(without_totals(bag(&collected)) == without_totals(bag(&whole)), "{name}");
    }
}

#[test]
fn a_flipped_bit_is_seen_wherever_it_touches_the_evidence() {
    for (name, bytes) in layouts() {
        let (_, whole) = support::collected(&bytes);
        let mut seen = 0;
        for place in 0..100 {
            let mut broken = bytes.clone();
            let at = (bytes.len() - 1) * place / 99;
            broken[at] ^= 1 << (place % 8);
            let (source, collected) = support::collected(&broken);
            seen += u32::from(source.status != ReadStatus::Read);
            // Without chunks there is no checksum to see it by.
            let same = without_totals(bag(&collected)) == without_totals(bag(&whole)) || name == "no chunks";
            assert!(
                same || source.status != ReadStatus::Read,
                "{name}, byte {at}: {source:?}"
            );
        }
        assert!(seen > 5, "{name}: {seen} of 100 were seen");
    }
}

#[test]
fn lying_sizes_are_refused() {
    for (name, bytes) in layouts().into_iter().filter(|(name, _)| *name != "no chunks") {
        let chunk = first_chunk(&bytes);
        let name_len = u32::from_le_bytes(bytes[chunk + 37..chunk + 41].try_into().unwrap()) as usize;
        let (length, uncompressed, compressed) = (chunk + 1, chunk + 25, chunk + 41 + name_len);
        for lie in [0, 1, 7, 1 << 20, 1 << 29, 1 << 31, 1 << 62, u64::MAX] {
            for (what, at) in [
                ("length", length),
                ("uncompressed", uncompressed),
                ("compressed", compressed),
            ] {
                // The size before compression is nobody's claim in a chunk that is not compressed.
                if name == "none" && what == "uncompressed" && lie <= 1 << 30 {
                    continue;
                }
                let (source, collected) = support::collected(&patched(&bytes, at, &u64::to_le_bytes(lie)));
                assert_ne!(source.status, ReadStatus::Read, "{name}: {what} = {lie}: {source:?}");
                let detail = source.detail.unwrap();
                let is_whole = detail.ends_with("no message is missing");
                assert_eq!(bag(&collected).truncated, !is_whole, "{name}: {what} = {lie}: {detail}");
                let is_said = detail.starts_with("read up to byte") || detail.contains(" damaged, ");
                assert!(is_said, "{name}: {what} = {lie}: {detail}");
            }
        }
    }
    let bytes = drive("");
    let at = first_chunk(&bytes) + 25;
    let (source, _) = support::collected(&patched(&bytes, at, &u64::to_le_bytes(1 << 62)));
    let detail = source.detail.unwrap();
    assert!(
        detail.contains("a chunk claims 4611686018427387904 bytes of messages, above the limit of 1073741824"),
        "{detail}"
    );
}

#[test]
fn a_record_that_claims_more_than_its_chunk_is_refused() {
    let bytes = drive("compression: none");
    let header = first_chunk(&bytes) + 9 + 40;
    for lie in [1 << 20, 1 << 40, u64::MAX] {
        let (source, _) = support::collected(&patched(&bytes, header + 1, &u64::to_le_bytes(lie)));
        assert_eq!(source.status, ReadStatus::Partial, "{lie}: {source:?}");
    }
    // Without a checksum to fail first.
    let bytes = loose();
    let record = first_chunk(&bytes) + 9 + 40;
    for lie in [30, 1 << 20, 1 << 40, u64::MAX] {
        let (source, _) = support::collected(&patched(&bytes, record + 1, &u64::to_le_bytes(lie)));
        assert_ne!(source.status, ReadStatus::Read, "{lie}: {source:?}");
    }
}

#[test]
fn what_is_no_mcap_is_told_apart() {
    let cases: [(&[u8], &str); 10] = [
        (b"", "the file is empty"),
        (&[0; 4096], "not an MCAP: the magic bytes at byte 0 are missing"),
        (
            b"<robot name='x'/>",
            "not an MCAP: the magic bytes at byte 0 are missing",
        ),
        (b"BZh91AY", "not an MCAP: this is a file compressed with bzip2"),
        (b"SQLite format 3\0 etc", "file is not a database"),
        (&[0x1f, 0x8b, 8, 0], "not an MCAP: this is a file compressed with gzip"),
        (
            &[0x28, 0xb5, 0x2f, 0xfd, 0],
            "the compressed file is cut off or damaged after 0 unpacked bytes: incomplete frame",
        ),
        (b"PK\x03\x04zip", "not an MCAP: this is a ZIP archive"),
        (
            b"version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 12\n",
            "not an MCAP: this is a Git LFS pointer; the recording itself was not downloaded",
        ),
        (b"\x89MCA", "not an MCAP: the magic bytes at byte 0 are missing"),
    ];
    for (bytes, expected) in cases {
        let (source, collected) = support::collected(bytes);
        assert_eq!(
            (source.status, source.detail.as_deref()),
            (ReadStatus::Unreadable, Some(expected))
        );
        assert!(bag(&collected).truncated && bag(&collected).topics.is_empty());
    }
    let folder = tempfile::tempdir().unwrap();
    let (source, _) = support::collected_from(folder.path());
    assert_eq!(source.detail.as_deref(), Some("the folder contains no recording"));
    let (source, _) = support::collected_from(&folder.path().join("absent.mcap"));
    assert!(source.detail.unwrap().starts_with("cannot be opened: "));
}

#[test]
fn zeros_and_rubbish_behind_the_magic_end_the_reading_at_once() {
    let bytes = drive("");
    let chunk = first_chunk(&bytes);
    for filler in [0, 0xff] {
        let mut broken = bytes[..chunk].to_vec();
        broken.resize(1 << 20, filler);
        let (source, _) = support::collected(&broken);
        assert_eq!(
            (source.status, source.examined.bytes),
            (ReadStatus::Unreadable, chunk as u64),
            "{source:?}"
        );
    }
    // In a chunk that the end of the file cuts as well.
    let mut broken = loose();
    let messages: Vec<usize> = memchr::memmem::find_iter(&broken, b"0123456789").collect();
    broken[messages[3] + 10..messages[7]].fill(0);
    broken.truncate(messages[9]);
    let (source, collected) = support::collected(&broken);
    assert_eq!(
        (source.status, bag(&collected).messages),
        (ReadStatus::Partial, 4),
        "{source:?}"
    );
    assert!(
        source
            .detail
            .as_ref()
            .unwrap()
            .ends_with(": a record has the invalid opcode 0: probably zeros in place of data that was never written"),
        "{source:?}"
    );
    let mut longer = bytes.clone();
    longer.extend(&bytes);
    let (source, collected) = support::collected(&longer);
    assert_eq!(
        (source.status, bag(&collected).messages),
        (ReadStatus::Partial, MESSAGES)
    );
    assert!(
        source
            .detail
            .unwrap()
            .ends_with(&format!("{} bytes follow the end of the recording", bytes.len()))
    );
}

#[test]
fn an_empty_recording_says_so_and_is_no_input_that_was_read() {
    let (source, collected) = support::collected(&in_memory(Layout::default(), |_| {}));
    assert_eq!(
        (source.status, source.detail.as_deref()),
        (ReadStatus::Partial, Some("no messages"))
    );
    assert_eq!((bag(&collected).truncated, bag(&collected).start_ns), (false, None));
}

#[test]
fn a_chunk_that_claims_less_than_it_holds_costs_one_file_only() {
    let bytes = loose();
    let at = first_chunk(&bytes) + 41;
    let (source, _) = support::collected(&patched(&bytes, at, &u64::to_le_bytes(7)));
    assert_ne!(source.status, ReadStatus::Read);
    let detail = source.detail.unwrap();
    assert!(detail.contains("its header says 444"), "{detail}");
}

#[test]
fn a_message_that_was_logged_outside_of_its_chunk_costs_a_chunk_that_nothing_guards() {
    let bytes = loose();
    let messages: Vec<usize> = memchr::memmem::find_iter(&bytes, b"0123456789").collect();
    // In front of the data: log time and publish time, 8 bytes each.
    let log_time = messages[4] - 16;
    let (source, _) = support::collected(&patched(&bytes, log_time, &u64::to_le_bytes(1 << 60)));
    assert_eq!(source.status, ReadStatus::Unreadable, "{source:?}");
    let detail = source.detail.unwrap();
    assert!(
        detail.contains(
            "1 of the 10 messages of a chunk without a checksum have a log time outside of the range in its header"
        ),
        "{detail}"
    );
    // A head that is wrong of most of its messages is not believed.
    let head = first_chunk(&bytes) + 9;
    let (source, _) = support::collected(&patched(&bytes, head, &u64::to_le_bytes(8)));
    assert_eq!(source.examined.messages, Some(10), "{source:?}");
}

#[test]
fn chunks_are_read_in_the_order_of_their_log_times() {
    let evidence = |chunks: &[Range<i64>]| {
        let (source, collected) = support::collected(&imu(Layout::default(), chunks));
        assert_eq!(
            (source.status, source.examined.messages),
            (ReadStatus::Read, Some(90)),
            "{source:?}"
        );
        bag(&collected).clone()
    };
    let in_order = evidence(&[0..30, 30..60, 60..90]);
    assert_eq!(
        format!("{in_order:?}"),
        format!("{:?}", evidence(&[30..60, 60..90, 0..30]))
    );
}

#[test]
fn messages_lost_without_a_trace_are_missed() {
    let bytes = drive("");
    let first = first_chunk(&bytes);
    let second = behind(&bytes, first);
    let second = second
        + bytes[second..data_end(&bytes)]
            .iter()
            .position(|byte| *byte == 6)
            .unwrap();
    // A chunk becomes a record of a kind nobody knows, and is stepped over. The first one holds the channels: without
    // it no later message can be placed.
    for (chunk, lost) in [
        (first, "messages belong to channels that the file does not define"),
        (second, "the file's statistics say 901"),
    ] {
        let mut broken = bytes.clone();
        assert_eq!(broken[chunk], 6);
        broken[chunk] = 0x86;
        let (source, collected) = support::collected(&broken);
        assert!(bag(&collected).messages < MESSAGES && bag(&collected).truncated);
        let is_reported = source.problems.iter().any(|problem| problem.message.contains(lost));
        assert!(source.status == ReadStatus::Partial && is_reported, "{source:?}");
    }
}
