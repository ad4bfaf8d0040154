//! Files as they really are: nearly YAML, nearly JSON, cut off, hostile.

use std::fmt::Write as _;

use super::*;

const FLAT: &str = "[1, 0, 0, 0.5, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]";

/// The claim of a text that only a lenient reader takes, with the note on what was fixed.
fn lenient(text: &str) -> (Claim, String) {
    let (source, facts) = yaml(text);
    assert_eq!(source.status, ReadStatus::Read, "{:?}", source.problems);
    assert_eq!(facts.claims.len(), 1);
    let claim = facts.claims.into_iter().next().unwrap();
    literals_stand_where_they_say(text, &claim);
    assert_eq!(matrix(&claim).2[3].to_bits(), 0.5f64.to_bits());
    (claim, source.detail.unwrap_or_default())
}

#[test]
fn opencv_files_without_document_start_are_read() {
    let (_, detail) = lenient(&format!("%YAML:1.0\n# é\nT_a_b: {FLAT}\n"));
    assert_eq!(detail, "");
    lenient(&format!("%YAML:1.0\n---\nT_a_b: {FLAT}\n"));
    lenient(&format!("\u{feff}T_a_b: {FLAT}\nb: 1\n"));
    lenient(&format!("T_a_b: {FLAT}\r\nb: 1\r\n"));
}

#[test]
fn a_missing_space_after_a_colon_is_fixed() {
    let (_, detail) = lenient(&format!("T_a_b:{FLAT}\nViewer.PointSize:2\nb: 1\n"));
    assert_eq!(
        detail,
        "not strict YAML: line 1: a space is missing after its colon (and 1 more line)"
    );
}

#[test]
fn a_tag_without_a_space_and_words_after_it_are_fixed() {
    let text = format!(
        "%YAML:1.0\nname: é\nLEFT_CAMERA_T_IMU:!!opencv-matrix (left camera to IMU)\n   rows: 4\n    cols: 4\n  dt: d\n   data: {FLAT}\nnext: 1\n"
    );
    let (claim, detail) = lenient(&text);
    assert_eq!(frames(&claim), "LEFT_CAMERA<-IMU");
    assert_eq!(at(&text, claim.place.span().unwrap()), (3, 1));
    assert!(detail.contains("line 3"), "{detail}");
}

#[test]
fn tabs_and_ragged_indentation_are_fixed() {
    lenient(&format!("a:\n\tT_a_b: {FLAT}\n\tb: 1\n"));
    lenient(&format!("a:\n\tT_a_b: {FLAT}\n    b: 1\n"));
    lenient(&format!("A:\nb:\n   x: 1\n B:\nT_a_b: {FLAT}\n"));
    lenient(&format!("a:\n  b: 1\n   T_a_b: {FLAT}\n"));
    lenient("a:\n  b: 1\n   T_a_b: [1, 0, 0, 0.5,\n\t0, 1, 0, 0,\n 0, 0, 1, 0,\n\t\t0, 0, 0, 1]\n");
}

#[test]
fn json_with_comments_is_read() {
    let text = format!(
        "{{\n  // größe\n  \"sensors\": {{ /* T_x_y: 1 */ \"T_lidar_imu\": {FLAT}, // end\n \"u\": \"http://x\" }}\n}}\n"
    );
    let (source, facts) = json(&text);
    assert_eq!(
        (source.status, facts.claims.len()),
        (ReadStatus::Read, 1),
        "{:?}",
        source.problems
    );
    literals_stand_where_they_say(&text, &facts.claims[0]);
    assert_eq!(facts.claims[0].label, "sensors/T_lidar_imu");
    let (source, facts) = json("{\"s\": \"\\ud83d\\ude00 \\/ \\t\",\t\"T_a_b\":[1,0,0,0.5,0,1,0,0,0,0,1,0,0,0,0,1]}");
    assert_eq!(
        (source.status, facts.claims.len()),
        (ReadStatus::Read, 1),
        "{:?}",
        source.problems
    );
}

#[test]
fn all_documents_are_read() {
    let (_, facts) = yaml(&format!("T_a_b: {FLAT}\n---\nT_c_d: {FLAT}\n...\n"));
    assert_eq!(facts.claims.len(), 2);
}

#[test]
fn anchors_aliases_and_merges_are_followed() {
    let text = format!("base: &b\n  T_a_b: &t {FLAT}\nother:\n  <<: *b\n  T_c_d: *t\n");
    let (source, facts) = yaml(&text);
    assert_eq!(source.status, ReadStatus::Read);
    let labels: Vec<_> = facts.claims.iter().map(|c| c.label.as_str()).collect();
    assert_eq!(labels, ["base/T_a_b", "other/T_c_d", "other/T_a_b"]);
    literals_stand_where_they_say(&text, &facts.claims[1]);
}

#[test]
fn an_alias_bomb_is_stopped() {
    let mut text = "a0: &a0 [1, 2, 3, 4, 5, 6, 7, 8, 9]\n".to_owned();
    for level in 1..20 {
        let items = vec![format!("*a{}", level - 1); 9].join(", ");
        writeln!(text, "a{level}: &a{level} [{items}]").unwrap();
    }
    let (source, _) = yaml(&text);
    assert_eq!(source.status, ReadStatus::Partial);
    assert!(source.problems[0].message.contains("aliases"), "{:?}", source.problems);
    let (line, _) = at(&text, source.problems[0].place.span().unwrap());
    assert!((4..9).contains(&line), "{line}");
    let (source, _) = yaml("a: &a [1, *a]\n");
    assert_eq!(source.problems.len(), 1);
    let (source, _) = yaml("a: *b\n");
    assert_eq!(source.problems.len(), 1);
}

#[test]
fn nesting_through_aliases_is_bounded() {
    let mut text = "a0: &a0 x\n".to_owned();
    for level in 1..400 {
        writeln!(text, "a{level}: &a{level} [[*a{}]]", level - 1).unwrap();
    }
    let (source, _) = yaml(&text);
    assert!(source.problems[0].message.contains("nested"), "{:?}", source.problems);
}

#[test]
fn deep_nesting_is_refused_and_does_not_overflow() {
    for text in [
        "[".repeat(50_000),
        "{a: ".repeat(50_000),
        "- ".repeat(50_000),
        "? ".repeat(50_000),
    ] {
        let (source, facts) = yaml(&text);
        assert_ne!(source.status, ReadStatus::Read);
        assert!(facts.claims.is_empty() && source.problems.len() == 1);
        let (source, _) = json(&text);
        assert_ne!(source.status, ReadStatus::Read);
    }
}

#[test]
fn what_stands_before_a_fault_is_kept_and_the_place_is_exact() {
    let text = format!("a: é\nT_a_b: {FLAT}\nT_c_d: [1, 0, 0, 0, 1, 0, 0, 0, 1}}\n");
    let (source, facts) = yaml(&text);
    assert_eq!(source.status, ReadStatus::Partial);
    assert_eq!(
        facts.claims.iter().map(|c| c.label.as_str()).collect::<Vec<_>>(),
        ["T_a_b"]
    );
    assert_eq!(
        at(&text, source.problems[0].place.span().unwrap()),
        (3, 8),
        "{:?}",
        source.problems
    );
    // Nine numbers of sixteen are not a rotation.
    let (source, facts) = json("{\n\"T_a_b\": [\n0, -1, 0,\n1, 0, 0,\n0, 0, 1");
    assert_eq!((source.status, facts.claims.len()), (ReadStatus::Unreadable, 0));
    let (source, facts) = json(&format!(
        "{{\n\"T_a_b\": {FLAT},\n\"T_c_d\": [\n[0, -1, 0],\n[1, 0, 0],\n[0, 0, 1]"
    ));
    assert_eq!((source.status, facts.claims.len()), (ReadStatus::Partial, 1));
    let (_, facts) = json("{\n\"mount\": {\n\"x\": 1,\n\"y\": 2,\n\"z\": 3,\n\"roll\": 0,\n\"pitch\": 0,\n\"yaw\": 1");
    assert!(facts.claims.is_empty());
}

#[test]
fn templates_and_substitutions_are_named() {
    for text in [
        "{{ header }}\nT_a_b: 1\n",
        "rate: {{ rate }}\nb: 1\n",
        "{% if x %}\na: 1\n{% endif %}\n",
    ] {
        let (source, _) = yaml(text);
        assert_ne!(source.status, ReadStatus::Read, "{text}");
        assert!(source.problems[0].message.contains("template"), "{:?}", source.problems);
    }
    let text = "mount: {xyz: [0, 0, $(arg z)], rpy: [0, 0, 0]}\n";
    let (source, facts) = yaml(text);
    assert_eq!((source.status, facts.claims.len()), (ReadStatus::Partial, 0));
    assert!(
        source.problems[0].message.contains("`$(arg z)`"),
        "{:?}",
        source.problems
    );
    assert_eq!(at(text, source.problems[0].place.span().unwrap()), (1, 21));
    none("file: $(find-pkg-share x)/y.rviz\nname: '{{ not code }}'\n");
}

#[test]
fn numbers_that_are_none_and_counts_that_do_not_fit_are_problems() {
    for (text, word) in [
        (
            "T_a_b: [1, 0, 0, O.5, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\n",
            "`O.5` is not a number",
        ),
        ("T_a_b: {rows: 4, cols: 4, data: [1, 0, 0]}\n", "4 rows of 4"),
        ("T_a_b: [[1, 0, 0, 0], [0, 1, 0], [0, 0, 1, 0]]\n", "4, 3, 4"),
        ("T_a_b: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0]\n", "15 numbers"),
        ("extrinsic_R: [1, 0, 0, 0, 1, 0, 0, 0]\n", "8 numbers"),
    ] {
        let (source, facts) = yaml(text);
        assert_eq!((source.status, facts.claims.len()), (ReadStatus::Partial, 0), "{text}");
        assert!(source.problems[0].message.contains(word), "{:?}", source.problems);
    }
    let claim = one("T_a_b: [1, 0, 0, .nan, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\n");
    assert!(claim.pose.is_none() && matrix(&claim).2[3].is_nan());
}

#[test]
fn repeated_keys_are_kept_and_noted() {
    let (source, facts) = yaml(&format!("T_a_b: {FLAT}\nT_a_b: {FLAT}\n"));
    assert_eq!((source.status, facts.claims.len()), (ReadStatus::Read, 2));
    assert_eq!(source.detail.as_deref(), Some("the key `T_a_b` is repeated in line 2"));
}

#[test]
fn empty_binary_and_huge_files_are_named() {
    for text in ["", " \n\n", "\u{feff}"] {
        let (source, facts) = yaml(text);
        assert_eq!((source.status, facts.claims.len()), (ReadStatus::Read, 0));
        assert_eq!(source.detail.as_deref(), Some("empty file: no transforms found"));
    }
    let (source, _) = yaml("T_a_b: \0\u{1}\u{fffd}");
    assert_eq!(source.status, ReadStatus::Unreadable);
    let (source, _) = yaml(&" ".repeat(64 * 1024 * 1024 + 1));
    assert_eq!(source.status, ReadStatus::Unreadable);
    assert!(source.problems[0].message.contains("at most 64 MB"));
    for text in [
        "\u{fffd}\u{1}\u{7f}:\u{fffd}[",
        "%",
        ":",
        "- - -",
        "]",
        "&",
        "*",
        "!!",
        "'",
        "\"\\x",
        "a: |\n",
        "? ",
        "---\n---",
    ] {
        let _ = (yaml(text), json(text));
    }
}

#[test]
fn full_width_commas_are_commas_and_places_stay() {
    let text = "rsimu2wheel:\n  rows: 4\n  cols: 4\n  dt: d\n  data: [1 ，0，0，0.5,\n 0，1，0，0.25，\n 0，0，1，0，\n 0，0，0，1，]\n";
    let (source, facts) = yaml(text);
    let [claim] = &facts.claims[..] else {
        panic!("{:?} {:?}", source.problems, facts.claims)
    };
    literals_stand_where_they_say(text, claim);
    assert_eq!(format!("{:?}", claim.pose.unwrap().translation_m), "[0.5, 0.25, 0.0]");
    assert!(
        source
            .detail
            .unwrap()
            .contains("line 5: its commas are full-width (and 3 more lines)")
    );
}
