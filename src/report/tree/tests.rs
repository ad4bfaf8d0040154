//! Drawings of small worlds.

use super::super::Style;
use super::super::samples::{ROBOT, Sample, message, pose};
use super::{chain, dot, layout, mermaid, sketch, svg, text};
use crate::run::Run;
use crate::source::{Place, SourceKind};
use crate::world::bag::TfSample;
use crate::world::{ClaimKind, FrameRole, Pose};

fn draw(run: &Run) -> String {
    text::render(run, Style::PLAIN)
}

#[test]
fn a_urdf_alone() {
    let mut s = Sample::default();
    let urdf = s.source("robot.urdf", SourceKind::Urdf, ROBOT);
    s.joint(urdf, "lidar_joint", "base_link", "lidar", pose([0.3, 0.0, 1.2], 90.0));
    s.joint(urdf, "top", "lidar", "lidar_top", Pose::IDENTITY);
    s.joint(urdf, "wheel", "/base_link", "wheel", pose([0.0, -0.5, 0.1], 0.0));
    assert_eq!(
        draw(&s.run()),
        "\
base_link
├─ lidar  xyz 0.3 0 1.2 m, rpy 0 0 90 deg
│      robot.urdf:3 joint lidar_joint (fixed)
│  └─ lidar_top  identity
│         robot.urdf joint top (fixed)
└─ wheel  xyz 0 -0.5 0.1 m, rpy 0 0 0 deg (at zero)
       robot.urdf joint wheel (moving)
"
    );
}

#[test]
fn sources_that_differ_are_marked() {
    let mut s = Sample::default();
    let urdf = s.source("robot.urdf", SourceKind::Urdf, ROBOT);
    let bag = s.source("drive.mcap", SourceKind::Mcap, "");
    let calib = s.source("calib.yaml", SourceKind::Yaml, "lidar_from_base: x\n");
    s.joint(urdf, "lidar_joint", "base_link", "lidar", pose([0.3, 0.0, 1.2], 90.0));
    s.tf(bag, "/tf_static", ("base_link", "lidar"), 1, pose([0.3, 0.1, 1.2], 0.0));
    s.tf(bag, "/tf", ("odom", "base_link"), 500, Pose::IDENTITY);
    // The same pose, stated the other way round.
    let inverse = Pose::from_isometry(&pose([0.3, 0.0, 1.2], 90.0).isometry().inverse());
    s.joint(calib, "lidar_from_base", "lidar", "base_link", inverse);
    s.joint(calib, "free", "cam0", "cam1", Pose::IDENTITY);
    for claim in s.world.claims.iter_mut().skip(1) {
        claim.kind = ClaimKind::File {
            dialect: "generic".into(),
            roles: false,
        };
    }
    let run = s.run();
    assert_eq!(
        draw(&run),
        "\
odom
└─ base_link  identity (first sample)
       drive.mcap /tf 50 Hz ×500
   └─ lidar  xyz 0.3 0 1.2 m, rpy 0 0 90 deg
          robot.urdf:3 joint lidar_joint (fixed)
          drive.mcap /tf_static ×1  ! differs by 90 deg, 0.1 m: xyz 0.3 0.1 1.2 m, rpy 0 0 0 deg
          calib.yaml:1 lidar_from_base (calibration)

Transforms stated by files, not edges of the tree
  `cam0` from `cam1`  calib.yaml free
"
    );
    let dot = dot::render(&run);
    assert!(dot.contains("w0f0 -> w0f1 [label=\"robot.urdf:3 joint lidar_joint (fixed)\\ndrive.mcap /tf_static x1 (differs by 90 deg, 0.1 m)\\n"), "{dot}");
    assert!(dot.contains("color=red") && dot.contains("style=dashed"), "{dot}");
    let mermaid = mermaid::render(&run);
    assert!(
        mermaid.contains("w0f2 -.->|\"drive.mcap /tf 50 Hz x500\"| w0f0"),
        "{mermaid}"
    );
    assert!(
        mermaid.contains("<br/>! drive.mcap /tf_static x1 (differs"),
        "{mermaid}"
    );
}

#[test]
fn a_fixed_joint_that_is_repeated_on_tf_is_compared() {
    let mut s = Sample::default();
    let urdf = s.source("robot.urdf", SourceKind::Urdf, ROBOT);
    let bag = s.source("drive.mcap", SourceKind::Mcap, "");
    s.joint(urdf, "lidar_joint", "base_link", "lidar", Pose::IDENTITY);
    s.tf(bag, "/tf", ("base_link", "lidar"), 50, pose([1.0, 0.0, 0.0], 0.0));
    let tf = &mut s.world.bags[0].tf[0];
    let still: TfSample = tf.samples[0].clone();
    tf.extreme = Some((still.clone(), 0.0, 0.0));
    let mut moving = s.run.clone();
    let mut world = s.world.clone();
    world.bags[0].tf[0].extreme = Some((still, 0.5, 0.0));
    moving.worlds.push(world);
    assert!(draw(&s.run()).contains("differs by 0 deg, 1 m"));
    assert!(!draw(&moving).contains("differs"));
}

#[test]
fn cycles_and_orphans_are_shown_once_and_end() {
    let mut s = Sample::default();
    let bag = s.source("a.mcap", SourceKind::Mcap, "");
    for edge in [("a", "b"), ("b", "a"), ("b", "c"), ("r", "c"), ("c", "d"), ("x", "x")] {
        s.tf(bag, "/tf_static", edge, 1, Pose::IDENTITY);
    }
    s.named("alone", FrameRole::Link, Place::whole(bag));
    s.named("gps", FrameRole::Header, Place::message(bag, message("/fix", 0)));
    s.named("/d", FrameRole::Header, Place::message(bag, message("/scan", 0)));
    s.named("", FrameRole::Header, Place::message(bag, message("/scan", 0)));
    s.named("cam", FrameRole::Calibration, Place::whole(bag));
    assert_eq!(
        draw(&s.run()),
        "\
Tree 1 of 3, 5 frames
r
└─ c  identity  [! also under `b`]
       a.mcap /tf_static ×1
   └─ d  identity
          a.mcap /tf_static ×1
! no root: the parents form a cycle: a → b → a
a
└─ b  identity
       a.mcap /tf_static ×1
   ├─ a  identity  [! cycle: leads back to itself]
   │      a.mcap /tf_static ×1
   └─ c  identity  [children shown above; ! also under `r`]
          a.mcap /tf_static ×1

Tree 2 of 3, 1 frame
alone

Tree 3 of 3, 1 frame
x
└─ x  identity  [! cycle: leads back to itself]
       a.mcap /tf_static ×1

Frames of messages, not in the tree
  (empty name)  a.mcap /scan (message header)
  gps  a.mcap /fix (message header)

Frames of files, not in the tree
  cam  a.mcap (named in a file)
"
    );
}

#[test]
fn a_chain_of_thousands_stays_small() {
    let mut s = Sample::default();
    let urdf = s.source("robot.urdf", SourceKind::Urdf, ROBOT);
    for index in 0..20_000 {
        let (parent, child) = (format!("f{index:05}"), format!("f{:05}", index + 1));
        s.joint(urdf, "joint", &parent, &child, Pose::IDENTITY);
    }
    let text = draw(&s.run());
    assert!(text.contains("(depth 20000) f20000"));
    assert!(text.len() < 20_000 * 300, "{} bytes", text.len());
}

#[test]
fn names_cannot_break_the_drawings() {
    let mut s = Sample::default();
    let urdf = s.source("robot.urdf", SourceKind::Urdf, ROBOT);
    s.joint(urdf, "joint", "a\"]; b", "<c>#\\\u{1b}", Pose::IDENTITY);
    let run = s.run();
    let dot = dot::render(&run);
    assert!(
        dot.contains("[label=\"a\\\"]; b\"]") && dot.contains("[label=\"<c>#\\\\\\\\u{1b}\"]"),
        "{dot}"
    );
    let mermaid = mermaid::render(&run);
    assert!(
        mermaid.contains("[\"a#quot;]; b\"]") && mermaid.contains("[\"#lt;c#gt;#35;\\\\u{1b}\"]"),
        "{mermaid}"
    );
    assert!(!draw(&run).contains('\u{1b}'));
    assert_eq!(draw(&Run::default()), "No frames: the inputs contain none.\n");
}

#[test]
fn a_common_folder_is_said_once() {
    let mut s = Sample::default();
    let urdf = s.source("ws/cart/robot.urdf", SourceKind::Urdf, ROBOT);
    s.source("ws/cart/calib/a.yaml", SourceKind::Yaml, "");
    s.source("ws/carts.yaml", SourceKind::Yaml, "");
    s.joint(urdf, "lidar_joint", "base", "lidar", Pose::IDENTITY);
    let mut run = s.run();
    assert_eq!(
        draw(&run),
        "cart/calib/a.yaml, cart/robot.urdf, carts.yaml\n\nbase\n└─ lidar  identity\n       cart/robot.urdf:3 joint lidar_joint (fixed)\n\nPaths in ws/\n"
    );
    run.worlds.push(run.worlds[0].clone());
    assert!(draw(&run).starts_with("Platform cart/calib/a.yaml, cart/robot.urdf, carts.yaml\n\nbase\n"));
    assert_eq!(draw(&run).matches("\n\nPlatform").count(), 1);
}

/// Frames below several parents, on a cycle, alone, and outside of every tree.
fn tangle() -> Run {
    let mut s = Sample::default();
    let bag = s.source("a.mcap", SourceKind::Mcap, "");
    for edge in [
        ("a", "b"),
        ("b", "a"),
        ("b", "c"),
        ("r", "c"),
        ("c", "d"),
        ("r", "e"),
        ("r", "f"),
        ("x", "x"),
    ] {
        s.tf(bag, "/tf_static", edge, 1, Pose::IDENTITY);
    }
    s.named("alone", FrameRole::Link, Place::whole(bag));
    s.named(
        "<gps> & \u{1b}\u{ffff}",
        FrameRole::Header,
        Place::message(bag, message("/fix", 0)),
    );
    s.run()
}

#[test]
fn a_drawing_shows_every_frame_and_every_edge_once() {
    let run = tangle();
    let sketches = sketch::sketches(&run);
    let trees = layout::trees(&sketches[0]);
    let mut frames: Vec<usize> = trees
        .iter()
        .flat_map(|tree| &tree.frames)
        .map(|position| position.frame)
        .collect();
    frames.sort_unstable();
    assert_eq!(frames, (0..sketches[0].frames.len()).collect::<Vec<_>>());
    let drawn = trees
        .iter()
        .flat_map(|tree| tree.frames.iter().filter_map(|position| position.edge));
    let mut edges: Vec<usize> = drawn.chain(trees.iter().flat_map(|tree| tree.others.clone())).collect();
    edges.sort_unstable();
    assert_eq!(edges, (0..sketches[0].edges.len()).collect::<Vec<_>>());
    for tree in &trees {
        for (place, position) in tree.frames.iter().enumerate() {
            assert!(position.half_row + 2 <= tree.half_rows);
            // Boxes of one column do not overlap, and a child is right of its parent.
            let clash = |other: &layout::FramePosition| {
                other.depth == position.depth && other.half_row.abs_diff(position.half_row) < 2
            };
            assert!(!tree.frames[..place].iter().any(clash), "{}", position.frame);
            assert!(
                position
                    .parent
                    .is_none_or(|parent| tree.frames[parent].depth + 1 == position.depth)
            );
        }
    }
    let drawing = svg::render(&run);
    let document = roxmltree::Document::parse(&drawing).unwrap();
    let named = |name: &str| {
        document
            .descendants()
            .filter(|node| node.is_text() && node.text() == Some(name))
            .count()
    };
    assert_eq!((named("alone"), named("<gps> & \\u{1b}\u{fffd}")), (2, 1), "{drawing}");
    let paths = document.descendants().filter(|node| node.has_tag_name("path")).count();
    assert_eq!(paths, 8 + 4, "edges and the legend");
    assert!(drawing.contains("prefers-color-scheme: dark") && !drawing.contains("href"));
}

#[test]
fn a_drawing_of_thousands_ends() {
    let mut s = Sample::default();
    let urdf = s.source("robot.urdf", SourceKind::Urdf, ROBOT);
    for index in 0..20_000 {
        let (parent, child) = (format!("f{index:05}"), format!("f{:05}", index + 1));
        s.joint(urdf, "joint", &parent, &child, Pose::IDENTITY);
    }
    let drawing = svg::render(&s.run());
    assert!(
        drawing.contains("f20000") && drawing.len() < 20_000 * 900,
        "{}",
        drawing.len()
    );
    assert!(svg::render(&Run::default()).contains("No frames"));
}

#[test]
fn the_chain_that_is_shown_is_the_product_of_its_factors() {
    let mut s = Sample::default();
    let urdf = s.source("robot.urdf", SourceKind::Urdf, ROBOT);
    s.joint(urdf, "one", "base_link", "mast", pose([1.0, 2.0, 0.0], 90.0));
    s.joint(urdf, "two", "mast", "lidar", pose([0.0, 0.0, 1.0], 45.0));
    s.joint(urdf, "wheel", "base_link", "wheel", pose([0.0, -0.5, 0.0], 0.0));
    let text = chain::render(&s.run(), "wheel", "lidar", None, Style::PLAIN).unwrap();
    assert_eq!(
        text,
        "\
wheel_from_lidar = wheel_from_base_link * base_link_from_mast * mast_from_lidar at any time
  wheel_from_base_link  xyz 0 0.5 0 m, rpy 0 0 0 deg  robot.urdf joint wheel (at zero), static, inverted
  base_link_from_mast   xyz 1 2 0 m, rpy 0 0 90 deg   robot.urdf joint one (fixed), static
  mast_from_lidar       xyz 0 0 1 m, rpy 0 0 45 deg   robot.urdf joint two (fixed), static
  wheel_from_lidar      xyz 1 2.5 1 m, rpy 0 0 135 deg
"
    );
    let none = chain::render(&Run::default(), "a", "b", None, Style::PLAIN);
    assert!(none.unwrap_err().starts_with("LookupException"));
}
