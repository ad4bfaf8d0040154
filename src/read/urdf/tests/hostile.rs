//! Input that wants to break the reader.

use proptest::prelude::{ProptestConfig, prop, proptest};

use super::super::repair::repair;
use super::{read_text, read_xacro};
use crate::source::ReadStatus;
use crate::world::robot::ConsumerOpinion;

#[test]
fn fifty_thousand_levels_do_not_overflow_the_stack() {
    const LEVELS: usize = 50_000;
    let deep = |open: &str, close: &str| {
        let times = LEVELS / open.matches('<').count();
        format!(
            "<robot name=\"r\"><link name=\"a\"/>{}{}</robot>",
            open.repeat(times),
            close.repeat(times)
        )
    };
    for (open, close) in [
        ("<link>", "</link>"),
        ("<gazebo><sensor>", "</sensor></gazebo>"),
        ("<robot>", "</robot>"),
    ] {
        let read = read_text(&deep(open, close));
        assert!(read.is_clean(), "{:?}", read.source.problems);
        assert_eq!(read.robot().links[0].name.value, "a");
        // What consumers do not read is not shown to the second one either, so that depth is none to it.
        let asked = &read.robot().consumer;
        assert!(!matches!(asked, ConsumerOpinion::NotAsked(_)), "{open}: {asked:?}");
    }
    let shapes = deep("<geometry>", "</geometry>").replace("<link name=\"a\"/>", "<link name=\"a\"><visual>");
    let shapes = shapes.replace("</robot>", "</visual></link></robot>");
    let read = read_text(&shapes);
    assert!(matches!(&read.robot().consumer, ConsumerOpinion::NotAsked(why) if why.contains("deep")));
    // Macros are walked into, however deep.
    let read = read_xacro(&deep("<xacro:if value=\"1\">", "</xacro:if>"));
    assert_eq!(read.robot().links.len(), 1);
}

#[test]
fn entities_are_refused_before_they_grow() {
    let bomb = "<!DOCTYPE robot [\n<!ENTITY a \"aaaaaaaaaa\">\n<!ENTITY b \"&a;&a;&a;&a;&a;&a;&a;&a;\">\n]>\n<robot name=\"&b;\"/>";
    let read = read_text(bomb);
    assert_eq!(read.source.status, ReadStatus::Unreadable);
    let problem = &read.source.problems[0];
    assert!(problem.message.contains("entity"));
    assert_eq!(read.line(&problem.place), 2);
    assert!(read.facts.robots.is_empty());
}

#[test]
fn an_entity_that_nothing_refers_to_costs_nothing() {
    let unused =
        "<!DOCTYPE robot [\n<!ENTITY a \"aaaaaaaaaa\">\n]>\n<robot name=\"&lt;r&#32;\"><link name=\"a\"/></robot>";
    let read = read_text(unused);
    assert_eq!(read.source.status, ReadStatus::Read, "{:?}", read.source);
    assert_eq!(read.robot().links.len(), 1);
    let read = read_text(&unused.replace("\"a\"/>", "\"&a;\"/>"));
    assert_eq!(read.source.status, ReadStatus::Unreadable);
}

#[test]
fn thousands_of_attributes_are_refused() {
    let attributes: Vec<String> = (0..5000).map(|n| format!(" a{n}=\"\"")).collect();
    let attributes = attributes.concat();
    let read = read_text(&format!("<robot name=\"r\"><link{attributes}/></robot>"));
    assert_eq!(read.source.status, ReadStatus::Unreadable);
    assert!(read.source.problems[0].message.contains("attributes"));
}

#[test]
fn more_than_any_robot_has_is_refused_with_its_place() {
    let long = "x".repeat(2000);
    for (text, line, why) in [
        (
            format!("<robot>\n{}</robot>", "<a/>".repeat(600_000)),
            2,
            "more than 600000 elements",
        ),
        (
            format!("<robot>\n<link\nname=\"{long}\"/></robot>"),
            3,
            "a name has 2000 bytes",
        ),
        (
            format!("<robot>\n\n<{long}/></robot>"),
            3,
            "the name of an element has 2000 bytes",
        ),
        (
            format!("<robot>\n<link {long}=\"\"/></robot>"),
            2,
            "the name of an attribute has 2000 bytes",
        ),
        (
            format!("<robot>\n<a b=\"{}\"/></robot>", long.repeat(9)),
            2,
            "the value of an attribute has 18000 bytes",
        ),
        // `>` in values does not smuggle a name past the parser that needs no repair.
        (
            format!("<robot>\n<link name=\"{}\"/></robot>", "x>".repeat(1000)),
            2,
            "a name has 2000 bytes",
        ),
    ] {
        let read = read_text(&text);
        assert_eq!(read.source.status, ReadStatus::Unreadable, "{why}");
        let problem = &read.source.problems[0];
        assert!(problem.message.contains(why), "{}", problem.message);
        assert_eq!(read.line(&problem.place), line, "{why}");
    }
}

#[test]
fn a_list_of_many_numbers_is_kept_in_part() {
    let numbers = "1 ".repeat(5000);
    let read = read_text(&format!(
        "<robot name=\"r\"><link name=\"a\"><visual><origin xyz=\"{numbers}\"/></visual></link></robot>"
    ));
    let list = &read.robot().malformed[0];
    assert_eq!(list.literals.len(), 64);
    assert_eq!(
        list.malformed.as_deref(),
        Some("64 or more numbers are given, 3 needed")
    );
}

#[test]
fn reading_costs_in_proportion_to_the_length() {
    // A quadratic step would take minutes here: as many elements as are taken, with references and attributes.
    let link = "<link name=\"a&amp;b\"><orgin/><visual><origin xyz=\"0 0 0\"/></visual></link>\n";
    let text = format!("<robot name=\"r\">{}</robot>", link.repeat(14_000));
    let started = std::time::Instant::now();
    let read = read_text(&text);
    assert_eq!(read.robot().links.len(), 14_000);
    assert!(started.elapsed().as_secs() < 60, "{:?}", started.elapsed());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    /// Pieces of markup in any order: no panic, lengths kept, every place inside of the text and on characters.
    #[test]
    fn any_sequence_of_markup_is_survived(pieces in prop::collection::vec(prop::sample::select(vec![
        "<robot name=\"r\">", "</robot>", "<link name=\"", "<link name='é'>", "</link>", "\"/>", "<joint name=\"j\" type=\"fixed\">",
        "</joint>", "<parent link=\"a\"/>", "<child link=\"é\"/>", "<origin xyz=\"1 2 3\"", " rpy=\"0,1 é 2\"", "/>", "<!--", "-->",
        "<![CDATA[", "]]>", "<?xml version=\"0.0\"?>", "<!DOCTYPE robot [", "<!ENTITY a \"b\">", "]>", "&", "&amp;", "&#x41;", "&#;",
        "é", "\u{2212}", "\0", "\u{1}", "<x:y z:w=\"1\">", "</x:y>", "<", ">", "\"", "'", "=", " ", "\n", "${a}", "<xacro:if value=\"1\">",
        "</xacro:if>", "<gazebo reference=\"é\">", "</gazebo>", "<sensor><frameName> é </frameName></sensor>",
    ]), 0..25)) {
        let text = pieces.concat();
        assert_eq!(repair(&text).text.len(), text.len());
        for read in [read_text(&text), read_xacro(&text), read_text(&format!("<robot name=\"r\">{text}</robot>"))] {
            assert!(!read.facts.robots.is_empty() || !read.source.problems.is_empty());
            let claims = read.facts.claims.iter().map(|claim| &claim.place);
            let frames = read.facts.frames.iter().map(|used| &used.place);
            let problems = read.source.problems.iter().map(|problem| &problem.place);
            for place in claims.chain(frames).chain(problems).filter(|place| place.span().is_some()) {
                // Slicing panics off the text or inside of a character.
                read.at(place);
            }
        }
    }
}
