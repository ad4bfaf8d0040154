//! Damaged captures, and parts of large ones: what is lost is said with its place, what is read is what was captured.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::cast_possible_truncation)]

use std::collections::BTreeSet;
use std::fs;

use frames_lint::read::bag::Sampling;
use frames_lint::source::{ReadStatus, SourceKind};

use crate::packets_captured::{TURN, datagrams, read, turns};
use crate::support::capture::{Capture, Form, Ip, Link, PCAP};
use crate::support::heard;
use crate::support::heard::{TopicMessage, are_some_of};
use crate::support::reading::{folder, found, messages};

const NG: Form = Form::PcapNg { big: false, unit: 9 };
const SENDER: [u8; 4] = [192, 168, 1, 201];

fn capture(form: Form, count: usize) -> Capture {
    let (packets, _) = turns(count);
    Capture::of(form, Link::Ethernet, Ip::V4, &datagrams(&packets, SENDER))
}

/// What is read of a whole file.
fn whole(capture: &Capture) -> Vec<TopicMessage> {
    let (source, _, heard) = heard::read(&capture.bytes);
    assert_eq!(source.status, ReadStatus::Read);
    heard.messages
}

#[test]
fn a_capture_that_was_cut_off_is_read_up_to_there() {
    for form in [PCAP, NG] {
        let capture = capture(form, 2);
        let all = whole(&capture);
        for cut in [7, 500, 1247] {
            let end = capture.starts[100] + cut;
            let (source, extent, heard) = heard::read(&capture.bytes[..end]);
            assert_eq!((source.status, extent.truncated), (ReadStatus::Partial, true));
            let said = messages(&source)[0];
            assert!(
                said.starts_with(&format!("read up to byte {} of {end}", capture.starts[100])),
                "{said}"
            );
            assert_eq!(heard.messages, all[..100]);
        }
    }
}

#[test]
fn reading_goes_on_behind_rubbish() {
    for form in [PCAP, NG] {
        let capture = capture(form, 2);
        let all = whole(&capture);
        for place in [capture.starts[50], capture.starts[50] + 700] {
            let mut bytes = capture.bytes.clone();
            // Blocks begin at multiples of four.
            let rubbish = (0..4000_u32).map(|number| (number.wrapping_mul(2_654_435_761) >> 13) as u8);
            bytes.splice(place..place, rubbish);
            let (source, extent, heard) = heard::read(&bytes);
            assert_eq!(
                (source.status, extent.truncated, heard.seams),
                (ReadStatus::Partial, true, 1)
            );
            let said = messages(&source)[0];
            assert!(said.contains("were skipped"), "{said}");
            assert!(
                are_some_of(&heard.messages, &all) && heard.messages.len() >= 145,
                "{}",
                heard.messages.len()
            );
        }
    }
}

#[test]
fn wrong_numbers_in_the_heads_of_records_invent_nothing() {
    for (form, fields) in [(PCAP, [3, 9, 10, 11]), (NG, [4, 5, 6, 20])] {
        let capture = capture(form, 2);
        let all = whole(&capture);
        for field in fields {
            for bit in [1, 0x10, 0x80] {
                let mut bytes = capture.bytes.clone();
                bytes[capture.starts[70] + field] ^= bit;
                let (source, _, heard) = heard::read(&bytes);
                assert!(are_some_of(&heard.messages, &all), "{form:?} {field} {bit}");
                assert!(
                    heard.messages.len() >= 140,
                    "{form:?} {field} {bit}: {}",
                    heard.messages.len()
                );
                assert!(heard.messages.len() == 150 || source.status == ReadStatus::Partial);
            }
        }
    }
}

#[test]
fn what_is_no_capture_is_refused() {
    let folder = folder();
    let zeros = [&[0xd4, 0xc3, 0xb2, 0xa1, 2, 0, 4, 0][..], &[0; 5000]].concat();
    let huge = [&[0x0a, 0x0d, 0x0d, 0x0a][..], &[0xfc; 5000]].concat();
    let cases: [(&[u8], &str); 6] = [
        (b"", "the file is empty"),
        (
            b"time,x,y\n1,2,3\n",
            "not a capture: the magic bytes at byte 0 are missing",
        ),
        (b"PK\x03\x04 ...", "not a capture: this is a ZIP archive"),
        (b"\xd4\xc3\xb2\xa1\x02", "the file ends inside its header"),
        (&zeros, "a record has no packet"),
        (&huge, "read up to byte 0"),
    ];
    for (bytes, wanted) in cases {
        let path = folder.path().join("drive.pcap");
        fs::write(&path, bytes).unwrap();
        let (source, _) = found(&path);
        assert_eq!(
            (source.kind, source.status),
            (SourceKind::Pcap, ReadStatus::Unreadable),
            "{wanted}"
        );
        assert!(messages(&source)[0].contains(wanted), "{:?}", messages(&source));
    }
}

#[test]
fn stretches_of_a_large_capture_are_read_and_have_whole_scans() {
    const TURNS: usize = 100;
    let (packets, clouds) = turns(TURNS);
    let folder = folder();
    let path = folder.path().join("drive.pcap");
    let few = Sampling {
        windows: 3,
        seconds: 0.5,
        bytes: 100_000,
        carried: None,
    };
    for form in [PCAP, NG] {
        let capture = Capture::of(form, Link::Ethernet, Ip::V4, &datagrams(&packets, SENDER));
        fs::write(&path, &capture.bytes).unwrap();
        let (source, extent, scans) = read(&path, Some(few));
        assert_eq!((source.status, scans.seams), (ReadStatus::Read, 2), "{source:?}");
        assert_eq!(extent.span_ns, Some((packets[0].0, packets[TURNS * TURN - 1].0)));
        assert!(!extent.whole && !extent.truncated);
        let seen = &scans.seen["/udp/192.168.1.201:2368"];
        let numbers = seen
            .iter()
            .map(|(.., points)| clouds.iter().position(|cloud| cloud == points).unwrap());
        let numbers: BTreeSet<usize> = numbers.collect();
        assert_eq!(numbers.len(), seen.len());
        assert!(
            (9..=15).contains(&numbers.len()) && numbers.contains(&(TURNS - 2)),
            "{numbers:?}"
        );
        assert!(source.examined.bytes < source.examined.bytes_total);
    }
}
