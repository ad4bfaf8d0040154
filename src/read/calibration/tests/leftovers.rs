//! What looks like a transform and was taken for none.

use super::*;

fn open(source: &Source) -> Vec<&str> {
    source.not_understood.iter().map(|part| part.value.as_str()).collect()
}

#[test]
fn parts_that_look_like_transforms_are_named_with_their_place() {
    let text = "T_a_b: [1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0]\nmount:\n  lidar: [1, 2, 3, 0, 0, 0.5]\n  radar:\n    translation: [1, 2, 3]\n";
    let (source, facts) = yaml(text);
    assert_eq!(facts.claims.len(), 1);
    assert_eq!(open(&source), ["mount/lidar", "mount/radar/translation"]);
    assert_eq!(at(text, source.not_understood[1].place.span().unwrap()), (5, 5));
    assert_eq!(source.status, ReadStatus::Read, "other transforms were read");
    assert_eq!(
        source.understood().as_deref(),
        Some("not understood: `mount/lidar`, `mount/radar/translation`"),
        "the count of what was taken is the engine's"
    );
    for (text, part) in [
        ("lidar_pose: [1, 2, 3, 0, 0, 0.5]\n", "lidar_pose"),
        (
            "seat: [[1, 0, 0, 1], [0, 1, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]]\n",
            "seat",
        ),
        (
            "seat: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [1, 2, 3, 1]]\n",
            "seat",
        ),
        ("lidar: {x: 1, y: 2, z: 3, yaw: 0.5}\n", "lidar/x"),
        ("lidar: {X: 1, Y: 2, Z: 3, Roll: 0, Pitch: 0, Yaw: 0.5}\n", "lidar/X"),
        ("lidar: {tx: 1, ty: 2, tz: 3, rx: 0, ry: 0, rz: 0.5}\n", "lidar/tx"),
        (
            "seat: {lidar_x: 1, lidar_y: 2, lidar_z: 3, lidar_roll: 0, lidar_pitch: 0, lidar_yaw: 0.5}\n",
            "seat/lidar_x",
        ),
    ] {
        let (source, facts) = yaml(text);
        assert!(facts.claims.is_empty(), "{text}");
        assert_eq!(open(&source), [part], "{text}");
        assert_eq!(source.status, ReadStatus::Partial, "{text}");
        let [problem] = &source.problems[..] else {
            panic!("{text}: {:?}", source.problems)
        };
        assert!(
            problem.message.contains(part) && problem.help.is_some(),
            "{}",
            problem.message
        );
    }
}

#[test]
fn what_is_no_transform_is_not_named() {
    let pose = |time: u64| {
        format!("{{token: a{time}, timestamp: {time}, rotation: [1, 0, 0, 0], translation: [411.3, 2700.9, 0]}}")
    };
    let point = "{position: {x: 1, y: 2, z: 3}, orientation: {yaw: 0.5}}";
    for text in [
        "camera_matrix: [500, 0, 320, 0, 500, 240, 0, 0, 1]\nK: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nP: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]\n",
        "pose_covariance: [1, 0, 0, 0, 0, 0]\ngains: {roll: 1, pitch: 2, yaw: 3}\nimu_intrinsics: {M: [2, 0, 0, 0, 2, 0, 0, 0, 2]}\n",
        "points: [[1, 2, 3], [4, 5, 6], [7, 8, 9], [1, 1, 1]]\nfootprint: [[1, 1], [1, -1]]\n",
        "table: [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16]\nmask: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n",
        "initial_pose: {x: 1, y: 2, z: 0, yaw: 0}\ngoal: {x: 1, y: 2, z: 0, yaw: 0}\nxyz: [1, 2, 3]\n",
        "imu0_config: [true, true, false]\nacceleration_limits: [1.3, 0, 0, 0, 0, 3.4]\nrotation: 5\n",
        &format!("waypoints: [{point}, {point}]\n"),
        &format!("[{}]\n", pose(1)),
        &format!("[{}, {}]\n", pose(1), pose(2)),
    ] {
        let (source, facts) = yaml(text);
        assert!(facts.claims.is_empty(), "{text}\n{:?}", facts.claims);
        assert_eq!(open(&source), Vec::<&str>::new(), "{text}");
        assert_eq!(source.status, ReadStatus::Read, "{text}");
    }
}
