//! Tests of the page as a whole: one item of every outcome, hostile words, plots by hand-computed places, bounds.

#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use super::plots::draw;
use super::*;
use crate::report::samples::{ROBOT, Sample, everything};
use crate::run::{UnmetRequirement, VerdictWord};
use crate::source::SourceKind;
use crate::verdict::plot::{Axis, Level, Plot, Series};
use crate::verdict::{Acceptance, Measured, Outcome, Severity};

#[path = "../../../tests/support/page.rs"]
#[allow(clippy::expect_used, dead_code)]
mod parsed;

use parsed::Page as Parsed;

fn page(run: &Run) -> (String, Parsed) {
    let text = render(run, FailOn::Error, &Call::default());
    let document = Parsed::parse(&text);
    assert!(document.errors.is_empty(), "{:?}", document.errors);
    (text, document)
}

fn waived() -> Acceptance {
    Acceptance {
        reason: "remounted".to_owned(),
        by: Some("J. Doe".to_owned()),
        until: crate::verdict::waiver::Day::parse("2027-01-31"),
        origin: "frames-lint.yaml:12".to_owned(),
    }
}

#[test]
fn every_outcome_stands_with_its_sign_its_word_and_its_evidence() {
    let mut run = everything();
    run.verdict
        .rows
        .iter_mut()
        .find(|row| row.rule == "A01")
        .unwrap()
        .measured = vec![Measured::new("tilt", 0.125, "deg").limit(2.0).samples(7)];
    run.verdict.findings[0].waived = Some(waived());
    run.unmet = vec![UnmetRequirement {
        kind: crate::run::RequirementKind::Rule,
        rule: "A02".to_owned(),
        name: "a-rule".to_owned(),
        subject: Some("*lidar*".to_owned()),
        why: vec!["missing input: no URDF".to_owned()],
        record: Some("record `/robot_description`".to_owned()),
        origin: "frames-lint.yaml:3".to_owned(),
        recordings: Vec::new(),
        waived: None,
    }];
    let (text, document) = page(&run);
    let all = |selector: &str| document.texts(selector).join("|");
    for word in ["✓ passed", "✗ failed", "– not evaluated", "⊘ waived", "! crashed"] {
        assert!(all("#checklist td").contains(word), "{word}: {}", all("#checklist td"));
    }
    assert!(
        all("#checklist li").contains("tilt: 0.125 deg, limit 2 deg, n = 7"),
        "{}",
        all("#checklist li")
    );
    assert!(all("#checklist td").contains("index out of range"));
    assert!(all("#waived .accepted").contains("remounted, by J. Doe, until 2027-01-31 (frames-lint.yaml:12)"));
    assert!(all("#waived .fix").contains("write 0 0 1.5707963"));
    assert!(all("#waived .places").contains("drive.mcap /tf_static message 3, stamp 2023-11-14 22:13:20.000 UTC"));
    assert!(all("#required td").contains("record /robot_description"));
    assert!(all("#inputs .problem").contains("the list is never closed"));
    assert!(all("#inputs .problem").contains("What to do: close it with ]"));
    assert!(all("#findings .finding").contains("A hint: it never fails"));
    // What is not finite is no reason to stop.
    assert!(text.contains("NaN deg"));
    assert_eq!(document.texts("h2").len(), 7, "{:?}", document.texts("h2"));
}

#[test]
fn the_first_page_says_when_of_what_how_much_and_by_which_configuration() {
    use crate::source::{Coverage, FileHash};
    let mut s = Sample::default();
    let examined = |bytes: u64, messages: u64, messages_total: Option<u64>| Coverage {
        bytes,
        bytes_total: 4000,
        messages: Some(messages),
        messages_total,
        ..Coverage::default()
    };
    let hash = |name: &str, digit: &str| FileHash {
        name: name.to_owned(),
        sha256: Some(digit.repeat(64)),
    };
    let bag = s.source("/data/a/metadata.yaml", SourceKind::Rosbag2, "");
    let config = s.source("/data/frames-lint.yaml", SourceKind::Configuration, "");
    let other = s.source("/data/b.mcap", SourceKind::Mcap, "");
    s.row("A01", "x", Outcome::Pass, None);
    s.row("A02", "x", Outcome::NotEvaluated, Some("too short"));
    let mut run = s.run();
    std::sync::Arc::make_mut(&mut run.sources[bag.0 as usize]).examined = examined(1000, 10, Some(40));
    std::sync::Arc::make_mut(&mut run.sources[bag.0 as usize]).hashes =
        vec![hash("metadata.yaml", "a"), hash("a_0.mcap", "b"), hash("a_1.mcap", "c")];
    std::sync::Arc::make_mut(&mut run.sources[config.0 as usize]).hashes = vec![hash("frames-lint.yaml", "d")];
    std::sync::Arc::make_mut(&mut run.sources[other.0 as usize]).examined = examined(3000, 5, Some(5));
    std::sync::Arc::make_mut(&mut run.sources[other.0 as usize]).hashes = vec![hash("b.mcap", "e")];
    let call = Call {
        day: Some("2027-01-31".to_owned()),
        ..Call::default()
    };
    let page = |run: &Run| {
        let document = Parsed::parse(&render(run, FailOn::Error, &call));
        assert!(document.errors.is_empty(), "{:?}", document.errors);
        document
    };
    let document = page(&run);
    let facts = document.texts("header .facts dd");
    let names = document.texts("header .facts dt");
    let expected = [
        "Date of the run",
        "Platform",
        "Inputs",
        "Examined",
        "Checks evaluated",
        "Configuration",
    ];
    assert_eq!(names, expected);
    assert_eq!(facts[0], "2027-01-31 (UTC)");
    assert!(facts[3].ends_with("15 of 45 messages (33.3 %)"), "{}", facts[3]);
    assert_eq!(facts[4], "1 of 2 applicable (50.0 %)");
    assert!(facts[5].contains("frames-lint.yaml – SHA-256 dddd"), "{}", facts[5]);
    // The signature comes there, before everything else.
    assert_eq!(document.texts("h2")[0], "Decision");
    // Each file has its own hash, with its name where the source is called otherwise.
    assert_eq!(
        document.texts("#inputs .files dt"),
        ["metadata.yaml", "a_0.mcap", "a_1.mcap"]
    );
    assert_eq!(document.texts("#inputs .files dd")[2], "c".repeat(64));
    assert!(document.texts("#inputs .hash").contains(&"e".repeat(64)));
    // The number of messages of a recording without an index is unknown.
    std::sync::Arc::make_mut(&mut run.sources[other.0 as usize])
        .examined
        .messages_total = None;
    assert!(page(&run).texts("header .facts dd")[3].ends_with(" 15 messages"));
}

#[test]
fn the_worst_recording_and_what_failed_stand_first() {
    use crate::run::Recording;
    let mut s = Sample::default();
    s.row("B01", "right", Outcome::Pass, None);
    s.row("B02", "wrong", Outcome::Fail, None);
    let mut run = s.run();
    for row in &mut run.verdict.rows {
        row.plots = vec![Plot {
            title: row.subject.clone(),
            ..track()
        }];
    }
    let summary = run.summary(FailOn::Error);
    let recording = |label: &str, errors: usize, warnings: usize, reasons: &[(Severity, &str)]| Recording {
        label: label.to_owned(),
        sources: Vec::new(),
        summary: crate::run::Summary {
            not_applicable: 0,
            errors,
            warnings,
            verdict: if errors > 0 {
                VerdictWord::Findings
            } else {
                VerdictWord::Clean
            },
            ..summary
        },
        code: 0,
        because: reasons
            .first()
            .filter(|_| errors > 0)
            .map(|(_, words)| (*words).to_owned()),
        reasons: reasons
            .iter()
            .map(|(severity, words)| (*severity, (*words).to_owned()))
            .collect(),
    };
    run.recordings = vec![
        recording("quiet", 0, 0, &[]),
        recording("late", 0, 2, &[(Severity::Warning, "TIME03 gap: 2 s")]),
        recording(
            "mirrored",
            1,
            1,
            &[
                (Severity::Error, "AXES07 mirror: y"),
                (Severity::Warning, "TIME03 gap: 3 s"),
            ],
        ),
    ];
    let (_, document) = page(&run);
    assert_eq!(
        document.texts("#recordings th[scope=row]"),
        ["mirrored", "late", "quiet"]
    );
    let reasons = [
        "✗ error AXES07 mirror: y",
        "! warning TIME03 gap: 3 s",
        "! warning TIME03 gap: 2 s",
    ];
    assert_eq!(document.texts("#recordings li"), reasons);
    assert_eq!(document.texts("#plots figcaption strong"), ["wrong", "right"]);
}

#[test]
fn an_empty_run_is_a_page_too() {
    let (_, document) = page(&Run::default());
    assert!(document.texts("h1")[0].contains("Incomplete"));
    assert!(document.texts(".ending")[0].contains("Nothing was checked"));
    assert_eq!(document.texts("#findings p"), ["No findings."]);
}

#[test]
fn hostile_words_stay_words_wherever_they_stand() {
    const EVIL: &str =
        "`</script></style><script>x</script>` <img src=x onerror=y> \" ' & \u{1b}[2J \u{0} \u{202e} \u{fdd0}";
    let mut s = Sample::default();
    let id = s.source(EVIL, SourceKind::Urdf, &format!("{EVIL}\n"));
    let place = s.at(id, "<img");
    let plot = Plot {
        title: EVIL.to_owned(),
        x: Axis::new(EVIL, EVIL),
        y: Axis::new(EVIL, EVIL),
        equal: false,
        series: vec![Series::points(EVIL, [[0.0, 1.0], [1.0, 2.0]])],
        limits: vec![Level {
            label: EVIL.to_owned(),
            at: 1.5,
        }],
    };
    // Codes and names of rules are the tool's own.
    s.finding(
        "B01",
        "b",
        Finding::error(EVIL, EVIL, place.clone())
            .label(EVIL)
            .help(EVIL)
            .relation(EVIL)
            .measured(Measured::new(EVIL, 1.0, EVIL).limit(2.0))
            .fix(
                EVIL,
                crate::verdict::Safety::Safe,
                vec![crate::verdict::Edit {
                    place,
                    replacement: EVIL.to_owned(),
                }],
            ),
    );
    s.row("B02", EVIL, Outcome::NotEvaluated, Some(EVIL));
    let mut run = s.run();
    for row in &mut run.verdict.rows {
        row.plots = vec![plot.clone()];
    }
    run.skipped.insert(EVIL.to_owned(), 2);
    std::sync::Arc::make_mut(&mut run.sources[0]).problem(
        crate::source::ReadStatus::Partial,
        crate::source::Place::whole(id),
        EVIL,
    );
    std::sync::Arc::make_mut(&mut run.sources[0]).hashes = vec![
        crate::source::FileHash {
            name: EVIL.to_owned(),
            sha256: Some(EVIL.to_owned()),
        };
        2
    ];
    let call = Call {
        command: vec![EVIL.to_owned()],
        settings: vec![("x", EVIL.to_owned())],
        day: Some("2027-01-31".to_owned()),
    };
    let text = render(&run, FailOn::Error, &call);
    let document = Parsed::parse(&text);
    assert!(document.errors.is_empty(), "{:?}", document.errors);
    assert_eq!(document.texts("script").len(), 1);
    assert_eq!(document.texts("style").len(), 1);
    assert!(document.texts("img, [onerror], [style]").is_empty());
    assert!(!text.contains(['\u{1b}', '\u{0}', '\u{202e}', '\u{fdd0}']));
    assert!(document.texts("main")[0].contains("<img src=x onerror=y>"));
}

fn track() -> Plot {
    Plot {
        title: "track".to_owned(),
        x: Axis::new("east", "m"),
        y: Axis::new("north", "m"),
        equal: false,
        series: vec![
            Series::points("places", [[0.0, 0.0], [10.0, 20.0], [10.0, 20.0]]),
            Series::lines("way", [vec![[0.0, 20.0], [10.0, 0.0]]]).remove(0),
        ],
        limits: vec![
            Level {
                label: "most".to_owned(),
                at: 10.0,
            },
            Level {
                label: "far".to_owned(),
                at: 1e7,
            },
        ],
    }
}

#[test]
fn points_are_drawn_where_they_belong() {
    let drawn = draw(&track(), "plot-1").unwrap();
    // The area is 440 by 220 from (74, 12), and 5 % of each range is room: x from -0.5 to 10.5, y from -1 to 21.
    // 0 is at 74 + 440 * 0.5/11 = 94, 10 at 494; y of 0 at 232 - 220 * 1/22 = 222, of 20 at 22, of 10 at 122.
    assert!(
        drawn.svg.contains("<path class=\"p0\" d=\"M94 222h0M494 22h0\"/>"),
        "{}",
        drawn.svg
    );
    assert!(
        drawn.svg.contains("<path class=\"l1\" d=\"M94 22L494 222\"/>"),
        "{}",
        drawn.svg
    );
    assert!(
        drawn.svg.contains("<path class=\"limit\" d=\"M74 122H514\"/>"),
        "{}",
        drawn.svg
    );
    assert_eq!(
        drawn.svg.matches("class=\"limit\"").count(),
        1,
        "the far one would flatten the rest"
    );
    let legend: Vec<String> = drawn
        .legend
        .iter()
        .map(|(_, name, words)| format!("{name}{words}"))
        .collect();
    assert_eq!(
        legend,
        ["places", "way", "most: 10 m", "far: 10000000 m (outside of the plot)"]
    );
    assert!(drawn.svg.contains("east: from 0 to 10 m."));
}

#[test]
fn a_step_is_as_long_in_both_directions_where_it_should_be() {
    let plot = Plot {
        equal: true,
        limits: Vec::new(),
        ..track()
    };
    // Ranges of 11 and 22 m: 360 high, 16.36 a metre, and no less than 240 wide: x from 5 - 7.333 to 5 + 7.333.
    let drawn = draw(&plot, "plot-1").unwrap();
    assert!(drawn.svg.contains("viewBox=\"0 0 332 422\""), "{}", drawn.svg);
    // x: 74 + 2.333 * 16.36 = 112.2, and 10 m further 275.8; y: 372 - 16.36 = 355.6, and 20 m up 28.4.
    assert!(drawn.svg.contains("M112.2 355.6h0M275.8 28.4h0"), "{}", drawn.svg);
}

#[test]
fn odd_numbers_are_drawn_or_left_out() {
    let with = |points: Vec<[f64; 2]>| Plot {
        series: vec![Series::points("a", points)],
        ..track()
    };
    assert!(draw(&with(Vec::new()), "a").is_none());
    assert!(draw(&with(vec![[f64::MAX, 0.0], [f64::MIN, 1.0]]), "a").is_none());
    for points in [
        vec![[0.0, 0.0]],
        vec![[1e300, -1e-300], [2.0, 3.0]],
        vec![[5.0, 7.0]; 3],
        vec![[1.7e18, 1e-9], [1.7e18, 2e-9]],
    ] {
        for equal in [false, true] {
            let drawn = draw(
                &Plot {
                    equal,
                    ..with(points.clone())
                },
                "a",
            );
            assert!(!drawn.unwrap().svg.contains("NaN"), "{points:?}");
        }
    }
}

#[test]
fn plots_stand_with_their_findings_and_are_bounded() {
    let mut s = Sample::default();
    let id = s.source("robot.urdf", SourceKind::Urdf, ROBOT);
    let place = s.at(id, "lidar_joint");
    s.finding("B01", "b", Finding::error("x", "m", place));
    for index in 0..200 {
        s.row("B02", &format!("topic {index}"), Outcome::Pass, None);
    }
    let mut run = s.run();
    for row in &mut run.verdict.rows {
        row.plots = vec![track()];
    }
    let (_, document) = page(&run);
    assert_eq!(document.texts("#findings figure").len(), 1);
    assert_eq!(document.texts("#plots figure").len(), 79);
    assert!(document.texts("#plots .left-out")[0].contains("121 more plots"));
    assert_eq!(document.texts("#checklist a[href^=#plot-]").len(), 80);
}

#[test]
fn a_hundred_thousand_findings_are_counted() {
    let mut s = Sample::default();
    let id = s.source("robot.urdf", SourceKind::Urdf, ROBOT);
    let place = s.at(id, "lidar_joint");
    for index in 0..100_000 {
        let finding = Finding::error(format!("s{index}"), format!("m{index}"), place.clone());
        s.finding("B01", "b", finding.measured(Measured::count("n", index)));
    }
    let (text, document) = page(&s.run());
    assert!(text.len() < 2_000_000, "{}", text.len());
    assert_eq!(document.texts("article.finding").len(), 150);
    assert_eq!(document.texts(".listed li").len(), 500);
    assert!(document.texts("#findings .left-out")[0].contains("99350 more findings"));
    assert!(document.texts("#checklist .more")[0].contains("99800 more items"));
}

#[test]
fn the_same_run_makes_the_same_bytes() {
    assert_eq!(page(&everything()).0, page(&everything()).0);
}

#[test]
fn the_policy_lets_the_style_and_the_script_of_the_page_run() {
    use base64::Engine;
    let (text, document) = page(&everything());
    for (tag, rule) in [("style", "style-src"), ("script", "script-src")] {
        let inner = document.texts(tag).remove(0);
        let digest = base64::engine::general_purpose::STANDARD.encode(Sha256::digest(inner.as_bytes()));
        assert!(text.contains(&format!("{rule} 'sha256-{digest}'")), "{tag}");
    }
    assert!(STYLE.is_ascii() && SCRIPT.is_ascii() && !STYLE.contains("url(") && !SCRIPT.contains("</"));
}
