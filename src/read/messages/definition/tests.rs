//! Definitions put together, and compared with what is published.

use std::fmt::Write;

use super::*;
use crate::read::messages::Wire;

fn link(name: &str, schema: &str, encoding: &str) -> Schema {
    match TypeDefinition::read(name, schema.as_bytes(), encoding) {
        TypeDefinition::Types(types) => Schema::link(name, Some(&types), &Definitions::builtin()).unwrap(),
        other => panic!("{other:?}"),
    }
}

fn kinds(schema: &Schema) -> Vec<(&str, &Kind, Count)> {
    let fields = &schema.root().unwrap().fields;
    fields
        .iter()
        .map(|field| (field.name.as_str(), &field.kind, field.count))
        .collect()
}

const RULE: &str = "================================================================================";

#[test]
fn times_and_headers_are_recognised_in_both_generations() {
    let ros2 = link(
        "acme/msg/A",
        "std_msgs/Header header\nbuiltin_interfaces/Time[2] t\n",
        "ros2msg",
    );
    let expected = [
        ("header", &Kind::Header { has_seq: false }, Count::One),
        ("t", &Kind::Time, Count::Fixed(2)),
    ];
    assert_eq!(kinds(&ros2), expected);
    let text =
        format!("Header header\ntime t\n{RULE}\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n");
    let ros1 = link("acme/A", &text, "ros1msg");
    let expected = [
        ("header", &Kind::Header { has_seq: true }, Count::One),
        ("t", &Kind::Time, Count::One),
    ];
    assert_eq!(kinds(&ros1), expected);
}

#[test]
fn a_header_that_is_something_else_is_no_header() {
    for other in [
        "int64 t\nstring frame_id\n",
        "builtin_interfaces/Time stamp\nstring id\n",
        "Header h\n",
        "---\n",
    ] {
        let text = format!("std_msgs/Header header\n{RULE}\nMSG: std_msgs/Header\n{other}");
        let schema = link("acme/A", &text, "ros2msg");
        assert_eq!(kinds(&schema), [("header", &Kind::Nested(1), Count::One)], "{other}");
    }
    let own = format!("Header header\n{RULE}\nMSG: acme_msgs/Header\nint64 t\n");
    assert_eq!(link("acme_msgs/A", &own, "ros2msg").types[1].name, "acme_msgs/Header");
}

#[test]
fn idl_as_rosbag2_stores_it_means_the_same_as_msg() {
    let idl = "================================================================================\nIDL: acme/msg/A\n\
        // generated\n#include \"std_msgs/msg/Header.idl\"\nmodule acme {\n module msg {\n\
        typedef double double__3[3];\n typedef sequence<octet> blob;\n enum Mode { OFF, ON };\n\
        module A_Constants { const uint8 ONE = 1; const string T = \"; }\"; };\n\
        @verbatim (language=\"comment\", text=\n\"struct X { (\" \"\\n\")\n struct A {\n\
        @unit (value=\"m\")\n double__3 point;\n Mode mode; unsigned long long a, b[2][3];\n boolean on; blob data;\n\
        sequence<std_msgs::msg::Header, 4> heads; std_msgs::msg::Header header; acme::msg::B b2;\n\
        sequence<string<3>, 2> words; long long l; short s; unsigned short us; long i; unsigned long ui; char c;\n\
        };\n };\n};\n\
        ================================================================================\nIDL: acme/msg/B\n\
        module acme { module msg { struct B { uint8 structure_needs_at_least_one_member; }; }; };\n";
    let msg = format!(
        "float64[3] point\nuint32 mode\nuint64 a\nuint64[6] b\nbool on\nbyte[] data\nstd_msgs/Header[<=4] heads\n\
         std_msgs/Header header\nB b2\nstring<=3[<=2] words\nint64 l\nint16 s\nuint16 us\nint32 i\nuint32 ui\nchar c\n\
         {RULE}\nMSG: acme/B\nuint8 structure_needs_at_least_one_member\n"
    );
    let (idl, msg) = (link("acme/msg/A", idl, "ros2idl"), link("acme/msg/A", &msg, "ros2msg"));
    assert_eq!(idl.types[0], msg.types[0]);
    assert_eq!(idl.layout(&msg, Wire::Cdr), Layout::Published);
}

#[test]
fn what_idl_can_say_and_messages_cannot_hold_is_said() {
    let field = |declarations: &str, field: &str| {
        let text = format!("module acme {{ module msg {{ {declarations} struct A {{ {field} }}; }}; }};");
        let schema = link("acme/msg/A", &text, "ros2idl");
        let root = schema.root().unwrap().clone();
        match root.fields.first().map(|field| field.kind.clone()) {
            Some(Kind::Unsupported(what)) => what,
            other => format!("{other:?} {:?}", root.fault),
        }
    };
    let union = "union U switch (long) { case 1: long a; };";
    assert_eq!(field(union, "U u;"), "`U` is a union, which is not supported");
    assert_eq!(field("", "@optional long a;"), "optional fields are not supported");
    assert_eq!(field("", "wstring<3> w;"), "`wstring` is not supported");
    assert_eq!(field("", "long double d;"), "`long double` is not supported");
    assert_eq!(field("", "Missing m;"), "there is no definition of Missing");
    let rows = "arrays of sequences and sequences of arrays are not supported";
    assert_eq!(field("", "sequence<sequence<long>> a;"), rows);
    assert_eq!(field("typedef long three[3];", "three a[2];"), rows);
    assert!(field("typedef B C; typedef C B;", "B b;").contains("more than 16 names"));
    assert!(field("", "long a[N];").ends_with("Some(\"line 1: the length of `a` is not a number\")"));
    assert!(field("", "long;").ends_with("Some(\"line 1: a field has no name\")"));
}

#[test]
fn a_definition_without_the_type_itself_says_why() {
    let why = |schema: &[u8], encoding: &str| match TypeDefinition::read("acme/msg/A", schema, encoding) {
        TypeDefinition::Unread(why) => why,
        other => panic!("{other:?}"),
    };
    assert_eq!(
        why(b"struct B { long a; };", "ros2idl"),
        "its definition does not contain the type itself"
    );
    let deep = "module a { ".repeat(20);
    assert!(why(deep.as_bytes(), "ros2idl").contains("line 1: modules are nested more than 8 deep"));
    assert_eq!(
        why(b"\n\nfunction x", "ros2idl"),
        "its definition is not understood: line 3: `function` is not a supported declaration"
    );
    assert_eq!(why(&[0xff], "ros2msg"), "its definition is not UTF-8");
    assert!(why(&vec![b'x'; MAX_DEFINITION + 1], "ros2msg").contains("too long"));
    assert_eq!(why(b"x", ""), "definitions in an unnamed encoding are not read");
    assert!(matches!(
        TypeDefinition::read("a/A", b" \n", "ros2msg"),
        TypeDefinition::Nothing
    ));
}

#[test]
fn a_layout_is_the_published_one_up_to_what_follows() {
    let published = Schema::published("geometry_msgs/PoseStamped").unwrap();
    let of = |text: &str, wire| link("geometry_msgs/PoseStamped", text, "ros2msg").layout(&published, wire);
    let whole = "std_msgs/Header header\nPose pose\n";
    assert_eq!(of(whole, Wire::Cdr), Layout::Published);
    assert_eq!(of(&format!("{whole}float64 more\n"), Wire::Cdr), Layout::Published);
    // A ROS 1 header in CDR, and the other way round, is no published layout.
    assert_eq!(of(whole, Wire::Ros1), Layout::Different);
    let seq = format!("{whole}{RULE}\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n");
    assert_eq!(
        (of(&seq, Wire::Ros1), of(&seq, Wire::Cdr)),
        (Layout::Published, Layout::Different)
    );
    for changed in [
        "std_msgs/Header header\n",
        "Pose pose\nstd_msgs/Header header\n",
        "std_msgs/Header header\nPose[] pose\n",
        "std_msgs/Header header\nPose2D pose\n",
    ] {
        assert_eq!(of(changed, Wire::Cdr), Layout::Different, "{changed}");
    }
    let camera = Schema::published("sensor_msgs/CameraInfo").unwrap();
    let ros1 = "std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\nfloat64[] D\nfloat64[9] K\nfloat64[9] R\nfloat64[12] P\n\
                uint32 binning_x\nuint32 binning_y\nRegionOfInterest roi\n";
    let ros1 = format!("{ros1}{RULE}\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n");
    let read = link("sensor_msgs/CameraInfo", &ros1, "ros1msg");
    assert_eq!(read.layout(&camera, Wire::Ros1), Layout::Published);
    for quaternion in [
        "float64 w\nfloat64 x\nfloat64 y\nfloat64 z\n",
        "float32 x\nfloat32 y\nfloat32 z\nfloat32 w\n",
        "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\nfloat64 more\n",
    ] {
        let text = format!("{whole}{RULE}\nMSG: geometry_msgs/Quaternion\n{quaternion}");
        assert_eq!(of(&text, Wire::Cdr), Layout::Different, "{quaternion}");
    }
}

#[test]
fn types_that_hold_themselves_and_each_other_are_made_once() {
    let mut text = "T0 a\nT0 b\n".to_owned();
    for index in 0..200 {
        let next = (index + 1) % 200;
        write!(text, "{RULE}\nMSG: acme/T{index}\nT{next} a\nT{next} b\n").unwrap();
    }
    let schema = link("acme/A", &text, "ros2msg");
    assert_eq!(schema.types.len(), 201);
    assert_eq!(schema.layout(&schema, Wire::Cdr), Layout::Published);
}

#[test]
fn the_standard_packages_are_whole() {
    let definitions = Definitions::builtin();
    let standard = definitions.bundles().last().unwrap();
    assert!(standard.types.len() > 350, "{}", standard.types.len());
    for name in standard.types.keys() {
        let schema = Schema::published(name).unwrap();
        for one in &schema.types {
            assert_eq!(one.fault, None, "{name}: {}", one.name);
            for field in &one.fields {
                let is_known = !matches!(&field.kind, Kind::Unsupported(what) if !what.contains("wstring"));
                assert!(is_known, "{name}: {} {field:?}", one.name);
            }
        }
        // A header comes first or not at all: a version of the package that differs after it is still read.
        let fields = &schema.root().unwrap().fields;
        let header = fields
            .iter()
            .position(|field| matches!(field.kind, Kind::Header { .. }));
        assert!(header.is_none_or(|at| at == 0), "{name}");
    }
}

#[test]
fn every_spelling_of_a_type_is_one_name() {
    for spelling in [
        "sensor_msgs/msg/Imu",
        "sensor_msgs/Imu",
        " sensor_msgs::msg::Imu",
        "sensor_msgs::msg::dds_::Imu_",
    ] {
        assert_eq!(plain_name(spelling), "sensor_msgs/Imu", "{spelling}");
    }
    assert_eq!(plain_name("Header"), "Header");
    assert_eq!(plain_name("msg/Imu"), "msg/Imu");
    assert_eq!(
        plain_name("nav2_msgs/action/Wait_Feedback"),
        "nav2_msgs/action/Wait_Feedback"
    );
    assert_eq!(plain_name("acme/msg/Type_"), "acme/Type_");
}
