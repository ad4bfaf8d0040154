//! Xacro through the real program: expanded as the `xacro` program does, with places in the macros, and within bounds whatever the file does.

#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::support::program::{check, check_all, run, run_with};
use crate::support::{corpus, left_out};

const HEAD: &str = "<robot name=\"r\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\">\n";

fn robot(inside: &str) -> String {
    format!("{HEAD}{inside}</robot>\n")
}

fn write(folder: &Path, name: &str, text: &str) {
    let path = folder.join(name);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, text).unwrap();
}

/// Two packages beside each other: a car, and the wheels that it includes.
fn workspace(parent: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for package in ["car", "parts"] {
        write(
            folder.path(),
            &format!("{package}/package.xml"),
            &format!("<package><name>{package}</name></package>"),
        );
    }
    let wheel = format!(
        "<xacro:property name=\"r\" value=\"0.3\"/>\n<xacro:macro name=\"wheel\" params=\"side y spin:=1 *at\">\n<link name=\"${{side}}_wheel\"/>\n\
         <joint name=\"${{side}}_joint\" type=\"continuous\">\n<parent link=\"{parent}\"/>\n<child link=\"${{side}}_wheel\"/>\n\
         <xacro:insert_block name=\"at\"/>\n<axis xyz=\"0 ${{spin}} 0\"/>\n</joint>\n</xacro:macro>\n"
    );
    write(folder.path(), "parts/urdf/wheel.xacro", &robot(&wheel));
    let car = "<xacro:arg name=\"mast\" default=\"true\"/>\n<xacro:include filename=\"$(find parts)/urdf/wheel.xacro\"/>\n\
               <xacro:include filename=\"mast.xacro\"/>\n<link name=\"chassis\"/>\n\
               <xacro:wheel side=\"left\" y=\"0.5\"><origin xyz=\"0 ${0.5 + r/2} ${r - r**2}\" rpy=\"0 ${pi/2} 0\"/></xacro:wheel>\n\
               <xacro:wheel side=\"right\" y=\"-0.5\" spin=\"-1\"><origin xyz=\"0 -0.65 0\" rpy=\"0 0 ${radians(180)}\"/></xacro:wheel>\n\
               <xacro:if value=\"$(arg mast)\"><xacro:mast n=\"3\"/></xacro:if>\n";
    write(folder.path(), "car/urdf/car.urdf.xacro", &robot(car));
    let mast = "<xacro:macro name=\"mast\" params=\"n\"><xacro:if value=\"${n > 0}\"><link name=\"mast_${n}\"/>\n\
                <joint name=\"mast_${n}_joint\" type=\"fixed\"><parent link=\"chassis\"/><child link=\"mast_${n}\"/>\
                <origin xyz=\"0 0 ${0.1*n}\"/></joint><xacro:mast n=\"${n-1}\"/></xacro:if></xacro:macro>\n";
    write(folder.path(), "car/urdf/mast.xacro", &robot(mast));
    folder
}

fn expanded(file: &Path, args: &[&str]) -> Result<String, String> {
    let arguments = ["expand-xacro", file.to_str().unwrap()];
    let ran = run(file.parent().unwrap(), arguments.iter().chain(args));
    if ran.code == 0 { Ok(ran.text()) } else { Err(ran.err) }
}

fn by_xacro(file: &Path) -> Option<String> {
    let ran = Command::new("xacro").arg(file).output().ok()?;
    ran.status.success().then(|| String::from_utf8(ran.stdout).unwrap())
}

/// Elements with their attributes, in order: numbers by value.
fn said(text: &str) -> Vec<String> {
    let document = roxmltree::Document::parse(text).unwrap();
    let word = |word: &str| {
        word.parse::<f64>()
            .map_or_else(|_| word.to_owned(), |number| format!("{number:.9e}"))
    };
    let value = |value: &str| value.split_whitespace().map(word).collect::<Vec<_>>().join(" ");
    let elements = document.descendants().filter(roxmltree::Node::is_element);
    elements
        .map(|node| {
            let mut attributes: Vec<String> = node
                .attributes()
                .map(|attribute| format!("{}={}", attribute.name(), value(attribute.value())))
                .collect();
            attributes.sort();
            format!("{} {}", node.tag_name().name(), attributes.join(" "))
        })
        .collect()
}

#[test]
fn includes_macros_conditions_and_arithmetic_need_no_program() {
    let folder = workspace("chassis");
    // Nothing is on the path.
    let ran = run_with(folder.path(), ["check", "--format", "json", "car"], &[("PATH", "")]);
    let report = ran.report();
    let inputs = report["inputs"].as_array().unwrap();
    let expanded = inputs
        .iter()
        .find(|input| input["taken"].to_string().contains("joint"))
        .unwrap();
    assert_eq!(expanded["status"], "read", "{report:#}");
    assert!(expanded["taken"].to_string().contains('5'), "{}", expanded["taken"]);
    assert!(report["inputs"].to_string().contains("wheel.xacro"), "{report:#}");
}

#[test]
fn a_finding_points_to_the_macro() {
    let folder = workspace("chasis");
    let report = check_all(folder.path(), &["car", "parts"], 1, &[]);
    let findings = report["findings"].as_array().unwrap();
    let places: Vec<&Value> = findings
        .iter()
        .filter(|finding| finding["message"].to_string().contains("chasis"))
        .flat_map(|finding| finding["places"].as_array().unwrap())
        .collect();
    let at_parent = |place: &&&Value| place["path"] == "parts/urdf/wheel.xacro" && place["line"] == 6;
    assert!(places.iter().any(|place| at_parent(&place)), "{places:#?}");
    let human = run(folder.path(), ["check", "car", "parts"]).text();
    assert!(human.contains("parts/urdf/wheel.xacro:6"), "{human}");
    assert!(human.contains("<parent link=\"chasis\"/>"), "{human}");
    let tree = run(folder.path(), ["tree", "car", "parts"]).text();
    // The origin is written at the call, in the other file.
    assert!(tree.contains("car.urdf.xacro:6"), "{tree}");
}

#[test]
fn a_fix_is_made_where_the_number_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let text = robot(
        "<xacro:macro name=\"imu\" params=\"name z\">\n<link name=\"${name}\"/>\n<joint name=\"${name}_joint\" type=\"fixed\">\n\
         <parent link=\"base_link\"/><child link=\"${name}\"/>\n<origin xyz=\"0.1 0 ${z}\" rpy=\"3.1416 0 -1.5708\"/>\n</joint>\n\
         </xacro:macro>\n<link name=\"base_link\"/>\n<xacro:imu name=\"imu\" z=\"0.2\"/>\n",
    );
    write(folder.path(), "car.urdf.xacro", &text);
    let ran = run(folder.path(), ["check", ".", "--fix"]);
    assert!(
        ran.err.contains("fixed 1 finding in 1 file"),
        "{}{}",
        ran.err,
        ran.text()
    );
    let fixed = fs::read_to_string(folder.path().join("car.urdf.xacro")).unwrap();
    let wanted = text.replace("3.1416 0 -1.5708", "3.141592653589793 0 -1.5707963267948966");
    assert_eq!(fixed, wanted);
}

#[test]
fn a_comment_in_a_macro_is_for_what_is_made_of_it() {
    let folder = workspace("chasis");
    let wheel = folder.path().join("parts/urdf/wheel.xacro");
    let comment = "<!-- frames-lint: allow TREE12 the chassis has another name here -->\n<joint";
    fs::write(&wheel, fs::read_to_string(&wheel).unwrap().replace("<joint", comment)).unwrap();
    // What follows from it is still an error.
    let report = check_all(folder.path(), &["car", "parts"], 1, &[]);
    let findings = report["findings"].as_array().unwrap();
    let missing = |finding: &&Value| finding["message"].to_string().contains("`chasis` of joint");
    let mut missing = findings.iter().filter(missing).peekable();
    assert!(missing.peek().is_some(), "{report:#}");
    assert!(missing.all(|finding| !finding["waived"].is_null()), "{report:#}");
    assert!(
        findings
            .iter()
            .all(|finding| !finding["rule"].to_string().contains("GATE")),
        "{report:#}"
    );
}

#[test]
fn of_packages_with_one_name_the_nearest_is_taken() {
    let folder = tempfile::tempdir().unwrap();
    // The parent of the second one's wheels is misspelt.
    for (name, parent) in [("a", "chassis"), ("b", "chasis"), ("c", "chassis")] {
        let there = workspace(parent);
        fs::rename(there.path(), folder.path().join(name)).unwrap();
    }
    for (name, code) in [("a", 0), ("b", 1), ("c", 0)] {
        assert_eq!(run(folder.path(), ["check", name]).code, code, "{name}");
    }
    let all = run(folder.path(), ["check", "--format", "json", "."]);
    let report: Value = serde_json::from_str(&all.text()).unwrap();
    let findings = report["findings"].as_array().unwrap();
    assert!(!findings.is_empty());
    for finding in findings {
        assert!(
            finding["places"][0]["path"].as_str().unwrap().contains("b/"),
            "{finding:#}"
        );
    }
}

#[test]
fn the_xacro_program_says_the_same() {
    let folder = workspace("chassis");
    let file = folder.path().join("car/urdf/car.urdf.xacro");
    let text = fs::read_to_string(&file).unwrap();
    let parts = folder.path().join("parts");
    fs::write(&file, text.replace("$(find parts)", parts.to_str().unwrap())).unwrap();
    let Some(other) = by_xacro(&file) else {
        return left_out("no xacro");
    };
    assert_eq!(said(&expanded(&file, &[]).unwrap()), said(&other));
    assert!(!expanded(&file, &["mast:=false"]).unwrap().contains("mast_1"));
    write(
        folder.path(),
        "car/urdf/seat.yaml",
        "seat: {x: 1.5, z: 2, yaw: !degrees 90}\n",
    );
    let seat = "<xacro:property name=\"at\" value=\"${xacro.load_yaml('seat.yaml')['seat']}\"/><link name=\"seat\"/>\
                <a xyz=\"${at['x']} 0 ${at['z']}\" yaw=\"${at['yaw']}\"/>";
    let seat_file = folder.path().join("car/urdf/seat.xacro");
    fs::write(&seat_file, robot(seat)).unwrap();
    assert_eq!(
        said(&expanded(&seat_file, &[]).unwrap()),
        said(&by_xacro(&seat_file).unwrap())
    );
    let mut compared = 0;
    let Some(corpus) = corpus() else { return };
    let mut folders: Vec<PathBuf> = vec![corpus.join("xacro")];
    while let Some(folder) = folders.pop() {
        for entry in folder.read_dir().into_iter().flatten().flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "xacro")
                && let Some(other) = by_xacro(&path)
                && let Ok(own) = expanded(&path, &[])
            {
                assert_eq!(said(&own), said(&other), "{}", path.display());
                compared += 1;
            }
        }
    }
    assert!(compared > 50, "{compared}");
}

#[test]
fn the_xacro_program_is_the_second_choice_and_has_places_too() {
    let folder = tempfile::tempdir().unwrap();
    let text = "<xacro:element xacro:name=\"link\" name=\"a\"/>\n<joint name=\"j\" type=\"fixed\">\n<parent link=\"a\"/>\n<child link=\"${'lost'}\"/>\n</joint>\n";
    write(folder.path(), "made.xacro", &robot(text));
    let without = run_with(folder.path(), ["check", "made.xacro"], &[("PATH", "")]);
    assert_eq!(without.code, 3);
    assert!(
        without
            .text()
            .contains("`<xacro:element>` is expanded by the `xacro` program only"),
        "{}",
        without.text()
    );
    if by_xacro(&folder.path().join("made.xacro")).is_none() {
        return left_out("no xacro");
    }
    let human = run(folder.path(), ["check", "made.xacro", "--xacro", "run"]).text();
    assert!(human.contains("made.xacro:5"), "{human}");
    assert!(human.contains("child `lost` of joint"), "{human}");
}

#[test]
fn what_cannot_be_expanded_is_said() {
    let folder = tempfile::tempdir().unwrap();
    write(
        folder.path(),
        "cycle.xacro",
        &robot("<link name=\"a\"/><xacro:include filename=\"other.xacro\"/>"),
    );
    write(
        folder.path(),
        "other.xacro",
        &robot("<link name=\"b\"/><xacro:include filename=\"cycle.xacro\"/>"),
    );
    let said = expanded(&folder.path().join("cycle.xacro"), &[]).unwrap_err();
    assert!(said.contains("Circular include"), "{said}");
    for (inside, word) in [
        ("<xacro:wheel/>", "unknown macro name: xacro:wheel"),
        ("<link name=\"${nothing}\"/>", "nothing"),
        ("<link name=\"$(arg side)\"/>", "Undefined substitution argument side"),
        (
            "<xacro:include filename=\"$(find no_such_parts)/a.xacro\"/>",
            "the package `no_such_parts`",
        ),
        (
            "<xacro:macro name=\"a\" params=\"\"><xacro:a/></xacro:macro><xacro:a/>",
            "the xacro was not expanded",
        ),
        ("<xacro:include filename=\"/dev/null\"/>", "the xacro was not expanded"),
    ] {
        check(
            "bad.xacro",
            robot(&format!("<link name=\"base_link\"/>{inside}")),
            3,
            &["the xacro was not expanded", word],
        );
    }
    for odd in ["-0.5**2", "i % 2", "None"] {
        write(
            folder.path(),
            "odd.xacro",
            &robot(&format!(
                "<xacro:property name=\"i\" value=\"3\"/><a x=\"${{{odd}}}\"/>"
            )),
        );
        let said = expanded(&folder.path().join("odd.xacro"), &[]).unwrap_err();
        assert!(said.contains("by the `xacro` program only"), "{said}");
    }
}

#[test]
fn macros_without_end_are_broken_off() {
    let doubled = (1..40).fold(
        "<xacro:macro name=\"m0\"><link name=\"a\"/></xacro:macro>".to_owned(),
        |text, level| {
            let call = format!("<xacro:m{}/>", level - 1);
            format!("{text}<xacro:macro name=\"m{level}\">{call}{call}</xacro:macro>")
        },
    );
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "laughs.xacro", &robot(&format!("{doubled}<xacro:m39/>")));
    let ran = run(folder.path(), ["check", "laughs.xacro"]);
    assert_eq!(ran.code, 3, "{}", ran.err);
    assert!(ran.text().contains("the xacro was not expanded"), "{}", ran.text());
}

/// A robot whose links are called after a secret: of a file elsewhere, of the environment.
fn spy(how: &str) -> String {
    robot(&format!("{how}\n<link name=\"base_link\"/>\n"))
}

#[test]
fn neither_the_environment_nor_files_elsewhere_reach_a_report() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "elsewhere/secret.yaml", "token: hunter2\n");
    write(
        folder.path(),
        "elsewhere/secret.xacro",
        &robot("<link name=\"hunter2\"/>"),
    );
    write(folder.path(), "elsewhere/broken.xacro", "hunter2 & <");
    let elsewhere = folder.path().join("elsewhere");
    let elsewhere = elsewhere.to_str().unwrap();
    let spies = [
        format!(
            "<xacro:property name=\"s\" value=\"${{load_yaml('{elsewhere}/secret.yaml')}}\"/><link name=\"${{s['token']}}\"/>"
        ),
        format!("<xacro:include filename=\"{elsewhere}/secret.xacro\"/><link name=\"${{1+1}}\"/>"),
        format!("<xacro:include filename=\"{elsewhere}/broken.xacro\"/><link name=\"${{1+1}}\"/>"),
        "<xacro:include filename=\"../elsewhere/secret.xacro\"/><link name=\"${1+1}\"/>".to_owned(),
        format!(
            "<xacro:property name=\"s\" value=\"${{load_yaml('{elsewhere}/secret.xacro')}}\"/><link name=\"${{s}}\"/>"
        ),
        "<link name=\"$(env SECRET)\"/>".to_owned(),
        "<link name=\"$(optenv SECRET none)\"/>".to_owned(),
    ];
    for (at, how) in spies.iter().enumerate() {
        let robot = folder.path().join(format!("robot{at}"));
        write(&robot, "spy.urdf.xacro", &spy(how));
        let secret = [("SECRET", "hunter2")];
        for arguments in [
            ["check", "--format", "json"],
            ["check", "--format", "human"],
            ["check", "--format", "html"],
        ] {
            let ran = run_with(&robot, arguments.iter().chain(&["."]), &secret);
            let said = ran.text() + &ran.err;
            assert!(!said.contains("hunter2"), "{how}: {said}");
        }
        // Where somebody stands gives a file no rights.
        let ran = run_with(folder.path(), ["check", &format!("robot{at}")], &secret);
        assert!(!ran.text().contains("hunter2"), "{how}: {}", ran.text());
        let ran = run_with(&robot, ["check", "."], &secret);
        // What is not there has its default; everything else is not expanded.
        if how.contains("optenv") {
            assert!(ran.text().contains("`none`"), "{}", ran.text());
        } else {
            assert!(
                ran.code == 3 && ran.text().contains("was not expanded"),
                "{how}: {}",
                ran.text()
            );
        }
    }
}

#[test]
fn what_lies_beside_in_the_same_repository_is_loaded() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join(".git")).unwrap();
    write(folder.path(), "config/names.yaml", "mast: tall_mast\n");
    let how =
        "<xacro:property name=\"s\" value=\"${load_yaml('../config/names.yaml')}\"/><link name=\"${s['mast']}\"/>";
    write(folder.path(), "robot/r.urdf.xacro", &robot(how));
    let ran = run(folder.path(), ["tree", "robot"]);
    if cfg!(target_os = "linux") && !ran.text().contains("may read any file here") {
        assert!(ran.text().contains("tall_mast"), "{}{}", ran.text(), ran.err);
    } else {
        left_out("this system holds no process to folders");
    }
}

/// A `xacro` program that says what it was asked, and leaves a child behind that writes later.
const PROGRAM: &str = "#!/bin/sh\necho '<robot name=\"made\"><link name=\"by_program\"/></robot>'\n";

fn program(folder: &Path, text: &str) {
    use std::os::unix::fs::PermissionsExt;
    write(folder, "xacro", text);
    fs::set_permissions(folder.join("xacro"), fs::Permissions::from_mode(0o755)).unwrap();
}

#[test]
fn the_program_is_run_only_where_the_user_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let (robot, bin) = (folder.path().join("robot"), folder.path().join("bin"));
    // An element that only the program expands.
    write(
        &robot,
        "r.urdf.xacro",
        &self::robot("<xacro:element xacro:name=\"link\" name=\"${1+1}\"/>"),
    );
    program(&bin, PROGRAM);
    program(&robot, PROGRAM);
    let path = format!("{}:/usr/bin:/bin", bin.display());
    let is_run = |arguments: &[&str], path: &str| {
        let ran = run_with(&robot, ["tree"].iter().chain(arguments), &[("PATH", path)]);
        ran.text().contains("by_program")
    };
    assert!(!is_run(&["."], &path), "not by itself");
    assert!(is_run(&[".", "--xacro", "run"], &path));
    // A folder of what is checked, by a relative path.
    assert!(!is_run(&[".", "--xacro", "run"], ".:/usr/bin:/bin"));
    assert!(!is_run(&[".", "--xacro", "run"], ":/usr/bin:/bin"));
    let checked = |config: &Path| {
        let arguments = ["check", ".", "--format", "json", "--config", config.to_str().unwrap()];
        let ran = run_with(&robot, arguments, &[("PATH", path.as_str())]);
        !ran.text().contains("was not expanded")
    };
    write(folder.path(), "gate.yaml", "xacro: run\n");
    write(&robot, "own.yaml", "xacro: run\n");
    let inside = run_with(
        &robot,
        ["check", ".", "--config", "own.yaml"],
        &[("PATH", path.as_str())],
    );
    assert!(inside.text().contains("`xacro` has no effect"), "{}", inside.text());
    assert!(checked(&folder.path().join("gate.yaml")) && !checked(&robot.join("own.yaml")));
    // A configuration beside a file that is named is of who wrote that file, a link in its folder as well.
    write(&robot, "frames-lint.yaml", "xacro: run\n");
    for asked in ["r.urdf.xacro", "./r.urdf.xacro", "."] {
        assert!(!is_run(&[asked], &path), "{asked}");
    }
    fs::remove_file(robot.join("frames-lint.yaml")).unwrap();
    std::os::unix::fs::symlink(folder.path().join("gate.yaml"), robot.join("frames-lint.yaml")).unwrap();
    assert!(!is_run(&["r.urdf.xacro"], &path));
}

#[test]
fn what_cannot_be_included_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let checked = folder.path().join("robot");
    write(folder.path(), "outside/part.xacro", &robot("<link name=\"outside\"/>"));
    write(&checked, "parts/wheel.xacro", &robot("<link name=\"wheel\"/>"));
    let run = |name: &str, inside: &str| {
        write(&checked, name, &robot(inside));
        run_with(&checked, ["check", name], &[]).text()
    };
    let outside = run(
        "a.urdf.xacro",
        "<link name=\"base_link\"/><xacro:include filename=\"../outside/*.xacro\"/>",
    );
    assert!(outside.contains("was not expanded"), "{outside}");
    let own = run(
        "b.urdf.xacro",
        "<link name=\"base_link\"/><xacro:include filename=\"b.urdf.xacro\"/>",
    );
    assert!(own.contains("Circular include"), "{own}");
    let inside = run("c.urdf.xacro", "<xacro:include filename=\"parts/*.xacro\"/>");
    assert!(inside.contains("(expanded): 1 link"), "{inside}");
}

#[test]
fn values_that_a_xacro_loads_are_judged_in_its_expansion() {
    let folder = tempfile::tempdir().unwrap();
    let mounts = "lidar: {x: 1.0, y: 0.1, z: 1.8, yaw: 2.0}\ncams:\n  - {name: front, yaw: 0.0}\n";
    write(folder.path(), "mounts.yaml", mounts);
    let alone = run_with(folder.path(), ["check", "."], &[]).text();
    assert!(alone.contains("in an unknown form"), "{alone}");
    write(
        folder.path(),
        "car.urdf.xacro",
        &robot(
            "<xacro:property name=\"m\" value=\"${load_yaml('mounts.yaml')}\"/><link name=\"base_link\"/><link name=\"lidar\"/>\
             <joint name=\"j\" type=\"fixed\"><parent link=\"base_link\"/><child link=\"lidar\"/>\
             <origin xyz=\"${m['lidar']['x']} 0.1 1.8\" rpy=\"0 0 0.02\"/></joint>",
        ),
    );
    let beside = run_with(folder.path(), ["check", "."], &[]).text();
    assert!(
        beside.contains("2 of 2 inputs read") && !beside.contains("not known"),
        "{beside}"
    );
}
