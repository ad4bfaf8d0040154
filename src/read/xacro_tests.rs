//! Tests of running the program: with programs that are everywhere, and with `xacro` where it is installed.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

use super::{ExpandOptions, Expansion, Output, around, expand, run};
use crate::read::at_hand::left_out;
use crate::source::{ReadStatus, Source, SourceId, SourceKind};

fn source(text: &str) -> Source {
    let mut source = Source::new(SourceId(0), "r.urdf.xacro", SourceKind::Xacro);
    source.text = text.to_owned();
    source
}

fn failed(stderr: &str) -> Expansion {
    Expansion::Failed {
        stderr: stderr.to_owned(),
        line: None,
    }
}

#[test]
fn a_program_that_is_not_there_is_not_installed() {
    let outcome = run(Command::new("no-such-program-as-this"), Duration::from_secs(5), 100);
    assert_eq!(outcome.err(), Some(Expansion::NotInstalled));
}

#[test]
fn time_and_output_are_bounded() {
    let mut sleep = Command::new("sleep");
    sleep.arg("30");
    let started = std::time::Instant::now();
    assert_eq!(
        run(sleep, Duration::from_millis(200), 100).err(),
        Some(Expansion::TimedOut)
    );
    assert!(started.elapsed() < Duration::from_secs(20));
    assert_eq!(
        run(Command::new("yes"), Duration::from_secs(20), 1000).err(),
        Some(Expansion::TooLarge)
    );
}

#[test]
fn output_and_success_come_back() {
    let mut echo = Command::new("echo");
    echo.arg("$HOME");
    let Output { success, stdout, .. } = run(echo, Duration::from_secs(20), 100).unwrap();
    assert!(success);
    assert_eq!(stdout, b"$HOME\n", "no shell looked at it");
}

#[test]
fn only_arguments_reach_the_program() {
    for odd in ["-o", "--version", "-o:=x", "prefix"] {
        let means = ExpandOptions {
            args: vec![odd.to_owned()],
            ..ExpandOptions::default()
        };
        let error = expand(Path::new("r.xacro"), &means, &BTreeMap::new()).unwrap_err();
        assert!(matches!(error, Expansion::Failed { stderr, .. } if stderr.contains(odd)));
    }
}

#[test]
fn a_missing_package_is_named_at_its_place() {
    let text =
        "<robot name=\"r\">\n<xacro:include filename=\"$(find my_parts)/a.xacro\"/><x a=\"$(find other)\"/></robot>";
    let mut source = source(text);
    failed("error: substitution args not supported:  No module named 'ament_index_python'").report(&mut source);
    let problem = &source.problems[0];
    assert!(
        problem.message.contains("the packages `my_parts`, `other`"),
        "{}",
        problem.message
    );
    assert!(problem.help.as_ref().unwrap().contains("--xacro-arg"));
    let span = problem.place.span().unwrap();
    assert_eq!(&text[span.start..span.end], "$(find my_parts)");
    assert_eq!(source.status, ReadStatus::Partial);
}

#[test]
fn an_undefined_argument_is_asked_for() {
    let mut source = source("<robot/>");
    failed("error: Undefined substitution argument sim_mode\nwhen processing file: r.xacro").report(&mut source);
    let problem = &source.problems[0];
    assert!(
        problem
            .message
            .contains("Undefined substitution argument sim_mode (in r.xacro)")
    );
    assert_eq!(problem.help.as_deref(), Some("pass --xacro-arg sim_mode:=<value>"));
}

fn by_xacro(args: &[&str]) -> ExpandOptions {
    ExpandOptions {
        run: true,
        args: args.iter().map(|arg| (*arg).to_owned()).collect(),
        ..ExpandOptions::default()
    }
}

#[test]
fn packages_of_the_input_around_the_file_and_beside_it_are_at_hand() {
    let folder = tempfile::tempdir().unwrap();
    for (package, name) in [("arm", "arm_description"), ("gripper", "gripper")] {
        let package = folder.path().join(package);
        std::fs::create_dir_all(package.join("urdf")).unwrap();
        std::fs::write(
            package.join("package.xml"),
            format!("<package><name>{name}</name></package>"),
        )
        .unwrap();
    }
    let given = BTreeMap::from([("gripper".to_owned(), folder.path().join("elsewhere"))]);
    let found = around(&folder.path().join("arm/urdf/arm.xacro"), &given);
    assert_eq!(found.keys().collect::<Vec<_>>(), ["arm", "arm_description", "gripper"]);
    assert_eq!(found["arm_description"], folder.path().join("arm"));
    assert_eq!(
        found["gripper"],
        folder.path().join("gripper"),
        "the nearest comes first"
    );
}

#[test]
fn xacro_expands_where_it_is_installed() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    let head =
        "<robot name=\"r\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\">\n<xacro:arg name=\"x\" default=\"a\"/>\n";
    let good = write(
        "good.xacro",
        &format!("{head}<link name=\"$(arg x)_${{1+1}}\"/>\n</robot>"),
    );
    let expanded = match expand(&good, &by_xacro(&["x:=b"]), &BTreeMap::new()) {
        Err(Expansion::NotInstalled) => return left_out("no xacro"),
        expanded => expanded.unwrap().text,
    };
    assert!(expanded.contains("<link name=\"b_2\"/>"), "{expanded}");
    let bad = write("bad.xacro", &format!("{head}<link name=\"a>\n</robot>"));
    let error = expand(&bad, &by_xacro(&[]), &BTreeMap::new()).unwrap_err();
    assert!(matches!(error, Expansion::Failed { line: Some(4), .. }), "{error:?}");
}
