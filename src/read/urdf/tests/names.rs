//! Ignored and repeated names.

use super::{joint_with, read_text};

#[test]
fn misspelt_attributes_and_elements_are_ignored_with_what_was_meant() {
    for (inside, meant) in [
        (r#"<origin xyz="0 0 0" ryp="0 0 1"/>"#, "ryp>rpy"),
        (r#"<origin xyz="0 0 0" rpi="0 0 1"/>"#, "rpi>rpy"),
        (r#"<origin XYZ="0 0 0" rpy="0 0 1"/>"#, "XYZ>xyz"),
        (r#"<origin xyz="0 0 0" orientation="0 0 1"/>"#, "orientation>rpy"),
        (r#"<orgin xyz="0 0 1"/>"#, "orgin>origin"),
        (r#"<Origin xyz="0 0 1"/>"#, "Origin>origin"),
        (r#"<axis xzy="0 0 1"/>"#, "xzy>xyz"),
        (r#"<limits lower="0" upper="1"/>"#, "limits>limit"),
        (r#"<limit lower="0" uper="1"/>"#, "uper>upper"),
        (r#"<mimic joints="k"/>"#, "joints>joint"),
    ] {
        let read = read_text(&joint_with(inside));
        assert_eq!(read.meant(), [meant], "{inside}");
        let written = meant.split('>').next().unwrap();
        assert_eq!(read.at(&read.robot().ignored[0].name.place), written);
    }
    let read = read_text(r#"<robot name="r"><Link name="a"/><jiont name="j"/></robot>"#);
    assert_eq!(read.meant(), ["Link>link", "jiont>joint"]);
}

#[test]
fn names_of_other_tools_are_kept_but_nothing_is_meant_by_them() {
    for inside in [
        r#"<axis xyz="0 0 1" rpy="0 0 0"/>"#,
        r#"<limit lower="0" upper="1" effort="1" velocity="1" k_velocity="2" drake:acceleration="1"/>"#,
        r#"<joint_properties damping="1"/>"#,
        r#"<origin xyz="0 0 0" rpy="0 0 0" rpyy="0"/>"#,
    ] {
        let read = read_text(&joint_with(inside));
        assert!(!read.robot().ignored.is_empty(), "{inside}");
        assert!(read.meant().is_empty(), "{inside}: {:?}", read.meant());
    }
    // The lower triangle next to the upper one does no harm.
    let inertia = r#"<inertia ixx="1" ixy="0" ixz="0" iyx="0" iyy="1" iyz="0" izx="0" izy="0" izz="1"/>"#;
    let text = format!("<robot name=\"r\"><link name=\"a\"><inertial>{inertia}</inertial></link></robot>");
    let read = read_text(&text);
    assert_eq!(read.robot().ignored.len(), 3);
    assert!(read.meant().is_empty());
    let read = read_text(&text.replace("ixy=\"0\" ", ""));
    assert_eq!(read.meant(), ["iyx>ixy"], "now the right name is missing");
}

#[test]
fn foreign_elements_at_the_top_are_left_alone() {
    let text =
        r#"<robot name="r"><link name="a"/><frame name="f" link="a"/><cable name="c"/><loop_joint name="l"/></robot>"#;
    assert!(read_text(text).robot().ignored.is_empty());
}

#[test]
fn repeated_elements_are_kept_with_all_places() {
    let read = read_text(&joint_with(
        r#"<axis xyz="0 0 1"/><parent link="arm"/><axis xyz="1 0 0"/>"#,
    ));
    let repeated: Vec<_> = read
        .robot()
        .repeated
        .iter()
        .map(|r| (r.element.as_str(), r.places.len()))
        .collect();
    assert_eq!(repeated, [("parent", 2), ("axis", 2)]);
    assert_eq!(
        read.robot().joints[0].parent.as_ref().unwrap().value,
        "base",
        "a consumer reads the first"
    );
    let text = r#"<robot name="r"><link name="a"><visual/><visual/><inertial/><inertial/></link></robot>"#;
    let read = read_text(text);
    assert_eq!(read.robot().repeated.len(), 1, "visuals may be many");
    assert_eq!(read.robot().repeated[0].owner, "link `a`");
}
