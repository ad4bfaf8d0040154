//! Where the program runs: the hook, the action and the job that come with it do, with the real program, what they say; `init` and `--watch`.

#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::panic)]

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::mpsc::channel;
use std::time::Duration;

use serde_json::Value;

use crate::support;
use crate::support::program::run;

const GOOD: &str = "<robot name=\"r\">\n  <link name=\"base_link\"/>\n  <link name=\"lidar\"/>\n  <joint name=\"j\" type=\"fixed\"><parent link=\"base_link\"/><child link=\"lidar\"/><origin xyz=\"1 0 1\" rpy=\"0 0 0.3\"/></joint>\n</robot>\n";

fn bad() -> String {
    GOOD.replace("child link=\"lidar\"", "child link=\"Lidar\"")
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn yaml(file: &str) -> Value {
    serde_yaml::from_str(&fs::read_to_string(root().join(file)).unwrap()).unwrap()
}

/// The search path with the program of this test in front.
fn search_path() -> String {
    let folder = PathBuf::from(env!("CARGO_BIN_EXE_frames-lint"))
        .parent()
        .unwrap()
        .to_path_buf();
    format!("{}:{}", folder.display(), std::env::var("PATH").unwrap_or_default())
}

/// Runs a script in a folder as a runner does, and gives the exit code and what was printed.
fn shell(script: &str, folder: &Path, environment: &[(&str, &str)]) -> (i32, String) {
    let ran = Command::new("bash")
        .args(["--noprofile", "--norc", "-eo", "pipefail", "-c", script])
        .current_dir(folder)
        .env("PATH", search_path())
        .env_remove("GITHUB_STEP_SUMMARY")
        .envs(environment.iter().copied())
        .output()
        .unwrap();
    let text = [ran.stdout, ran.stderr].concat();
    (ran.status.code().unwrap(), String::from_utf8(text).unwrap())
}

fn folder(robot: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("a robot")).unwrap();
    fs::write(folder.path().join("a robot/r.urdf"), robot).unwrap();
    folder
}

#[test]
fn the_hooks_run_as_the_hook_runner_runs_them() {
    let hooks = yaml("packaging/pre-commit/.pre-commit-hooks.yaml");
    let hooks = hooks.as_array().unwrap();
    assert_eq!(hooks.len(), 2);
    for hook in hooks {
        // The keys that the runner asks for, and none that it does not know.
        let keys: Vec<&str> = hook.as_object().unwrap().keys().map(String::as_str).collect();
        for key in &keys {
            assert!(
                [
                    "id",
                    "name",
                    "description",
                    "entry",
                    "args",
                    "language",
                    "pass_filenames",
                    "files"
                ]
                .contains(key),
                "{key}"
            );
        }
        assert_eq!(
            (hook["language"].as_str(), hook["pass_filenames"].as_bool()),
            (Some("python"), Some(false))
        );
        let files = regex(hook["files"].as_str().unwrap());
        for name in ["a/b.urdf", "c.xacro", "calib.yaml", "calib.yml", "x.launch.py"] {
            assert!(files(name), "{name}");
        }
        assert!(!files("main.cpp") && !files("urdf"));
        let entry = hook["entry"].as_str().unwrap();
        let arguments: Vec<&str> = hook["args"]
            .as_array()
            .unwrap()
            .iter()
            .map(|one| one.as_str().unwrap())
            .collect();
        let script = format!("{entry} {}", arguments.join(" "));
        assert_eq!(shell(&script, folder(GOOD).path(), &[]).0, 0, "{script}");
        let broken = folder(&bad());
        let (code, text) = shell(&script, broken.path(), &[]);
        if entry.ends_with("--fix") {
            assert_eq!(
                fs::read_to_string(broken.path().join("a robot/r.urdf")).unwrap(),
                GOOD,
                "{text}"
            );
        } else {
            assert!(code == 1 && text.contains("a robot/r.urdf:4:"), "{code} {text}");
        }
    }
}

#[test]
fn every_package_has_the_version_of_the_program() {
    let version = env!("CARGO_PKG_VERSION");
    for (file, line) in [
        ("packaging/conda/recipe.yaml", format!("  version: \"{version}\"")),
        (
            "packaging/pre-commit/pyproject.toml",
            format!("version = \"{version}\""),
        ),
        (
            "packaging/pre-commit/pyproject.toml",
            format!("dependencies = [\"frames-lint=={version}\"]"),
        ),
        (
            "packaging/ros/ament_frames_lint/package.xml",
            format!("  <version>{version}</version>"),
        ),
        (
            "packaging/ros/ament_frames_lint/setup.py",
            format!("    version='{version}',"),
        ),
        (
            "packaging/ros/ament_cmake_frames_lint/package.xml",
            format!("  <version>{version}</version>"),
        ),
    ] {
        let text = fs::read_to_string(root().join(file)).unwrap();
        assert!(text.lines().any(|one| one == line), "{file} has no line `{line}`");
    }
}

/// Whether the end of a name is one of those in `\.(a|b?c)$`.
fn regex(pattern: &str) -> impl Fn(&str) -> bool + use<> {
    let endings = pattern
        .strip_prefix("\\.(")
        .and_then(|rest| rest.strip_suffix(")$"))
        .unwrap();
    let endings: Vec<String> = endings
        .split('|')
        .flat_map(|ending| match ending.split_once('?') {
            // The letter before the question mark may be missing.
            Some((before, after)) => vec![
                format!("{before}{after}"),
                format!("{}{after}", &before[..before.len() - 1]),
            ],
            None => vec![ending.to_owned()],
        })
        .map(|ending| format!(".{}", ending.replace("\\.", ".")))
        .collect();
    move |name| endings.iter().any(|ending| name.ends_with(ending.as_str()))
}

#[test]
fn the_action_annotates_and_reports_and_ends_with_the_programs_code() {
    let action = yaml("action.yml");
    assert_eq!(action["runs"]["using"], "composite");
    let steps = action["runs"]["steps"].as_array().unwrap();
    // Inputs come through the environment: none is pasted into a script.
    for step in steps {
        assert_eq!(step["shell"], "bash");
        assert!(!step["run"].as_str().unwrap().contains("${{"));
    }
    let check = steps.iter().find(|step| step["id"] == "check").unwrap();
    let install = steps[0]["run"].as_str().unwrap();
    assert_eq!(
        shell(
            install,
            root(),
            &[("FRAMES_LINT_PACKAGE", "no-such-package"), ("RUNNER_TEMP", "/nowhere")]
        )
        .0,
        0,
        "the program is found"
    );
    let inputs = action["inputs"].as_object().unwrap();
    let default = |name: &str| inputs[name]["default"].as_str().unwrap().to_owned();
    for (robot, paths, code) in [
        (GOOD.to_owned(), "a robot", 0),
        (bad(), "a robot\n", 1),
        (bad(), "nothing-there", 3),
    ] {
        let folder = folder(&robot);
        let (output, summary) = (folder.path().join("output"), folder.path().join("summary"));
        // Every input that a variable stands for is one, at its default.
        let mut environment: Vec<(String, String)> = Vec::new();
        for (variable, value) in check["env"].as_object().unwrap() {
            let name = value
                .as_str()
                .unwrap()
                .trim_start_matches("${{ inputs.")
                .trim_end_matches(" }}");
            environment.push((
                variable.clone(),
                if name == "paths" {
                    paths.to_owned()
                } else {
                    default(name)
                },
            ));
        }
        environment.push(("GITHUB_OUTPUT".to_owned(), output.display().to_string()));
        environment.push(("GITHUB_STEP_SUMMARY".to_owned(), summary.display().to_string()));
        let environment: Vec<(&str, &str)> = environment
            .iter()
            .map(|(key, value)| (key.as_str(), value.as_str()))
            .collect();
        let (ended, text) = shell(check["run"].as_str().unwrap(), folder.path(), &environment);
        assert_eq!(ended, code, "{text}");
        assert_eq!(fs::read_to_string(&output).unwrap(), format!("exit-code={code}\n"));
        assert!(fs::read_to_string(&summary).unwrap().starts_with("## :"));
        assert_eq!(text.contains("::error file=a robot/r.urdf,line=4"), code == 1, "{text}");
        let sarif: Value =
            serde_json::from_str(&fs::read_to_string(folder.path().join("frames-lint.sarif")).unwrap()).unwrap();
        assert_eq!(sarif["runs"][0]["invocations"][0]["exitCode"], code);
    }
}

#[test]
fn the_job_of_gitlab_leaves_its_two_reports() {
    let job = yaml("ci/gitlab.yml");
    let job = &job[".frames-lint"];
    let variables: Vec<(&str, &str)> = job["variables"]
        .as_object()
        .unwrap()
        .iter()
        .map(|(key, value)| (key.as_str(), value.as_str().unwrap()))
        .collect();
    let script: Vec<&str> = job["script"]
        .as_array()
        .unwrap()
        .iter()
        .map(|line| line.as_str().unwrap())
        .collect();
    let reports = job["artifacts"]["reports"].as_object().unwrap();
    for (robot, code) in [(GOOD.to_owned(), 0), (bad(), 1)] {
        let folder = folder(&robot);
        let (ended, text) = shell(&script.join("\n"), folder.path(), &variables);
        assert_eq!(ended, code, "{text}");
        for report in reports.values() {
            assert!(folder.path().join(report.as_str().unwrap()).is_file(), "{report}");
        }
    }
}

#[test]
fn a_configuration_to_begin_with_holds_for_the_files_it_was_made_from() {
    let recipe = "duration_s: 20\ndrive: {vehicle: car, motion: turning, seed: 3}\ntopics:\n  \
                  - {topic: /imu, from_drive: imu, rate_hz: 50, frame_id: base_link}\n";
    let folder = folder(GOOD);
    support::write(recipe, &folder.path().join("a robot/drive.mcap"));
    let before = run(folder.path(), ["check", "a robot"]);
    let made = run(folder.path(), ["init", "a robot"]);
    assert_eq!(made.code, 0, "{}", made.err);
    let text = fs::read_to_string(folder.path().join("a robot/frames-lint.yaml")).unwrap();
    assert!(
        text.contains("base_link <- lidar") && text.contains("joint j, r.urdf:4:"),
        "{text}"
    );
    assert!(
        text.contains("- {topic: /imu, world: ENU, body: FLU}   # sensor_msgs/msg/Imu"),
        "{text}"
    );
    assert!(text.contains("  - AXES02"), "{text}");
    let after = run(folder.path(), ["check", "--fail-on", "error", "a robot"]);
    assert_eq!(after.code, before.code, "{}", after.text());
    // Without the recording the gate says what is missing.
    fs::remove_file(folder.path().join("a robot/drive.mcap")).unwrap();
    let lacking = run(folder.path(), ["check", "--fail-on", "error", "a robot"]);
    assert!(
        lacking.code == 3 && lacking.text().contains("AXES02 imu-units"),
        "{}",
        lacking.text()
    );
    let again = run(folder.path(), ["init", "a robot"]);
    assert!(again.code == 2 && again.err.contains("--force"), "{}", again.err);
    assert_eq!(run(folder.path(), ["init", "--force", "a robot"]).code, 0);
    let shown = run(folder.path(), ["init", "-o", "-", "a robot"]);
    assert!(shown.text().starts_with("# frames-lint.yaml"));
}

#[test]
fn watching_checks_again_when_a_file_changes() {
    let folder = folder(GOOD);
    let mut child = Command::new(env!("CARGO_BIN_EXE_frames-lint"))
        .args(["check", "--watch", "--format", "concise", "."])
        .current_dir(folder.path())
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let (sender, lines) = channel();
    let out = child.stdout.take().unwrap();
    std::thread::spawn(move || {
        for line in BufReader::new(out).lines().map_while(Result::ok) {
            if sender.send(line).is_err() {
                return;
            }
        }
    });
    // A change before the watching begins is missed: it is made again until it is seen.
    let until = |words: &str, change: &dyn Fn()| {
        let mut seen = Vec::new();
        for _ in 0..60 {
            change();
            while let Ok(line) = lines.recv_timeout(Duration::from_secs(1)) {
                let is_it = line.starts_with(words);
                seen.push(line);
                if is_it {
                    return;
                }
            }
        }
        panic!("`{words}` does not come: {seen:#?}");
    };
    let robot = folder.path().join("a robot/r.urdf");
    until("Clean", &|| {});
    until("Not clean:", &|| fs::write(&robot, bad()).unwrap());
    until("Clean", &|| fs::write(&robot, GOOD).unwrap());
    child.kill().unwrap();
    child.wait().unwrap();
}
