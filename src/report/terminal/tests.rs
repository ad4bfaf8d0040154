//! The wording of the report, on hand-made runs.

use super::super::samples::{ROBOT, Sample, everything, message};
use super::*;
use crate::source::{MessageRef, Place, ReadStatus, SourceKind};
use crate::verdict::{Finding, Measured, Outcome};

fn with(run: &Run, verbose: bool, all: bool, style: Style) -> String {
    let options = Options {
        style,
        fail_on: FailOn::Error,
        verbose,
        all,
        parts: Parts::All,
    };
    render(run, &options)
}

fn plain(run: &Run) -> String {
    with(run, false, false, Style::PLAIN)
}

#[test]
fn a_finding_in_one_file() {
    let mut s = Sample::default();
    let robot = s.source("robot.urdf", SourceKind::Urdf, ROBOT);
    let place = s.at(robot, "0 0 1.57");
    s.finding(
        "CONV02",
        "quarter-turn",
        Finding::error(
            "joint `lidar_joint`",
            "`lidar` is rotated by 89.954 deg, a quarter turn with digits missing",
            place,
        )
        .likely()
        .label("yaw")
        .measured(
            Measured::new("distance from 90 deg", 0.045_627, "deg")
                .limit(0.01)
                .samples(1),
        )
        .help("write ${pi/2} or 1.5707963"),
    );
    s.row("TREE01", "frame tree", Outcome::Pass, None);
    assert_eq!(
        plain(&s.run()),
        "\
error[CONV02 quarter-turn] (likely) `lidar` is rotated by 89.954 deg, a quarter turn with digits missing
   ╭─[robot.urdf:4:18]
 3 │   <joint name=\"lidar_joint\" type=\"fixed\">
 4 │     <origin rpy=\"0 0 1.57\"/>
   ·                  ────┬───
   ·                      ╰── yaw
 5 │   </joint>
   ╰────
  measured: distance from 90 deg = 0.04563 deg, limit 0.01 deg
  help: write ${pi/2} or 1.5707963

`frames-lint explain CONV02` shows how the rule decides, why it matters and how to fix it

1 error, 0 warnings, 0 notes · 1 check passed · 0 not evaluated · 1 of 1 input read
Not clean: 1 error.
"
    );
}

#[test]
fn a_finding_over_two_files_shows_lines_of_both() {
    let mut s = Sample::default();
    let robot = s.source("robot.urdf", SourceKind::Urdf, ROBOT);
    let calib = s.source("calib.yaml", SourceKind::Yaml, "base_from_lidar:\n  yaw: 0\n");
    let finding = Finding::error("pair", "two sources differ by 90 deg", s.at(robot, "0 0 1.57"))
        .label("90 deg here")
        .related(s.at(calib, "yaw: 0"), "0 deg here")
        .related(s.at(robot, "lidar_joint"), "of this joint")
        .relation("rz-90")
        .measured(
            Measured::new("rotation difference", 90.0, "deg")
                .limit(1.0)
                .spread(0.25)
                .samples(12),
        )
        .measured(Measured::new("translation difference", 0.0, "m").limit(0.05));
    s.finding("CALIB01", "sources-differ", finding);
    assert_eq!(
        plain(&s.run()),
        "\
error[CALIB01 sources-differ] two sources differ by 90 deg
   ╭─[robot.urdf:4:18]
 2 │   <link name=\"base_link\"/>
 3 │   <joint name=\"lidar_joint\" type=\"fixed\">
   ·                ─────┬─────
   ·                     ╰── of this joint
 4 │     <origin rpy=\"0 0 1.57\"/>
   ·                  ────┬───
   ·                      ╰── 90 deg here
 5 │   </joint>
   ╰────
   ╭─[calib.yaml:2:3]
 1 │ base_from_lidar:
 2 │   yaw: 0
   ·   ───┬──
   ·      ╰── 0 deg here
   ╰────
  measured: rotation difference = 90 deg, limit 1 deg, spread 0.25 deg, from 12 samples
            translation difference = 0 m, limit 0.05 m

`frames-lint explain CALIB01` shows how the rule decides, why it matters and how to fix it

1 error, 0 warnings, 0 notes · 0 checks passed · 0 not evaluated · 2 of 2 inputs read
Not clean: 1 error.
"
    );
}

#[test]
fn a_finding_in_a_recording() {
    let mut s = Sample::default();
    let bag = s.source("drive.mcap", SourceKind::Mcap, "");
    std::sync::Arc::make_mut(&mut s.run.sources[0]).examined.bytes = 25_000_000;
    std::sync::Arc::make_mut(&mut s.run.sources[0]).examined.bytes_total = 2_000_000_000;
    std::sync::Arc::make_mut(&mut s.run.sources[0]).examined.messages = Some(1200);
    let at = MessageRef {
        field: Some("transforms[0]".into()),
        ..message("/tf", 12)
    };
    let unstamped = MessageRef {
        stamp_ns: None,
        ..message("/tf", 13)
    };
    let finding = Finding::warning("edge", "`odom` changes its parent", Place::message(bag, at))
        .hint()
        .label("under `map`")
        .related(Place::message(bag, unstamped), "under `earth`")
        .measured(Measured::count("changes", 2));
    s.finding("TF03", "parent-switch", finding);
    assert_eq!(
        plain(&s.run()),
        "\
hint[TF03 parent-switch] `odom` changes its parent
  → drive.mcap /tf message 12, stamp 2023-11-14 22:13:20.000 UTC (1700000000 s), transforms[0]: under `map`
  → drive.mcap /tf message 13, recorded 2023-11-14 22:13:20.100 UTC (1700000000.1 s): under `earth`
  measured: changes = 2

Read in part (1 recording)
  drive.mcap: 25 MB of 2 GB (1.2 %), 1200 messages

`frames-lint explain TF03` shows how the rule decides, why it matters and how to fix it

0 errors, 0 warnings, 0 notes, 1 hint · 0 checks passed · 0 not evaluated · 1 of 1 input read
Clean: no finding counts. 1 hint does not count.
"
    );
}

#[test]
fn nothing_checked_is_never_a_pass() {
    assert!(plain(&Run::default()).ends_with("Nothing was checked: no input files were found. This is not a pass.\n"));

    let mut s = Sample::default();
    s.source("calib.yaml", SourceKind::Yaml, "a: 1\n");
    for rule in ["TREE01", "TREE02", "TF01"] {
        s.row(rule, "platform", Outcome::NotEvaluated, Some("missing input: no URDF"));
    }
    s.row(
        "TF01",
        "clock",
        Outcome::NotEvaluated,
        Some("missing input: no recording"),
    );
    s.run.skipped.insert(".stl".into(), 12);
    s.run.skipped.insert(".png".into(), 3);
    let mut run = s.run();
    assert_eq!(
        plain(&run),
        "\
Read (0 inputs)
  nothing to check in calib.yaml

Skipped (format not supported): 12 .stl, 3 .png

Not evaluated: 4 with a missing input, most needed: URDF (3 checks); list with --verbose

0 errors, 0 warnings, 0 notes · 0 checks passed · 4 not evaluated · 1 of 1 input read
Nothing was checked: no rule could be evaluated on calib.yaml, for the reasons above. This is not a pass.
"
    );
    assert!(with(&run, true, false, Style::PLAIN).contains("  TF01 a-rule, clock: missing input: no recording\n"));

    std::sync::Arc::make_mut(&mut run.sources[0]).problem(
        ReadStatus::Unreadable,
        Place::whole(crate::source::SourceId(0)),
        "the file is empty",
    );
    assert_eq!(
        plain(&run),
        "calib.yaml: the file is empty. Nothing was checked; this is not a pass.\n"
    );
    let text = with(&run, true, false, Style::PLAIN);
    assert!(
        text.contains("Inputs with problems (1 input)\n  unreadable calib.yaml (yaml)\n    the file is empty\n"),
        "{text}"
    );
    assert!(
        text.ends_with("Nothing was checked: calib.yaml could not be read in full. This is not a pass.\n"),
        "{text}"
    );

    run.sources.clear();
    assert!(
        plain(&run)
            .contains("Nothing was checked: frames-lint does not support the format of any of the 15 files found")
    );
}

#[test]
fn an_unread_input_is_shown_with_its_line_and_makes_the_run_incomplete() {
    let mut run = everything();
    run.verdict.findings.clear();
    run.verdict.rows.retain(|row| row.outcome == Outcome::Pass);
    let text = plain(&run);
    assert!(text.contains(" 2 │ b: [\n"), "{text}");
    assert!(text.contains("    help: close it with `]`\n"), "{text}");
    assert!(text.ends_with("Incomplete: calib.yaml could not be read in full. 1 check passed.\n"));
}

#[test]
fn a_crash_is_ours_and_said() {
    let text = plain(&everything());
    assert!(text.contains("  A04 a-rule, x: index out of range\n"), "{text}");
    assert!(text.contains("1 check crashed (a bug in frames-lint)."), "{text}");
}

#[test]
fn long_reports_are_cut_but_no_rule_is_lost() {
    let mut s = Sample::default();
    let robot = s.source("robot.urdf", SourceKind::Urdf, ROBOT);
    let place = s.at(robot, "lidar_joint");
    for index in 0..1000 {
        s.finding(
            "TREE01",
            "orphan-subtree",
            Finding::error(format!("f{index}"), format!("e{index}"), place.clone()),
        );
    }
    s.finding("ZZ09", "last-rule", Finding::warning("x", "the only one", place));
    let run = s.run();
    let text = plain(&run);
    assert_eq!(text.matches("╭─[robot.urdf").count(), FULL + 1);
    assert_eq!(
        text.matches("robot.urdf:3:16: error[TREE01 orphan-subtree] e").count(),
        SHOWN - FULL
    );
    assert!(
        text.contains("\n... and 800 more of TREE01 orphan-subtree (show with --all)\n"),
        "{text}"
    );
    assert!(text.contains("warning[ZZ09 last-rule] the only one\n   ╭─"), "{text}");
    let all = with(&run, false, true, Style::PLAIN);
    assert!(all.contains("robot.urdf:3:16: error[TREE01 orphan-subtree] e999\n") && !all.contains("more of"));
}

#[test]
fn numbers_are_told_apart_from_their_limit() {
    let words = |value, limit| finding::measured_words(&Measured::new("x", value, "deg").limit(limit));
    assert_eq!(words(1.000_04, 1.0), "x = 1.00004 deg, limit 1 deg");
    assert_eq!(words(1.0, 1.0), "x = 1 deg, limit 1 deg");
    assert_eq!(words(f64::NAN, 1.0), "x = NaN deg, limit 1 deg");
    // What computing leaves of nothing is nothing, unless the limit is as small.
    assert_eq!(words(3.976e-16, 0.05), "x = 0 deg, limit 0.05 deg");
    assert_eq!(words(2.5e-8, 1e-8), "x = 2.5e-8 deg, limit 1e-8 deg");
    assert_eq!(words(1e-9, 0.0), "x = 1e-9 deg, limit 0 deg");
}

#[test]
fn what_a_file_says_cannot_steer_the_terminal() {
    let mut s = Sample::default();
    let yaml = s.source("a\u{1b}]0;x.yaml", SourceKind::Yaml, "k: \u{1b}[2J\n");
    let place = s.at(yaml, "k");
    let finding = Finding::error("x", "frame `\u{1b}[31m`\nsplit", place)
        .label("\u{7}")
        .help("\u{9b}2J");
    s.finding("X\u{1b}", "y", finding);
    s.run.skipped.insert("\u{1b}".into(), 1);
    s.row("A", "\u{1b}", Outcome::NotEvaluated, Some("\u{1b}"));
    let run = s.run();
    let text = with(&run, true, false, Style::PLAIN);
    assert!(!text.chars().any(|c| c.is_control() && c != '\n'), "{text:?}");
    assert!(text.contains("frame `\\u{1b}[31m` split"), "{text}");
}

#[test]
fn colour_and_width_are_only_for_terminals() {
    let style = Style {
        color: true,
        unicode: false,
        width: Some(72),
        links: false,
    };
    let run = everything();
    let text = with(&run, false, false, style);
    assert!(
        text.contains("\u{1b}[1;33mwarning[CONV02 quarter-turn]\u{1b}[0m"),
        "{text}"
    );
    assert!(text.is_ascii(), "{text}");
    assert!(!plain(&run).contains('\u{1b}'));
    // The same run gives the same bytes.
    assert_eq!(text, with(&run, false, false, style));
    // Codes are links to their pages; that makes no line longer.
    let linked = with(&run, false, false, Style { links: true, ..style });
    let link = format!(
        "[\u{1b}]8;;{}\u{1b}\\CONV02\u{1b}]8;;\u{1b}\\ quarter-turn]",
        crate::page::url("CONV02")
    );
    assert!(linked.contains(&link), "{linked}");
    assert_eq!(linked.lines().count(), text.lines().count());
}

#[test]
fn how_much_was_looked_at_is_part_of_the_verdict() {
    let judged = |passed: usize| {
        let mut s = Sample::default();
        s.source("car.urdf", SourceKind::Urdf, "");
        for index in 0..10 {
            let (outcome, reason) = match index {
                _ if index < passed => (Outcome::Pass, None),
                9 => (Outcome::NotEvaluated, Some("not applicable: nothing to check here")),
                _ => (Outcome::NotEvaluated, Some("missing input: no recording")),
            };
            s.row("TREE01", &format!("frame {index}"), outcome, reason);
        }
        plain(&s.run())
    };
    assert!(
        judged(8).contains("Clean: 8 of 9 applicable checks were evaluated on 1 input."),
        "{}",
        judged(8)
    );
    let few = judged(1);
    assert!(
        few.contains("Clean, but only 1 of 9 applicable checks could be evaluated on 1 input."),
        "{few}"
    );
}

#[test]
fn what_had_to_be_reached_is_enough_or_not() {
    let words = |value| finding::measured_words(&Measured::new("distance", value, "m").at_least(5.0));
    assert_eq!(words(51.5), "distance = 51.5 m (at least 5 m needed)");
    assert_eq!(words(2.0), "distance = 2 m, must be at least 5 m");
}
