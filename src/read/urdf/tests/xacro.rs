//! Xacro that was not expanded.

use super::{read_text, read_xacro};
use crate::source::ReadStatus;
use crate::world::FrameRole;
use crate::world::robot::ConsumerOpinion;

const XACRO: &str = r#"<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:include filename="$(find p)/x.xacro"/>
  <link name="base_link"/>
  <link name="${prefix}_wheel"/>
  <xacro:macro name="mast" params="h *origin">
    <link name="mast"/>
    <joint name="mast_joint" type="fixed">
      <parent link="base_link"/><child link="mast"/><origin xyz="0 0 1.5"/>
    </joint>
    <joint name="head_joint" type="fixed">
      <parent link="mast"/><child link="head"/><origin xyz="0 0 ${h}" rpy="0 0 1.5"/>
    </joint>
    <joint name="eye_joint" type="fixed">
      <parent link="head"/><child link="eye"/><xacro:insert_block name="origin"/>
    </joint>
    <joint name="${name}_joint" type="fixed"><parent link="mast"/><child link="x"/></joint>
  </xacro:macro>
  <xacro:if value="$(arg gps)">
    <joint name="gps_joint" type="fixed"><parent link="mast"/><child link="gps"/><origin xyz="0 0 0.1"/></joint>
  </xacro:if>
  <gazebo reference="${prefix}_wheel"/>
</robot>
"#;

#[test]
fn what_is_written_out_is_read_and_the_rest_is_left() {
    let read = read_xacro(XACRO);
    assert!(read.is_clean(), "{:?}", read.source.problems);
    let robot = read.robot();
    assert_eq!(robot.fragment.as_deref(), Some("xacro, not expanded"));
    assert!(matches!(robot.consumer, ConsumerOpinion::NotAsked(_)));
    assert_eq!(read.frames(FrameRole::Link), ["base_link", "mast"]);
    assert_eq!(read.frames(FrameRole::JointChild), ["eye", "gps", "head", "mast"]);
    assert!(read.frames(FrameRole::Simulator).is_empty());
    let names: Vec<&str> = robot.joints.iter().map(|joint| joint.name.value.as_str()).collect();
    assert_eq!(
        names,
        ["mast_joint", "head_joint", "eye_joint", "gps_joint"],
        "in the order of the file"
    );
    assert!(robot.malformed.is_empty(), "an expression is no misspelling here");
    // Of the others the numbers, the inserted block or the condition are open.
    assert_eq!(read.claim().label, "mast_joint");
}

#[test]
fn a_urdf_that_is_xacro_in_truth_says_so() {
    for (text, word) in [
        (XACRO, "<xacro:include>"),
        (r#"<robot name="r"><link name="${a}_link"/></robot>"#, "${a}_link"),
        (
            r#"<robot name="r"><xacro:property name="h" value="1"/><link name="a"><visual><origin xyz="0 0 ${h}"/></visual></link></robot>"#,
            "0 0 ${h}",
        ),
    ] {
        let read = read_text(text);
        assert_eq!(read.source.status, ReadStatus::Partial, "{text}");
        assert!(
            read.source.problems[0].message.contains(word),
            "{}",
            read.source.problems[0].message
        );
        assert!(read.robot().fragment.is_some() && read.robot().malformed.is_empty());
    }
    // What xacro leaves behind in its output is no sign of it.
    let expanded = r#"<robot name="r" xmlns:xacro="x"><link name="a"><visual><xacro:grey/></visual></link></robot>"#;
    let read = read_text(expanded);
    assert!(read.is_clean() && read.robot().fragment.is_none());
}

#[test]
fn a_xacro_may_have_any_root() {
    let read = read_xacro("<root xmlns:xacro=\"x\"><xacro:macro name=\"m\"><link name=\"a\"/></xacro:macro></root>");
    assert!(read.is_clean(), "{:?}", read.source.problems);
    assert_eq!(read.frames(FrameRole::Link), ["a"]);
    let read = read_xacro(
        "<xacro:macro name=\"m\"><link name=\"a\"/></xacro:macro>\n<xacro:property name=\"x\" value=\"1\"/>",
    );
    assert!(read.is_clean());
    assert_eq!(read.at(&read.robot().links[0].name.place), "a");
}
