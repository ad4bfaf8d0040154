//! What a healthy robot becomes: facts, numbers, exact places.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Point3, Vector3};

use super::{joint_with, read_text, read_with};
use crate::read::urdf::MeshLookup;
use crate::source::{Confidence, Span};
use crate::world::robot::ConsumerOpinion;
use crate::world::{ClaimKind, FrameRole, Spelling};

const ROBOT: &str = r#"<?xml version="1.0"?>
<robot name="käfer" version="1.0">
  <!-- ümlauts before every place: spans count bytes -->
  <link name="base_link">
    <inertial><origin xyz="0 0 1"/><mass value="2.5"/><inertia ixx="1" ixy="0" ixz="0" iyy="2" iyz="0" izz="3"/></inertial>
    <visual><geometry><mesh filename="package://p/a.stl" scale="1 1 -1"/></geometry></visual>
  </link>
  <link name="lidar"/>
  <joint name="lidar_joint" type="revolute">
    <origin xyz="0.3 0 1.20" rpy="0 -0.0 1.57"/>
    <parent link="base_link"/>
    <child link="lidar"/>
    <axis xyz="0 0 1"/>
    <limit lower="-1.5" upper="2" effort="1" velocity="1"/>
    <mimic joint="other" multiplier="2"/>
  </joint>
  <transmission name="t"><joint name="lidar_joint"><hardwareInterface>x</hardwareInterface></joint></transmission>
  <gazebo reference="lidar"><sensor name="s" type="ray"><plugin><frameName> lidar_sim </frameName></plugin></sensor></gazebo>
  <gazebo reference="lidar_joint"><implicitSpringDamper>1</implicitSpringDamper></gazebo>
  <sensor name="cam" type="camera"><parent link="base_link"/></sensor>
</robot>
"#;

#[test]
fn names_and_numbers_have_the_bytes_they_were_written_with() {
    let read = read_text(ROBOT);
    assert!(read.is_clean(), "{:?}", read.source.problems);
    let robot = read.robot();
    assert_eq!(robot.name.value, "käfer");
    assert_eq!(read.at(&robot.name.place), "käfer");
    assert_eq!(robot.version.as_deref(), Some("1.0"));
    assert_eq!(read.at(&robot.links[1].name.place), "lidar");
    assert_eq!(read.at(&robot.links[0].place), "<link name=\"base_link\">");
    let joint = &robot.joints[0];
    assert_eq!(read.at(&joint.place), "<joint name=\"lidar_joint\" type=\"revolute\">");
    assert_eq!(read.at(&joint.kind.place), "revolute");
    assert_eq!(
        read.at(&joint.origins[0].place),
        "<origin xyz=\"0.3 0 1.20\" rpy=\"0 -0.0 1.57\"/>"
    );
    let claim = read.claim();
    assert_eq!(read.at(claim.target_place.as_ref().unwrap()), "base_link");
    assert_eq!(read.at(claim.source_place.as_ref().unwrap()), "lidar");
    assert_eq!(read.line(&claim.place), 10);
    for literal in claim.translation_literals.iter().chain(&claim.rotation_literals) {
        let Span { start, end } = literal.span;
        assert_eq!(&read.source.text[start..end], literal.text);
    }
    let texts = |literals: &[crate::world::Literal]| literals.iter().map(|l| l.text.clone()).collect::<Vec<_>>();
    assert_eq!(texts(&claim.translation_literals), ["0.3", "0", "1.20"]);
    assert_eq!(texts(&claim.rotation_literals), ["0", "-0.0", "1.57"]);
}

#[test]
fn everything_else_of_a_robot_is_kept() {
    let read = read_text(ROBOT);
    let robot = read.robot();
    let inertial = robot.links[0].inertial.as_ref().unwrap();
    assert_eq!(inertial.mass_kg, Some(2.5));
    assert_eq!(inertial.inertia, Some([1.0, 0.0, 0.0, 2.0, 0.0, 3.0]));
    let mesh = &robot.links[0].meshes[0];
    assert_eq!(
        (mesh.usage.as_str(), mesh.filename.value.as_str()),
        ("visual", "package://p/a.stl")
    );
    assert_eq!(mesh.scale.as_ref().unwrap().array(), Some([1.0, 1.0, -1.0]));
    assert_eq!(mesh.found, None);
    assert!(robot.links[0].has_geometry && !robot.links[1].has_geometry);
    let joint = &robot.joints[0];
    let limit = joint.limit.as_ref().unwrap();
    assert_eq!(limit.lower.as_ref().unwrap().value.to_bits(), (-1.5_f64).to_bits());
    assert_eq!(limit.upper.as_ref().unwrap().text, "2");
    assert_eq!(joint.mimic.as_ref().unwrap().value, "other");
    assert_eq!(joint.axis.as_ref().unwrap().array(), Some([0.0, 0.0, 1.0]));
    assert!(!joint.is_fixed());
    assert_eq!(robot.joints.len(), 1, "the joint of the transmission is none");
    assert_eq!(
        (robot.malformed.len(), robot.ignored.len(), robot.repeated.len()),
        (0, 0, 0)
    );
}

#[test]
fn frames_are_named_by_role() {
    let read = read_text(ROBOT);
    assert_eq!(read.frames(FrameRole::Link), ["base_link", "lidar"]);
    assert_eq!(read.frames(FrameRole::JointParent), ["base_link"]);
    assert_eq!(read.frames(FrameRole::JointChild), ["lidar"]);
    // `<gazebo reference="lidar_joint">` names a joint, which is no frame.
    assert_eq!(read.frames(FrameRole::Simulator), ["base_link", "lidar", "lidar_sim"]);
    let simulated = read
        .facts
        .frames
        .iter()
        .find(|used| used.frame.as_str() == "lidar_sim")
        .unwrap();
    assert_eq!(read.at(&simulated.place), "lidar_sim", "without the blanks around");
}

#[test]
fn a_joint_claims_parent_from_child_with_fixed_axes() {
    let read = read_text(&joint_with(r#"<origin xyz="1 2 3" rpy="0.1 -0.2 0.3"/>"#));
    let claim = read.claim();
    assert_eq!(claim.target().unwrap().as_str(), "base");
    assert_eq!(claim.source_frame().unwrap().as_str(), "arm");
    assert_eq!(claim.reading, Confidence::Certain);
    let kind = ClaimKind::Joint {
        joint: "j".to_owned(),
        fixed: true,
        has_origin: true,
    };
    assert_eq!(claim.kind, kind);
    let base_from_arm = claim.pose.unwrap().isometry();
    // The URDF specification's order, written out: about the fixed x, then y, then z of the parent.
    let turn = |p: Vector3<f64>, axis: usize, angle: f64| {
        let (s, c) = angle.sin_cos();
        match axis {
            0 => Vector3::new(p.x, c * p.y - s * p.z, s * p.y + c * p.z),
            1 => Vector3::new(c * p.x + s * p.z, p.y, c * p.z - s * p.x),
            _ => Vector3::new(c * p.x - s * p.y, s * p.x + c * p.y, p.z),
        }
    };
    let p_arm = Vector3::new(0.4, -0.5, 0.6);
    let p_base = turn(turn(turn(p_arm, 0, 0.1), 1, -0.2), 2, 0.3) + Vector3::new(1.0, 2.0, 3.0);
    assert!((base_from_arm * Point3::from(p_arm) - Point3::from(p_base)).norm() < 1e-12);
}

#[test]
fn what_is_not_written_is_zero() {
    let read = read_text(&joint_with(r#"<origin rpy="0 0 0.5"/>"#));
    let claim = read.claim();
    assert_eq!(claim.pose.unwrap().translation_m, [0.0; 3]);
    assert!(claim.translation_literals.is_empty());

    let read = read_text(&joint_with(""));
    let claim = read.claim();
    assert!(matches!(claim.kind, ClaimKind::Joint { has_origin: false, .. }));
    assert_eq!(claim.pose.unwrap().isometry(), nalgebra::Isometry3::identity());
    assert_eq!(read.at(&claim.place), "<joint name=\"j\" type=\"fixed\">");
}

#[test]
fn a_quaternion_is_kept_as_written_and_read_from_version_1_1_on() {
    let text = joint_with(r#"<origin quat_xyzw="0 0 2 2"/>"#).replace("\"r\"", "\"r\" version=\"1.1\"");
    let read = read_text(&text);
    let claim = read.claim();
    let Spelling::Quaternion { xyzw, order_known, .. } = claim.spelling else {
        panic!("a quaternion")
    };
    assert!(order_known && xyzw == [0.0, 0.0, 2.0, 2.0]);
    let yaw = claim.pose.unwrap().isometry().rotation.euler_angles().2;
    assert!((yaw - FRAC_PI_2).abs() < 1e-12);
    assert!(read.robot().ignored.is_empty());

    let both = r#"<origin rpy="0 0 1" quat_xyzw="0 0 0 1"/>"#;
    let read = read_text(&joint_with(both).replace("\"r\"", "\"r\" version=\"1.2\""));
    assert_eq!(read.claim().pose, None, "consumers refuse the pair");
    assert_eq!(read.robot().malformed.len(), 1);

    let read = read_text(&joint_with(both));
    assert!(matches!(read.claim().spelling, Spelling::Rpy { rpy, .. } if rpy == [0.0, 0.0, 1.0]));
    assert_eq!(
        read.robot().ignored[0].name.value,
        "quat_xyzw",
        "before 1.1 it is ignored"
    );
}

#[test]
fn the_first_of_two_origins_counts_and_both_are_kept() {
    let read = read_text(&joint_with(r#"<origin xyz="1 0 0"/><origin xyz="2 0 0"/>"#));
    assert_eq!(read.claim().pose.unwrap().translation_m, [1.0, 0.0, 0.0]);
    let repeated = &read.robot().repeated[0];
    assert_eq!(
        (repeated.element.as_str(), repeated.owner.as_str()),
        ("origin", "joint `j`")
    );
    assert_eq!(read.at(&repeated.places[1]), r#"<origin xyz="2 0 0"/>"#);
    assert_eq!(read.robot().joints[0].origins.len(), 2);
}

#[test]
fn missing_names_are_empty_at_the_start_tag() {
    let text = r#"<robot><link/><joint><parent link="a"/></joint></robot>"#;
    let read = read_text(text);
    let robot = read.robot();
    assert_eq!((robot.name.value.as_str(), read.at(&robot.name.place)), ("", "<robot>"));
    assert_eq!(read.at(&robot.links[0].name.place), "<link/>");
    assert_eq!(read.at(&robot.joints[0].kind.place), "<joint>");
    assert!(robot.joints[0].child.is_none() && read.facts.claims.is_empty());
}

#[test]
fn the_consumer_reads_the_same_numbers() {
    let read = read_text(&joint_with(r#"<origin xyz="1 2 3" rpy="0.1 -0.2 0.3"/>"#));
    let ConsumerOpinion::Loads(joints) = &read.robot().consumer else {
        panic!("{:?}", read.robot().consumer)
    };
    let [joint] = joints.as_slice() else {
        panic!("one joint")
    };
    assert_eq!((joint.parent.as_str(), joint.child.as_str()), ("base", "arm"));
    assert_eq!((joint.xyz, joint.rpy), ([1.0, 2.0, 3.0], [0.1, -0.2, 0.3]));

    let read = read_text(&joint_with(r#"<origin xyz="1 2"/>"#));
    assert!(matches!(&read.robot().consumer, ConsumerOpinion::Refuses(why) if why.contains("element count")));

    let looks = r#"<robot name="r"><link name="a"><visual><geometry><sphere radius="1"/><origin xyz="0 0 0"/></geometry>
        <material name="m"/><material name="m"/></visual></link></robot>"#;
    assert!(
        matches!(read_text(looks).robot().consumer, ConsumerOpinion::Loads(_)),
        "looks and foreign elements are not held against a file"
    );
}

#[test]
fn meshes_are_looked_for_where_they_can_be() {
    let folder = tempfile::tempdir().unwrap();
    let urdf = folder.path().join("my_robot/urdf");
    let meshes = folder.path().join("my_robot/meshes");
    std::fs::create_dir_all(&urdf).unwrap();
    std::fs::create_dir_all(&meshes).unwrap();
    std::fs::write(meshes.join("a.stl"), "solid").unwrap();
    let lookup = MeshLookup {
        base_dir: Some(urdf),
        packages: [("known".to_owned(), meshes.clone())].into(),
    };
    let absolute = format!("file://{}/a.stl", meshes.display());
    for (filename, found) in [
        ("package://my_robot/meshes/a.stl", Some(true)),
        ("package://my_robot/meshes/b.stl", Some(false)),
        ("model://known/a.stl", Some(true)),
        ("package://known/meshes/a.stl", Some(false)),
        ("package://elsewhere/a.stl", None),
        ("../meshes/a.stl", Some(true)),
        ("a.stl", Some(false)),
        (absolute.as_str(), Some(true)),
        ("file:///nowhere/a.stl", Some(false)),
        ("https://example.org/a.stl", None),
        ("$(find my_robot)/meshes/a.stl", None),
    ] {
        assert_eq!(lookup.found(filename), found, "{filename}");
    }
    assert_eq!(MeshLookup::default().found("a.stl"), None, "no folder to look in");
    let text = r#"<robot name="r"><link name="a"><collision><geometry><mesh filename="a.stl"/></geometry></collision></link></robot>"#;
    assert_eq!(read_with(text, &lookup).robot().links[0].meshes[0].found, Some(false));
}
