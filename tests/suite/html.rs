//! The acceptance report as people meet it: made by the real program, read by a parser that others wrote, and opened in a real
//! browser without a network.

#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::string_slice)]

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::{Value, json};

use crate::support;
use crate::support::browser::Browser;
use crate::support::page::Page;
use crate::support::program::{self, CallResult};

/// A name that would be markup, script and an attribute's end where it is not escaped.
const HOSTILE: &str = r#"</code></title></script><script>alert(1)</script><img src=x onerror="alert(2)">'"&amp;"#;

/// A drive with a compass for a yaw and mirrored odometry.
const DRIVE: &str = "
duration_s: 120
drive: {vehicle: car, motion: turning, seed: 5}
topics:
  - {topic: /imu, from_drive: imu, rate_hz: 5, frame_id: base_link, errors: [compass_yaw]}
  - {topic: /fix, from_drive: fix, rate_hz: 5, frame_id: gps}
  - {topic: /odom, from_drive: odometry, rate_hz: 20, frame_id: odom, child_frame_id: base_link, errors: [swap_xy]}
";

/// Clouds of two lidars, one in the other frame than it says and late, over a ground that is where it should be.
const CLOUDS: &str = "
duration_s: 6
drive: {vehicle: car, motion: turning, seed: 3}
topics:
  - {topic: /tf_static, transforms: [{parent: base_footprint, child: velodyne, xyz: [0, 0, 1.8]}]}
  - {topic: /points, from_drive: lidar, rate_hz: 2, frame_id: velodyne, xyz: [0, 0, 1.8], lidar: {beams: 24, columns: 180, driver: velodyne}}
  - {topic: /ouster/points, from_drive: lidar, rate_hz: 5, frame_id: os_sensor, xyz: [0, 0, 1.8], stamp_offset_s: -0.4, lidar: {beams: 8, columns: 128, driver: ouster, turned_deg: 180}}
";

/// A folder with two recordings, a robot whose names are hostile, a waiver, a requirement that is not met, and a broken file.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    support::write(DRIVE, &folder.path().join("drive.mcap"));
    support::write(CLOUDS, &folder.path().join("clouds.mcap"));
    let name = HOSTILE
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;");
    write(
        "<b>robot & co.urdf",
        &format!(
            r#"<robot name="r">
  <link name="base_footprint"/>
  <link name="{name}"/>
  <link name="cam"/>
  <joint name="hostile" type="fixed">
    <parent link="base_footprint"/>
    <child link="{name}"/>
    <origin xyz="1 0 1" rpy="0 0 1.57"/>
  </joint>
  <!-- frames-lint: allow ROT09 drawn so <i>by hand</i> -->
  <joint name="cam_joint" type="fixed">
    <parent link="base_footprint"/>
    <child link="cam"/>
    <origin xyz="1 0 1" rpy="0 0 1.57"/>
  </joint>
</robot>
"#
        ),
    );
    write("broken.json", "{\"a\": [1, 2");
    write("frames-lint.yaml", "require: [CAMERA02]\n");
    folder
}

/// The day of the run, 2027-01-15.
const DAY: (&str, &str) = ("SOURCE_DATE_EPOCH", "1800000000");

/// The report of a folder, and what the program said.
fn report(folder: &Path, environment: &[(&str, &str)]) -> (PathBuf, CallResult) {
    let out = folder.join("out");
    fs::create_dir_all(&out).unwrap();
    fs::write(out.join(".ignore"), "*\n").unwrap();
    let ran = program::run_with(folder, ["check", ".", "--output", "html=out/report.html"], environment);
    (out.join("report.html"), ran)
}

#[test]
fn a_page_of_a_whole_drive_is_html_without_a_fault_and_says_everything() {
    let folder = folder();
    let (path, ran) = report(folder.path(), &[DAY]);
    assert_eq!(ran.code, 1, "{}{}", ran.err, ran.text());
    let text = fs::read_to_string(&path).unwrap();
    let document = Page::parse(&text);
    assert!(document.errors.is_empty(), "{:?}", document.errors);
    let all = |selector: &str| document.texts(selector);
    assert_eq!(all("h1").len(), 1);
    assert!(
        all("header .ending")[0].starts_with("Not clean: "),
        "{:?}",
        all("header")
    );
    // Each of the five plots, where it belongs.
    let rules: Vec<String> = all("figure figcaption a");
    for rule in ["AXES04", "AXES07", "AXES09", "SENSOR01", "TIME02"] {
        assert!(rules.iter().any(|shown| shown == rule), "{rule} is not among {rules:?}");
    }
    assert!(all(".finding figure figcaption a").contains(&"AXES07".to_owned()));
    assert!(!all("#plots figure").is_empty());
    // Findings have their numbers, places and what to do; the waiver its reason; the requirement what to record.
    assert!(
        all(".finding .message")
            .iter()
            .any(|message| message.contains("is the mirror image of the GNSS track"))
    );
    assert!(all(".snippet mark").iter().any(|mark| mark.contains("1.57")));
    assert!(all("#waived .accepted")[0].contains("drawn so <i>by hand</i>"));
    assert!(
        all("#required td").iter().any(|cell| cell.contains("CameraInfo")),
        "{:?}",
        all("#required td")
    );
    assert!(
        all("#inputs .problem")
            .iter()
            .any(|problem| problem.contains("broken.json"))
    );
    assert!(
        all("#made dd")
            .iter()
            .any(|fact| fact == "frames-lint check . --output html=out/report.html")
    );
    // The hash is that of the file.
    let said = Command::new("sha256sum")
        .arg(folder.path().join("drive.mcap"))
        .output()
        .unwrap();
    let digest = String::from_utf8(said.stdout).unwrap()[..64].to_owned();
    assert!(all("#inputs .hash code").contains(&digest));
    // What is signed stands on the first page, with the day, the hash of the configuration and how much was looked at.
    let facts = all("header .facts dd").join("|");
    let config = Command::new("sha256sum")
        .arg(folder.path().join("frames-lint.yaml"))
        .output()
        .unwrap();
    assert!(facts.starts_with("2027-01-15 (UTC)|robot r|"), "{facts}");
    assert!(
        facts.contains(std::str::from_utf8(&config.stdout[..64]).unwrap()),
        "{facts}"
    );
    assert!(
        facts.contains(" messages (") && facts.contains(" applicable ("),
        "{facts}"
    );
    // Hostile names are words; no element came of them, and nothing is loaded from anywhere.
    assert!(all("main").iter().any(|main| main.contains(HOSTILE)));
    for none in [
        "img",
        "b",
        "i",
        "iframe",
        "link",
        "object",
        "[onerror]",
        "[style]",
        "[src]",
        "a[href^=http]",
    ] {
        assert!(all(none).is_empty(), "{none}: {:?}", all(none));
    }
    assert_eq!(all("script").len(), 1);
    // Links lead somewhere.
    for link in document.attributes("a", "href") {
        let target = link.strip_prefix('#').unwrap();
        assert_eq!(
            document.attributes(&format!("[id={target}]"), "id").len(),
            1,
            "{target}"
        );
    }
}

#[test]
fn the_same_run_of_the_same_day_makes_the_same_bytes() {
    let folder = folder();
    let make = |environment: &[(&str, &str)]| {
        let (path, _) = report(folder.path(), environment);
        let text = fs::read_to_string(&path).unwrap();
        fs::remove_file(path).unwrap();
        text
    };
    let first = make(&[DAY]);
    for threads in ["1", "7"] {
        assert!(
            first == make(&[DAY, ("RAYON_NUM_THREADS", threads)]),
            "{threads} threads"
        );
    }
    let next = make(&[("SOURCE_DATE_EPOCH", "1800086400")]);
    assert_eq!(first.replace("2027-01-15", "2027-01-16"), next);
}

#[test]
fn each_file_of_a_recording_has_its_own_hash() {
    let folder = tempfile::tempdir().unwrap();
    let bag = folder.path().join("bag");
    let recipe = "
duration_s: 2
topics:
  - {topic: /tf_static, transforms: [{parent: base_link, child: imu, xyz: [0, 0, 1]}]}
";
    fs::create_dir(&bag).unwrap();
    support::write(recipe, &bag.join("bag_0.mcap"));
    let metadata = "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: mcap\n  relative_file_paths:\n    - bag_0.mcap\n";
    fs::write(bag.join("metadata.yaml"), metadata).unwrap();
    let (path, ran) = report(folder.path(), &[DAY]);
    program::is_sound(&ran, "a folder");
    let document = Page::parse(&fs::read_to_string(path).unwrap());
    let files = ["metadata.yaml", "bag_0.mcap"];
    assert_eq!(document.texts("#inputs .files dt"), files);
    for (name, hash) in files.iter().zip(document.texts("#inputs .files dd")) {
        let said = Command::new("sha256sum").arg(bag.join(name)).output().unwrap();
        assert_eq!(hash.as_bytes(), &said.stdout[..64], "{name}");
    }
}

/// Boxes of what a selector finds.
fn boxes(selector: &str) -> String {
    format!(
        "[...document.querySelectorAll({selector:?})].map(e => {{ const r = e.getBoundingClientRect(); return [r.width, r.height]; }})"
    )
}

/// Texts that cannot be read well: contrast beneath 4.5 against what lies behind them (WCAG 2.1, 1.4.3).
const PALE: &str = r"(() => {
  const parse = c => { const m = c.match(/[\d.]+/g).map(Number); return m.length > 3 ? m : [...m, 1]; };
  const light = ([r, g, b]) => { const f = v => (v /= 255) <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
    return 0.2126 * f(r) + 0.7152 * f(g) + 0.0722 * f(b); };
  const behind = e => { for (; e; e = e.parentElement) { const c = parse(getComputedStyle(e).backgroundColor); if (c[3] > 0) return c; }
    return parse('rgb(255, 255, 255)'); };
  const pale = [];
  for (const e of document.body.querySelectorAll('*')) {
    const own = [...e.childNodes].some(n => n.nodeType === 3 && n.data.trim());
    if (!own || e.closest('script, .skip') || !e.getClientRects().length || e.matches('title, desc')) continue;
    const style = getComputedStyle(e);
    const ink = parse(e instanceof SVGElement ? style.fill : style.color);
    const [a, b] = [light(ink), light(behind(e))].sort((x, y) => y - x);
    const contrast = (a + 0.05) / (b + 0.05);
    if (contrast < 4.5) pale.push(`${e.className.baseVal ?? e.className} ${e.tagName} ${contrast.toFixed(2)} ${e.textContent.slice(0, 40)}`);
  }
  return [...new Set(pale)].slice(0, 20);
})()";

/// What reaches out of the window, but for what scrolls by itself.
const TOO_WIDE: &str = "[...document.querySelectorAll('body *')].filter(e => !e.closest('.wide, pre, .skip, thead') \
                        && e.getBoundingClientRect().right > innerWidth + 0.5).map(e => e.outerHTML.slice(0, 150))";

#[test]
fn a_real_browser_shows_the_page_and_complains_of_nothing() {
    let Some(mut browser) = Browser::start() else { return };
    let folder = folder();
    let (path, _) = report(folder.path(), &[]);
    let mut page = browser.open(&path);
    page.width(1280);
    assert_eq!(page.complaints(), Vec::<String>::new());
    // Every drawing has a size, and something in it.
    let drawings = page.eval(&boxes("svg[role=img]"));
    let drawings = drawings.as_array().unwrap();
    assert!(drawings.len() >= 6, "{drawings:?}");
    for size in drawings {
        assert!(
            size[0].as_f64().unwrap() > 100.0 && size[1].as_f64().unwrap() > 50.0,
            "{size}"
        );
    }
    let lines = page.eval(&boxes("svg[role=img] .l0, svg[role=img] .l1"));
    assert!(
        lines
            .as_array()
            .unwrap()
            .iter()
            .any(|size| size[0].as_f64().unwrap() > 100.0),
        "{lines}"
    );
    // What is said is seen.
    let seen = page.eval("document.body.innerText");
    let seen = seen.as_str().unwrap();
    assert!(seen.contains("Not clean: ") && seen.contains("is the mirror image of the GNSS track"));
    assert!(seen.contains(HOSTILE), "a hostile name is text");
    // The choice of what is shown works by the style, and the search by the script.
    let visible =
        "[...document.querySelectorAll('tr.item')].filter(e => e.getClientRects().length).map(e => e.className)";
    let all = page.eval(visible).as_array().unwrap().len();
    page.eval("document.getElementById('show-fail').click()");
    let failed = page.eval(visible);
    let failed: Vec<&Value> = failed.as_array().unwrap().iter().collect();
    assert!(!failed.is_empty() && failed.len() < all, "{} of {all}", failed.len());
    assert!(
        failed.iter().all(|class| class.as_str().unwrap().contains("fail")),
        "{failed:?}"
    );
    page.eval("document.getElementById('show-all').click()");
    let search =
        "(s => { s.value = 'AXES07'; s.dispatchEvent(new Event('input')); })(document.getElementById('search'))";
    page.eval(search);
    let left = page.eval(visible).as_array().unwrap().len();
    assert!((1..5).contains(&left), "{left}");
    // On paper all of it stands, whatever was chosen.
    page.media("print", "dark");
    assert_eq!(page.eval(visible).as_array().unwrap().len(), all);
    for scheme in ["light", "dark"] {
        page.media("screen", scheme);
        assert_eq!(page.eval(PALE), json!([]), "{scheme}");
        let paper = page.eval("getComputedStyle(document.body).backgroundColor");
        assert_eq!(paper == "rgb(255, 255, 255)", scheme == "light");
    }
    page.media("print", "dark");
    assert_eq!(page.eval(PALE), json!([]), "paper is light");
    assert_eq!(
        page.eval("getComputedStyle(document.body).backgroundColor"),
        "rgb(255, 255, 255)"
    );
    // A narrow window scrolls one way only.
    page.media("screen", "light");
    for width in [390, 768, 1280] {
        page.width(width);
        assert_eq!(page.eval(TOO_WIDE), json!([]), "{width}");
        let hidden = page.eval("document.documentElement.scrollWidth - document.documentElement.clientWidth");
        assert_eq!(hidden, 0, "{width}");
    }
    assert_eq!(page.complaints(), Vec::<String>::new());
}

#[test]
fn the_browser_would_complain() {
    let Some(mut browser) = Browser::start() else { return };
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("a.urdf"),
        "<robot name=\"r\"><link name=\"a\"/></robot>",
    )
    .unwrap();
    let (path, _) = report(folder.path(), &[]);
    let sound = fs::read_to_string(&path).unwrap();
    assert_eq!(browser.open(&path).complaints(), Vec::<String>::new());
    let mut complaints = |name: &str, text: String| {
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        browser.open(&path).complaints().join("\n")
    };
    // The policy refuses what is not ours.
    for foreign in [
        "<script>document.title = 'x'</script>",
        "<p onclick=\"x()\" style=\"color: red\">x</p>",
        "<img src=\"http://127.0.0.1:9/x.png\">",
        "<img src=x onerror=\"alert(1)\">",
    ] {
        let said = complaints("refused.html", sound.replace("</main>", &format!("{foreign}</main>")));
        assert!(said.contains("Content Security Policy"), "{foreign}: {said}");
    }
    // Faults of a script are told.
    for (script, words) in [
        ("nothing.at.all()", "ReferenceError"),
        ("console.error('so what')", "so what"),
    ] {
        let said = complaints(
            "fault.html",
            format!("<!DOCTYPE html><title>x</title><script>{script}</script>"),
        );
        assert!(said.contains(words), "{script}: {said}");
    }
}

#[test]
fn tens_of_thousands_of_findings_make_a_page_that_can_be_opened() {
    let folder = tempfile::tempdir().unwrap();
    let mut joints = String::new();
    for i in 0..11_000 {
        let _ = writeln!(
            joints,
            "<link name=\"l {i}\"/><joint name=\"j{i}\" type=\"fixed\"><parent link=\"b\"/><child link=\"l {i}\"/>\
             <origin rpy=\"0 0 1.57x\"/></joint>"
        );
    }
    let robot = format!("<robot name=\"r\"><link name=\"b\"/>{joints}</robot>");
    fs::write(folder.path().join("a.urdf"), robot).unwrap();
    let (path, ran) = report(folder.path(), &[]);
    program::is_sound(&ran, "many findings");
    let text = fs::read_to_string(&path).unwrap();
    assert!(text.len() < 4_000_000, "{} bytes", text.len());
    assert!(text.contains(" not shown here: "));
    assert!(Page::parse(&text).errors.is_empty());
}

#[test]
fn a_deep_tree_fits_the_page() {
    let folder = tempfile::tempdir().unwrap();
    let mut robot = "<robot name=\"arm\"><link name=\"base_link\"/>".to_owned();
    let mut parent = "base_link".to_owned();
    for index in 0..20 {
        let _ = write!(
            robot,
            "<link name=\"link_{index}\"/><joint name=\"joint_{index}\" type=\"fixed\"><parent link=\"{parent}\"/>\
             <child link=\"link_{index}\"/><origin xyz=\"0.123 0.456 0.789\" rpy=\"0 0 1.5707963\"/></joint>"
        );
        parent = format!("link_{index}");
    }
    fs::write(folder.path().join("arm.urdf"), robot + "</robot>").unwrap();
    let (path, _) = report(folder.path(), &[DAY]);
    let document = Page::parse(&fs::read_to_string(path).unwrap());
    let numbers = |selector: &str, name: &str| -> Vec<u32> {
        let values = document.attributes(selector, name).into_iter();
        values.map(|value| value.parse().unwrap()).collect()
    };
    let width = numbers("svg.tree", "width")[0];
    // It goes on from sheet to sheet, and no box is cut.
    let views = document.attributes("svg.tree", "viewBox");
    let views: Vec<Vec<u32>> = views
        .iter()
        .map(|view| view.split(' ').map(|n| n.parse().unwrap()).collect())
        .collect();
    assert!(views.len() > 1 && views.iter().all(|view| view[3] <= 880), "{views:?}");
    assert!(
        views.windows(2).all(|pair| pair[0][1] + pair[0][3] == pair[1][1]),
        "{views:?}"
    );
    let tops = numbers(".tree .box", "y");
    let is_cut = |at: u32| tops.iter().any(|top| (*top..=top + 50).contains(&at));
    assert!(!views.iter().skip(1).any(|view| is_cut(view[1])), "{views:?}");
    // The style of a copy is known by what is copied, and not by what stands around it.
    assert_eq!(document.attributes("#tree-drawing.frames .box", "y").len(), tops.len());
    assert!(!document.texts("style")[0].contains(".tree ."));
    assert!(width <= 1000, "{width} pixels wide");
    let (lefts, widths) = (numbers(".tree .box", "x"), numbers(".tree .box", "width"));
    assert_eq!(lefts.len(), 21);
    assert!(lefts.iter().zip(&widths).all(|(left, own)| left + own < width));
    // Each has a row of its own, right of its parent.
    assert!(tops.windows(2).all(|pair| pair[0] + 50 < pair[1]) && lefts.windows(2).all(|pair| pair[0] < pair[1]));
}
