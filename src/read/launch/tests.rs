//! One static transform in every grammar, and what each cannot express.

use std::f64::consts::FRAC_PI_2;

use super::*;
use crate::source::{Confidence, LineIndex, SourceKind};
use crate::world::launch::ReadObstacle;
use crate::world::{Claim, Spelling};

fn launched(path: &str, text: &str) -> (Source, Facts) {
    let mut source = Source::new(SourceId(0), path, SourceKind::Launch);
    source.text = text.to_owned();
    let facts = read(&mut source);
    (source, facts)
}

/// `parent from child x y z | roll pitch yaw reading line:text of the first angle`.
fn claim_text(source: &Source, claim: &Claim) -> String {
    let (parent, child) = claim
        .frames
        .clone()
        .map_or(("?".to_owned(), "?".to_owned()), |(parent, child)| {
            (parent.to_string(), child.to_string())
        });
    let pose = match claim.spelling {
        Spelling::Rpy { xyz, rpy } => format!("{xyz:?} rpy {rpy:?}"),
        Spelling::Quaternion { xyz, xyzw, .. } => format!("{xyz:?} xyzw {xyzw:?}"),
        _ => "?".to_owned(),
    };
    let place = claim.rotation_literals.last().map_or_else(String::new, |literal| {
        let at = LineIndex::new(&source.text).locate(&source.text, literal.span.start);
        let text = &source.text[literal.span.start..literal.span.end];
        format!("{}:{text}", at.line)
    });
    format!("{parent} from {child} {pose} {:?} {place}", claim.reading)
}

fn all(path: &str, text: &str) -> Vec<String> {
    let (source, facts) = launched(path, text);
    facts.claims.iter().map(|claim| claim_text(&source, claim)).collect()
}

const ONE: &str = "base from laser [1.0, 2.0, 3.0] rpy [0.3, 0.2, 0.1] Certain";

#[test]
fn six_numbers_are_yaw_pitch_roll_in_every_grammar() {
    let xml = "<launch>\n<node pkg='tf' type='static_transform_publisher' name='a' args='1 2 3 0.1 0.2 0.3 base laser 100'/>\n</launch>";
    let commented = "<launch><!-- <node pkg='tf' type='static_transform_publisher' args='9 9 9 0 0 0 a b 1'/> -->\n<group>\n<node pkg='tf2_ros' exec='static_transform_publisher' args='1 2 3\n 0.1 0.2 0.3 base laser'/></group></launch>";
    let python = "from launch_ros.actions import Node\nn = Node(package='tf2_ros', executable='static_transform_publisher',\n  arguments=['1', '2', '3', '0.1', \"0.2\", '0.3', 'base', 'laser'])";
    let split = "import launch_ros\nx = launch_ros.actions.Node(package='tf2_ros', node_executable='static_transform_publisher', arguments='1 2 3 0.1 0.2 0.3 base laser'.split())";
    let shell = "#!/bin/bash\nset -e\nrosrun tf static_transform_publisher 1 2 3 \\\n  0.1 0.2 0.3 base laser 100 __name:=a &\n# ros2 run tf2_ros static_transform_publisher 9 9 9 0 0 0 a b\n";
    for (path, text, place) in [
        ("a.launch", xml, "2:0.1"),
        ("a.launch.xml", commented, "4:0.1"),
        ("a.launch.py", python, "3:0.1"),
        ("a.launch.py", split, "2:0.1"),
        ("a.sh", shell, "4:0.1"),
    ] {
        assert_eq!(all(path, text), [format!("{ONE} {place}")], "{path}: {text}");
    }
}

#[test]
fn seven_numbers_are_a_quaternion_with_its_scalar_last() {
    let text = "<launch><node pkg='tf2_ros' type='static_transform_publisher' name='a' args='1 2 3 0 0 0.6 0.8 base laser'/></launch>";
    assert_eq!(
        all("a.launch", text),
        ["base from laser [1.0, 2.0, 3.0] xyzw [0.0, 0.0, 0.6, 0.8] Certain 1:0.8"]
    );
}

#[test]
fn flags_say_what_each_number_is_and_leave_out_zeros() {
    let text = "ros2 run tf2_ros static_transform_publisher --yaw 1.5 --x 1 --frame-id base --child-frame-id laser --ros-args -r __node:=a\n";
    let claims = all("a.sh", text);
    assert_eq!(claims, ["base from laser [1.0, 0.0, 0.0] rpy [0.0, 0.0, 1.5] Certain "]);
    let half = "ros2 run tf2_ros static_transform_publisher --qx 1 --qw 0 --frame-id base --child-frame-id laser\n";
    assert_eq!(
        all("a.sh", half),
        ["base from laser [0.0, 0.0, 0.0] xyzw [1.0, 0.0, 0.0, 0.0] Certain "]
    );
}

#[test]
fn arguments_of_launch_files_are_put_in_by_default_and_point_at_the_default() {
    let text = "<launch>\n<arg name='yaw' default='0.1'/>\n<arg name='rot' default='$(arg yaw) 0.2 0.3'/>\n<node pkg='tf' type='static_transform_publisher' name='a' args='1 2 3 $(arg rot) base $(optenv L laser) 100'/></launch>";
    assert_eq!(
        all("a.launch", text),
        [format!("{} 2:0.1", ONE.replace("Certain", "Likely"))]
    );
    let python = "a = DeclareLaunchArgument('yaw', default_value='0.1')\nn = Node(package='tf2_ros', executable='static_transform_publisher', arguments=['1', '2', '3', LaunchConfiguration('yaw'), '0.2', '0.3', 'base', 'laser'])";
    assert_eq!(
        all("a.launch.py", python),
        [format!("{} 1:0.1", ONE.replace("Certain", "Likely"))]
    );
}

#[test]
fn what_is_filled_in_later_is_not_known() {
    for (path, text, what) in [
        (
            "a.launch",
            "<launch><arg name='z'/><node pkg='tf' type='static_transform_publisher' args='1 2 $(arg z) 0 0 0 base laser 100'/></launch>",
            "$(arg z)",
        ),
        (
            "a.launch.py",
            "n = Node(package='tf2_ros', executable='static_transform_publisher', arguments=['1', '2', height(), '0', '0', '0', 'base', 'laser'])",
            "height()",
        ),
        (
            "a.sh",
            "rosrun tf static_transform_publisher 1 2 $HEIGHT 0 0 0 base laser 100\n",
            "$HEIGHT",
        ),
    ] {
        let (_, facts) = launched(path, text);
        assert!(facts.claims.is_empty(), "{text}");
        assert_eq!(
            facts.publishers[0].unread,
            Some(ReadObstacle::Open(what.to_owned())),
            "{text}"
        );
    }
    // Frames that are not known leave the numbers to be judged.
    let open = "<launch><node pkg='tf' type='static_transform_publisher' args='1 2 3 0.1 0.2 0.3 $(arg ns)/base laser 100'/></launch>";
    assert_eq!(
        all("a.launch", open),
        [format!(
            "{} 1:0.1",
            ONE.replace("base from laser", "? from ?").replace("Certain", "Hint")
        )]
    );
}

#[test]
fn conditions_are_followed_as_far_as_defaults_tell() {
    let file = |condition: &str| {
        format!(
            "<launch><arg name='on' default='true'/><arg name='off' value='false'/><group {condition}><node pkg='tf' type='static_transform_publisher' args='1 2 3 0.1 0.2 0.3 base laser 100'/></group></launch>"
        )
    };
    for (condition, reading) in [
        ("", Some(Confidence::Certain)),
        ("if='$(arg on)'", Some(Confidence::Likely)),
        ("unless='$(arg on)'", None),
        ("if='$(arg off)'", None),
        ("unless='$(arg off)'", Some(Confidence::Certain)),
        ("if='$(eval 1 == 1)'", Some(Confidence::Hint)),
    ] {
        let (_, facts) = launched("a.launch", &file(condition));
        assert_eq!(facts.claims.first().map(|claim| claim.reading), reading, "{condition}");
    }
    let python = "n = Node(package='tf2_ros', executable='static_transform_publisher', condition=IfCondition(x), arguments=['1', '2', '3', '0.1', '0.2', '0.3', 'base', 'laser'])";
    assert!(all("a.launch.py", python)[0].contains("Hint"));
}

#[test]
fn tables_of_python_are_followed_through_loops_and_comprehensions() {
    let publish = "Node(package='tf2_ros', executable='static_transform_publisher',";
    let looped = format!(
        "MOUNTS = {{'imu': [('0.4', 0, 1.1), 'base_link'], 'gnss': [('0.8', 0, 2.9), 'base_link']}}\n\
         nodes = []\n\
         for name, (xyz, parent) in MOUNTS.items():\n    \
         nodes.append({publish} arguments=['--x', xyz[0], '--z', str(xyz[-1]), '--frame-id', parent, '--child-frame-id', name + '_link']))\n"
    );
    let comprehended = format!(
        "TABLE = [['0.4', '0', '1.1', '0', '0', '0', 'base_link', 'imu_link'], ['0.8', '0', '2.9', '0', '0', '0', 'base_link', 'gnss_link']]\n\
         nodes = [{publish} arguments=[str(word) for word in row]) for row in TABLE]\n"
    );
    let helper = format!(
        "def still(child, xyz):\n    \
         return {publish} arguments=['--x', str(xyz[0]), '--z', str(xyz[2]), '--frame-id', 'base_link', '--child-frame-id', child])\n\
         nodes = [still(child, xyz) for child, xyz in (('imu_link', (0.4, 0, 1.1)), ('gnss_link', (0.8, 0, 2.9)))]\n"
    );
    for text in [looped, comprehended, helper] {
        let stated = all("a.launch.py", &text);
        let starts = [
            "base_link from imu_link [0.4, 0.0, 1.1]",
            "base_link from gnss_link [0.8, 0.0, 2.9]",
        ];
        let is_each = starts
            .iter()
            .zip(&stated)
            .all(|(start, claim)| claim.starts_with(start) && claim.contains("Certain"));
        assert!(stated.len() == 2 && is_each, "{text}{stated:?}");
    }
    let unknown = format!("nodes = [{publish} arguments=row) for row in read('table.csv')]\n");
    let some = format!(
        "W = ['1', '2', '3', '0', '0', '0', 'base', 'laser']\nn = {publish} arguments=[w for w in W if w != x])\n"
    );
    assert!([unknown, some].iter().all(|text| all("a.launch.py", text).is_empty()));
}

#[test]
fn lists_of_lists_of_python_are_followed_only_so_far() {
    use std::fmt::Write as _;
    let mut named = "l0 = ['1', '2']\n".to_owned();
    for level in 1..15 {
        let _ = writeln!(named, "l{level} = [{}]", vec![format!("l{}", level - 1); 20].join(", "));
    }
    let nested = format!(
        "L = [{}]\nl14 = {}L{}\n",
        vec!["1"; 500].join(", "),
        "[".repeat(7),
        " for x in L]".repeat(7)
    );
    for text in [named, nested] {
        let node = "n = Node(package='tf2_ros', executable='static_transform_publisher', arguments=l14)\n";
        assert!(all("a.launch.py", &(text + node)).is_empty());
    }
}

#[test]
fn functions_of_python_that_make_nodes_are_followed_to_their_calls() {
    let text = "import math\n\ndef tf(x, yaw, parent, child='laser'):\n    return Node(package='tf2_ros', executable='static_transform_publisher',\n        arguments=['--x', str(x), '--yaw', str(yaw), '--frame-id', parent, '--child-frame-id', child])\n\nD = LaunchDescription([tf(1., -math.pi / 2, 'base'), tf(2, math.radians(90), f'{\"base\"}', child='camera')])\n";
    assert_eq!(
        all("a.launch.py", text),
        [
            format!("base from laser [1.0, 0.0, 0.0] rpy [0.0, 0.0, -{FRAC_PI_2:?}] Certain "),
            format!("base from camera [2.0, 0.0, 0.0] rpy [0.0, 0.0, {FRAC_PI_2:?}] Certain "),
        ]
    );
}

#[test]
fn leading_slashes_are_names_for_tf2_and_none_for_tf() {
    let file = |package: &str, period: &str| {
        format!(
            "<launch><node pkg='{package}' type='static_transform_publisher' args='1 2 3 0 0 0 /base /laser{period}'/></launch>"
        )
    };
    assert!(all("a.launch", &file("tf", " 100"))[0].starts_with("base from laser"));
    assert!(all("a.launch", &file("tf2_ros", ""))[0].starts_with("/base from /laser"));
}

#[test]
fn settings_of_localisation_nodes_are_kept_with_their_places() {
    let xml = "<launch><node pkg='robot_localization' type='navsat_transform_node' name='navsat'>\n<param name='magnetic_declination_radians' value='0.1'/><param name='frequency' value='30'/>\n<rosparam>\nyaw_offset: 1.57\n</rosparam></node></launch>";
    let python = "n = Node(package='robot_localization', executable='navsat_transform_node', name='navsat', parameters=[{\n'magnetic_declination_radians': 0.1, 'frequency': 30.0,\n\n'yaw_offset': 1.57}])";
    for (path, text) in [("a.launch", xml), ("a.launch.py", python)] {
        let (source, facts) = launched(path, text);
        let settings = &facts.localizations[0];
        assert_eq!(settings.node, "navsat");
        let found: Vec<(String, usize)> = settings
            .values
            .iter()
            .map(|(key, value)| {
                let at = value.place.span().unwrap();
                let line = LineIndex::new(&source.text).locate(&source.text, at.start).line;
                assert_eq!(&source.text[at.start..at.end], value.value);
                (format!("{key}={}", value.value), line)
            })
            .collect();
        assert_eq!(
            found,
            [
                ("magnetic_declination_radians=0.1".to_owned(), 2),
                ("yaw_offset=1.57".to_owned(), 4)
            ]
        );
    }
}

#[test]
fn broken_files_say_where() {
    let (source, facts) = launched("a.launch", "<launch>\n<node pkg='tf' <!-- x --> args='1'/>\n</launch>");
    assert!(facts.publishers.is_empty());
    let problem = &source.problems[0];
    assert!(problem.message.starts_with("not XML"), "{}", problem.message);
    assert_eq!(
        LineIndex::new(&source.text)
            .locate(&source.text, problem.place.span().unwrap().start)
            .line,
        2
    );
    // Python and shell are read past what is broken.
    let python = "def f(:\n  pass\nn = Node(package='tf2_ros', executable='static_transform_publisher', arguments=['1', '2', '3', '0.1', '0.2', '0.3', 'base', 'laser'])\n";
    assert_eq!(all("a.launch.py", python).len(), 1);
}

#[test]
fn substitutions_that_grow_without_end_are_cut_off() {
    let mut text = "<launch><arg name='a0' default='xxxxxxxxxx'/>".to_owned();
    for n in 1..30 {
        let before = format!("$(arg a{})", n - 1);
        text += &["<arg name='a", &n.to_string(), "' default='", &before.repeat(10), "'/>"].concat();
    }
    text.push_str("<node pkg='tf' type='static_transform_publisher' args='1 2 3 0 0 0 base $(arg a29) 100'/></launch>");
    let (_, facts) = launched("a.launch", &text);
    assert_eq!(facts.publishers.len(), 1);
}
