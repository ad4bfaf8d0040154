//! Lists of numbers: what a consumer reads, and why it cannot. The truth was taken from urdfdom's `check_urdf` 6.0.0.

use super::{joint_with, read_text};

fn xyz(value: &str) -> super::UrdfResult {
    read_text(&joint_with(&format!("<origin xyz=\"{value}\" rpy=\"0 0 0\"/>")))
}

#[test]
fn lists_that_urdfdom_takes_are_sound() {
    for (value, numbers) in [
        ("0 0 1", [0.0, 0.0, 1.0]),
        ("0  0   1", [0.0, 0.0, 1.0]),
        (" 0 0 1 ", [0.0, 0.0, 1.0]),
        ("1. .5 +1", [1.0, 0.5, 1.0]),
        ("-.5 1e3 1E-3", [-0.5, 1000.0, 0.001]),
        ("0 \n0 1", [0.0, 0.0, 1.0]),
        ("&#48; 0 1", [0.0, 0.0, 1.0]),
    ] {
        let read = xyz(value);
        assert!(read.robot().malformed.is_empty(), "{value:?}: {:?}", read.malformed());
        assert_eq!(read.claim().pose.unwrap().translation_m, numbers, "{value:?}");
    }
}

#[test]
fn lists_that_urdfdom_refuses_are_malformed_with_a_plain_reason() {
    for (value, reason) in [
        ("0, 0, 1", "`0,`: a comma between numbers; separate them by spaces"),
        ("0,0,1", "`0,0,1`: a comma between numbers; separate them by spaces"),
        ("0;0;1", "`0;0;1`: a semicolon between numbers; separate them by spaces"),
        ("0,5 0 0", "`0,5` has a decimal comma; write a decimal point"),
        ("1 2", "2 numbers are given, 3 needed"),
        ("1", "1 number is given, 3 needed"),
        ("1 2 3 4", "4 numbers are given, 3 needed"),
        ("", "the attribute is empty; 3 numbers are needed"),
        ("  ", "the attribute is empty; 3 numbers are needed"),
        ("0 O 0", "`O` is not a number"),
        ("1m 0 0", "`1m` is not a number"),
        ("0x10 0 0", "`0x10` is not a number"),
        ("--1 0 0", "`--1` is not a number"),
        (
            "\u{2212}1 0 0",
            "`\u{2212}1` is not a number: U+2212 instead of a minus sign",
        ),
        ("0\u{a0}0 1", "`0\\u{a0}0` is not a number: it contains U+00A0"),
    ] {
        let read = xyz(value);
        assert_eq!(read.malformed(), [(value, reason)]);
        assert_eq!(read.claim().pose, None, "{value:?} makes no pose");
        assert_eq!(read.at(&read.robot().malformed[0].text.place), value);
        assert!(
            read.is_clean(),
            "a malformed number is a finding, not a problem of the input"
        );
    }
    for value in ["0\t0\t1", "0 0\n1", "0 0 1\n"] {
        let read = xyz(value);
        assert!(
            read.malformed()[0].1.contains("at spaces only"),
            "{value:?}: {:?}",
            read.malformed()
        );
    }
    assert!(xyz("${x} 0 0").malformed()[0].1.contains("unexpanded"));
}

#[test]
fn what_is_not_finite_is_a_value_not_a_misspelling() {
    for value in ["nan 0 0", "0 inf 0", "1e400 0 0", "-Infinity 0 0"] {
        let read = xyz(value);
        assert!(read.robot().malformed.is_empty(), "{value}");
        assert_eq!(read.claim().pose, None, "{value}");
        let literals = &read.claim().translation_literals;
        assert!(literals.iter().any(|literal| !literal.value.is_finite()), "{value}");
    }
}

#[test]
fn single_numbers_are_judged_too() {
    let link = |inside: &str| read_text(&format!("<robot name=\"r\"><link name=\"a\">{inside}</link></robot>"));
    let mass = link(r#"<inertial><mass value="2,5"/></inertial>"#);
    assert_eq!(
        mass.malformed(),
        [("2,5", "`2,5` has a decimal comma; write a decimal point")]
    );
    assert_eq!(mass.robot().links[0].inertial.as_ref().unwrap().mass_kg, None);
    let trailing = link(r#"<inertial><mass value="2.5 "/></inertial>"#);
    assert!(trailing.malformed()[0].1.starts_with("a trailing space"));
    let size = link(r#"<visual><geometry><box size="1 2"/></geometry></visual>"#);
    assert_eq!(size.malformed(), [("1 2", "2 numbers are given, 3 needed")]);
    let limit = read_text(&joint_with(r#"<limit lower="-1.57." upper="1"/>"#));
    assert_eq!(limit.malformed(), [("-1.57.", "`-1.57.` is not a number")]);
}

#[test]
fn references_inside_a_value_give_the_place_of_the_whole_attribute() {
    let read = xyz("&#48; 7 1");
    let claim = read.claim();
    for literal in &claim.translation_literals {
        assert_eq!(&read.source.text[literal.span.start..literal.span.end], "&#48; 7 1");
    }
    assert_eq!(claim.translation_literals[0].text, "0");
}
