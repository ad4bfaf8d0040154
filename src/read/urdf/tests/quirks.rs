//! Habits of real files that urdfdom takes and a strict XML parser does not.

use super::read_text;
use crate::read::text::decode;
use crate::source::ReadStatus;
use crate::world::FrameRole;

const ROBOT: &str = r#"<robot name="r"><link name="a"/></robot>"#;

/// Everything must be there, at its place, without a problem.
fn takes(text: &str) {
    let read = read_text(text);
    assert!(read.is_clean(), "{text:?}: {:?}", read.source.problems);
    assert_eq!(read.frames(FrameRole::Link), ["a"], "{text:?}");
    assert_eq!(read.at(&read.robot().links[0].name.place), "a");
    assert_eq!(
        read.robot().links[0].place.span().unwrap().start,
        text.rfind("<link").unwrap()
    );
}

#[test]
fn any_declaration_anywhere_before_the_root() {
    takes(&format!("<?xml version=\"0.0\"?>{ROBOT}"));
    takes(&format!("<?xml version=\"1.1\" encoding=\"latin-1\"?>{ROBOT}"));
    takes(&format!("\n\n  <?xml version=\"1.0\"?>\n{ROBOT}"));
    takes(&format!("<!-- é -->\n<?xml version=\"1.0\"?>{ROBOT}"));
    takes(&format!("<?xml version=\"1.0\"?><?xml version=\"1.0\"?>{ROBOT}"));
    takes(&format!("<!DOCTYPE robot>\n{ROBOT}"));
    takes(&format!("left over text\n{ROBOT}"));
    takes(&format!("\u{FEFF}{ROBOT}"));
}

#[test]
fn prefixes_nobody_declares_and_sloppy_markup() {
    takes(r#"<robot name="r" gazebo:x="1"><drake:tag a:b="1"><x:y/></drake:tag><link name="a"/></robot>"#);
    takes(r#"<robot name="a & b < c"><link name="a"/></robot>"#);
    takes(r#"<robot name='r'><!-- a -- b --- <link name="no"/> --><link name="a"/></robot>"#);
    takes(r#"<robot name="r"><![CDATA[<link name="no"/>]]><link name="a"/>1 & 2</robot>"#);
    takes("<robot name=\"r\">\u{1}<link name=\"a\"/></robot>");
    takes("<robot name=\"r\"><link name=\"a\"/></robot>\n\0\t</collision>\n</robot>");
    let read = read_text(r#"<robot name="a &amp; b & c &lt; d"><link name="a"/></robot>"#);
    assert_eq!(
        read.robot().name.value,
        "a &amp; b & c &lt; d",
        "what had to be repaired stands for itself"
    );
    let read = read_text(r#"<robot name="a &amp; b"><link name="a"/></robot>"#);
    assert_eq!(read.robot().name.value, "a & b");
}

#[test]
fn encodings() {
    for bytes in [
        [&[0xEF, 0xBB, 0xBF], ROBOT.as_bytes()].concat(),
        std::iter::once(0xFEFF)
            .chain(ROBOT.encode_utf16())
            .flat_map(u16::to_le_bytes)
            .collect(),
    ] {
        takes(&decode(bytes).unwrap().0);
    }
    let latin1 = b"<robot name=\"k\xE4fer\"><link name=\"a\"/></robot>";
    let (text, note) = decode(latin1.to_vec()).unwrap();
    takes(&text);
    assert!(note.is_some());
}

#[test]
fn broken_xml_is_unreadable_at_its_place() {
    for (text, line, word) in [
        (
            "<robot name=\"r\">\n  <link name=\"é\"/>\n  <link>\n</robot>",
            4,
            "link",
        ),
        ("<robot name=\"r\">\n <link name=\"a\"/>", 2, "never closed"),
        ("<robot name=\"r\">\n <link name=a/>\n</robot>", 2, "expected"),
        (
            "<robot name=\"r\">\n <link name=\"a\" name=\"b\"/>\n</robot>",
            2,
            "name",
        ),
        ("<robot name=\"r\"/>\njunk", 2, "unknown token"),
    ] {
        let read = read_text(text);
        assert_eq!(read.source.status, ReadStatus::Unreadable, "{text}");
        let problem = &read.source.problems[0];
        assert_eq!(read.line(&problem.place), line, "{text}: {}", problem.message);
        assert!(problem.message.contains(word), "{}", problem.message);
        assert!(read.facts.robots.is_empty());
    }
}

#[test]
fn what_is_no_robot_is_called_what_it_is() {
    for (text, word) in [
        ("<sdf version='1.6'><model/></sdf>", "an SDF file"),
        ("<?xml version='1.0'?>\n<launch><node/></launch>", "a launch file"),
        ("<mujoco/>", "a MuJoCo model"),
        ("<Robot name='r'/>", "lower case"),
        ("<svg/>", "not a robot description"),
        ("", "no XML element"),
        ("name: robot\n", "no XML element"),
    ] {
        let read = read_text(text);
        assert_eq!(read.source.status, ReadStatus::Unreadable, "{text}");
        let message = &read.source.problems[0].message;
        assert!(message.contains(word), "{text}: {message}");
        assert!(read.facts.robots.is_empty() && read.facts.frames.is_empty());
    }
}

#[test]
fn a_part_without_root_is_read_as_a_part() {
    let text = "<link name=\"a\"/>\n<link name=\"b\"/>\n<joint name=\"j\" type=\"fixed\">\n<parent link=\"a\"/><child link=\"b\"/></joint>\n";
    let read = read_text(text);
    assert_eq!(read.source.status, ReadStatus::Partial);
    assert!(read.source.problems[0].message.contains("no `<robot>`"));
    assert!(read.robot().fragment.is_some());
    assert_eq!(read.frames(FrameRole::Link), ["a", "b"]);
    assert_eq!(read.at(&read.robot().links[1].name.place), "b");
    assert_eq!(read.line(&read.claim().place), 3);
    let broken = read_text("<link name=\"a\"/>\n<link name=\"b\">");
    assert_eq!(broken.source.status, ReadStatus::Unreadable);
}

#[test]
fn a_second_element_at_the_top_is_said_and_not_read() {
    let read = read_text(&format!("{ROBOT}\n<robot name=\"z\"><link name=\"b\"/></robot>"));
    assert_eq!(read.source.status, ReadStatus::Partial);
    assert_eq!(read.line(&read.source.problems[0].place), 2);
    assert_eq!(read.frames(FrameRole::Link), ["a"]);
}
