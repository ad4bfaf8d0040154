//! Input made to take much memory, time or stack, through the real program: refused with its place, within bounds.

#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use std::fmt::Write as _;
use std::fs::File;

use crate::support::program::{check, check_all, line};

/// `count` links that no joint connects.
fn links(count: usize) -> String {
    (0..count).fold(String::new(), |mut text, index| {
        let _ = write!(text, "<link name=\"link{index}\"/>");
        text
    })
}

#[test]
fn fifty_thousand_levels() {
    const LEVELS: usize = 50_000;
    let nested = |open: &str, close: &str| open.repeat(LEVELS) + &close.repeat(LEVELS);
    let robot = |inside: String| format!("<robot name=\"r\"><link name=\"a\"/>{inside}</robot>");
    check("deep.urdf", robot(nested("<a>", "</a>")), 0, &[]);
    let report = check("open.urdf", robot("<a>".repeat(LEVELS)), 3, &["not well-formed XML"]);
    assert_eq!(line(&report), Some(1));
    check(
        "deep.xacro",
        robot(nested("<xacro:if value=\"1\">", "</xacro:if>")),
        3,
        &[],
    );
    for (name, text) in [
        ("deep.json", nested("[", "]")),
        (
            "keys.json",
            format!("{}1{}", "{\"a\":".repeat(LEVELS), "}".repeat(LEVELS)),
        ),
        ("deep.yaml", format!("a: {}", nested("[", "]"))),
        ("keys.yaml", nested("{a: ", "}")),
        ("dashes.yaml", "- ".repeat(LEVELS) + "a"),
        ("open.yaml", "[".repeat(LEVELS)),
    ] {
        let report = check(name, text, 3, &["nested more than 200 levels deep"]);
        assert_eq!(line(&report), Some(1), "{name}");
    }
}

#[test]
fn bombs() {
    let entities: Vec<String> = ('b'..='k')
        .zip('a'..)
        .map(|(name, inner)| format!("<!ENTITY {name} \"{}\">", format!("&{inner};").repeat(10)))
        .collect();
    let entities = entities.concat();
    let bomb = format!(
        "<?xml version=\"1.0\"?>\n<!DOCTYPE r [<!ENTITY a \"aaaa\">{entities}]>\n<robot name=\"&k;\"><link name=\"&k;\"/></robot>"
    );
    let report = check("laughs.urdf", bomb, 3, &["declares an XML entity"]);
    assert_eq!(line(&report), Some(2));

    let mut aliases = "a0: &a0 [x, x, x, x, x, x, x, x, x]\n".to_owned();
    for level in 1..12 {
        let inner = format!("*a{}, ", level - 1).repeat(9);
        let _ = writeln!(aliases, "a{level}: &a{level} [{inner}]");
    }
    let report = check(
        "laughs.yaml",
        aliases,
        3,
        &["aliases expand to more than 200000 values"],
    );
    assert_eq!(line(&report), Some(6));

    // Every anchor holds a copy of what is inside: 190 of them around 200,000 values.
    let open: Vec<String> = (0..190).map(|level| format!("&a{level} [")).collect();
    let open = open.concat();
    let values = "1,".repeat(200_000);
    check(
        "anchors.yaml",
        format!("a: {open}{values}{}\n", "]".repeat(190)),
        3,
        &["no transforms found"],
    );
}

/// Each macro calls the one before ten times: a million links.
#[test]
fn macros_that_grow_tenfold() {
    let macros: Vec<String> = (1..7)
        .map(|level| {
            let calls = format!("<xacro:m{}/>", level - 1).repeat(10);
            format!("<xacro:macro name=\"m{level}\">{calls}</xacro:macro>")
        })
        .collect();
    let text = format!(
        "<robot name=\"r\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\">\
         <xacro:macro name=\"m0\"><link name=\"a\"/></xacro:macro>{}<xacro:m6/></robot>",
        macros.concat()
    );
    check("macros.xacro", text, 3, &["takes too much memory"]);
}

#[test]
fn large_files() {
    let folder = tempfile::tempdir().unwrap();
    for (name, why) in [
        ("zeros.mcap", "the magic bytes at byte 0 are missing"),
        ("zeros.urdf", "the file has 1024 MB"),
        ("zeros.yaml", "the file has 1024 MB"),
    ] {
        File::create(folder.path().join(name))
            .unwrap()
            .set_len(1 << 30)
            .unwrap();
        check_all(folder.path(), &[name], 3, &[name, why]);
        std::fs::remove_file(folder.path().join(name)).unwrap();
    }
    let megabytes = |count: usize| "x".repeat(count << 20);
    let text = |name: &str, text: String, code: i32, says: &[&str]| check(name, text, code, says);
    text(
        "long.yaml",
        format!("a: {}", megabytes(10)),
        3,
        &["no transforms found"],
    );
    text(
        "long.json",
        format!("{{\"a\": \"{}\"}}", megabytes(10)),
        3,
        &["no transforms found"],
    );
    let comment = format!("<robot name=\"r\"><!--{}--><link name=\"a\"/></robot>", megabytes(10));
    text("comment.urdf", comment, 0, &[]);
    let name = format!("<robot name=\"r\"><link name=\"{}\"/></robot>", megabytes(10));
    text("name.urdf", name, 3, &["a name has 10485760 bytes"]);
    let value = format!("<robot name=\"r\"><link name=\"{}\"/></robot>", ">".repeat(5000));
    text("value.urdf", value, 3, &["a name has 5000 bytes"]);
    let tag = format!("<robot name=\"r\"><{0}></{0}></robot>", megabytes(10));
    text("tag.urdf", tag, 3, &["the name of an element has 10485760 bytes"]);
    let numbers = format!(
        "<robot name=\"r\"><link name=\"a\"><visual><origin xyz=\"{}\"/></visual></link></robot>",
        "1 ".repeat(5 << 20)
    );
    text(
        "numbers.urdf",
        numbers,
        3,
        &["the value of an attribute has 10485760 bytes"],
    );
    let report = text(
        "links.urdf",
        format!("<robot name=\"r\">{}</robot>", links(700_000)),
        3,
        &["more than 600000 elements"],
    );
    assert_eq!(line(&report), Some(1));
    text(
        "list.json",
        format!("{{\"a\": [{}1]}}", "0.123456,".repeat(1_165_084)),
        3,
        &["more than 1000000 values"],
    );
}

#[test]
fn as_many_faults_as_fit() {
    // The largest report: every link is a tree of its own.
    let report = check(
        "trees.urdf",
        format!("<robot name=\"r\">{}</robot>", links(100_000)),
        1,
        &[],
    );
    let orphans = report["findings"].as_array().unwrap().iter();
    let orphans: Vec<_> = orphans.filter(|finding| finding["rule"] == "TREE01").collect();
    assert_eq!(orphans.len(), 5001);
    let last = orphans
        .iter()
        .find(|finding| finding["subject"] == "findings that are not listed");
    let last = last.unwrap();
    assert_eq!(last["severity"], "error");
    assert_eq!(
        last["measured"][0]["value"], 94_999.0,
        "each of 99,999 trees is told or counted"
    );
}
