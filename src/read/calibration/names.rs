//! What keys mean: which are transforms, which never are, which are one half of a pair, and what units they name.
//!
//! Knows words only. Keys are compared by whole words, never by substrings.

use crate::world::FrameId;
use crate::world::transform_name;

/// The last part of a dotted or slashed key (`IMU.T_b_c1`, `mapping/extrinsic_T`).
pub(super) fn last_part(key: &str) -> &str {
    key.rsplit(['/', '.']).next().unwrap_or(key)
}

fn words(key: &str) -> Vec<String> {
    FrameId::new(last_part(key)).tokens()
}

fn has(key: &str, list: &[&str]) -> bool {
    words(key).iter().any(|word| list.contains(&word.as_str()))
}

/// Words of things that are not rigid transforms, even if their numbers are close to one: camera and IMU intrinsics,
/// statistics, weights.
#[rustfmt::skip]
const NEVER: &[&str] = &[
    "cov", "covariance", "covariances", "intrinsic", "intrinsics", "projection", "distortion", "dist", "noise",
    "stddev", "std", "sigma", "variance", "scale", "misalignment", "homography", "inertia", "gain", "gains",
    "information", "hessian", "weight", "weights", "waypoint", "waypoints", "kernel", "mask", "bias", "limit",
    "limits", "vel", "velocity", "acceleration", "gravity", "fundamental", "essential", "affine", "jacobian",
    "size", "bounds",
];
/// Whole keys that are not rigid transforms: calibration matrices of cameras and IMUs.
#[rustfmt::skip]
const NEVER_WHOLE: &[&str] = &[
    "K", "P", "D", "Q", "H", "F", "E", "sm", "SM", "Ka", "Kg", "M_a", "M_g", "T_a", "T_g", "T_w", "Ta", "Tg",
    "Tw", "Tgs", "camera_matrix", "cameraMatrix",
];
/// Poses that were chosen, not mounting transforms.
const CHOSEN: &[&str] = &["initial", "init", "start", "goal", "target", "home", "dock"];

/// Whether a key names something that is never a rigid transform.
pub(super) fn is_never(key: &str) -> bool {
    let last = last_part(key);
    let numbered = last.trim_end_matches(|c: char| c.is_ascii_digit());
    NEVER_WHOLE.contains(&last)
        || matches!(numbered, "P" | "K" | "D")
        || last.starts_with("P_rect")
        || last.starts_with("K_")
        || has(key, NEVER)
        || (has(key, &["pose", "position"]) && has(key, CHOSEN))
}

/// Words of transforms.
#[rustfmt::skip]
const TRANSFORM: &[&str] = &[
    "extrinsic", "extrinsics", "extr", "ext", "rotation", "rot", "transform", "transforms", "transformation",
    "tf", "rectification", "rect", "pose", "se3", "orientation",
];

/// Whether a key alone shows that its numbers are a transform or a part of one.
pub(super) fn is_transform(key: &str) -> bool {
    let last = last_part(key);
    !is_never(key) && (matches!(last, "T" | "Tr") || has(key, TRANSFORM) || transform_name::parse(last).is_some())
}

/// Whether a key means a rotation in any form.
pub(super) fn is_rotation(key: &str) -> bool {
    has(
        key,
        &["rotation", "rot", "orientation", "quaternion", "quat", "rpy", "euler"],
    )
}

/// Whether a key means roll, pitch and yaw.
pub(super) fn is_angles(key: &str) -> bool {
    has(key, &["rpy", "euler"])
}

/// Keys that mean "this is a transform" and name no frames: the frames are looked for further up.
#[rustfmt::skip]
const NEUTRAL: &[&str] = &[
    "transform", "transforms", "transformation", "pose", "extrinsic", "extrinsics", "matrix", "mat", "param",
    "params", "parameters", "value", "values", "data", "sensor_calib", "calibration", "calib", "T", "Tr", "tf",
    "origin",
];

/// Whether a key names no frames.
pub(super) fn is_neutral(key: &str) -> bool {
    NEUTRAL.contains(&key)
}

/// Words of frames that sensors are mounted on.
#[rustfmt::skip]
const CARRIERS: &[&str] = &[
    "link", "frame", "base", "footprint", "body", "ego", "vehicle", "chassis", "map", "odom", "world", "kit",
    "platform", "robot", "rig", "baselink",
];

/// Whether a key can be the parent frame of Autoware's nesting. UR robots nest six numbers under `kinematics`.
pub(super) fn is_carrier(key: &str) -> bool {
    !key.contains(char::is_whitespace)
        && FrameId::new(key)
            .tokens()
            .iter()
            .any(|word| CARRIERS.contains(&word.as_str()))
}

/// Whether the keys below a key are sensors, and the values under them mounting transforms.
pub(super) fn is_mountings(key: &str) -> bool {
    has(
        key,
        &["extrinsic", "extrinsics", "mount", "mounts", "mounting", "mountings"],
    )
}

/// Words of one kind of frame.
const KINDS: &[&[&str]] = &[
    &[
        "base",
        "baselink",
        "footprint",
        "body",
        "ego",
        "vehicle",
        "chassis",
        "robot",
        "rig",
        "platform",
        "car",
    ],
    &["lidar", "laser", "velodyne", "velo", "ouster", "livox", "hesai"],
    &["camera", "cam"],
    &["imu", "ins"],
];

/// How strongly two names indicate one frame: 3 for the same name, 2 for a word that they share, 1 for one kind, else 0.
pub(super) fn alike(a: &str, b: &str) -> u8 {
    let tokens = |name: &str| -> Vec<String> {
        let tokens = FrameId::new(name).tokens().into_iter();
        let plain = tokens.map(|token| {
            token
                .trim_end_matches(|letter: char| letter.is_ascii_digit())
                .to_owned()
        });
        plain.filter(|token| !token.is_empty()).collect()
    };
    if a.eq_ignore_ascii_case(b) {
        return 3;
    }
    let (a, b) = (tokens(a), tokens(b));
    if a.iter()
        .any(|token| b.contains(token) && !transform_name::is_glued(token))
    {
        return 2;
    }
    let of = |tokens: &[String], words: &[&str]| tokens.iter().any(|token| words.contains(&token.as_str()));
    u8::from(KINDS.iter().any(|words| of(&a, words) && of(&b, words)))
}

/// Which half of a pair a key names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PairHalf {
    /// A translation.
    Translation,
    /// A rotation as a matrix or quaternion.
    Rotation,
    /// Roll, pitch and yaw.
    Angles,
}

/// Endings of keys that name a half; longer ones first where one ends in another.
const HALVES: &[(&str, PairHalf)] = &[
    ("translation", PairHalf::Translation),
    ("position", PairHalf::Translation),
    ("trans", PairHalf::Translation),
    ("xyz", PairHalf::Translation),
    ("pos", PairHalf::Translation),
    ("rotation_matrix", PairHalf::Rotation),
    ("rotation", PairHalf::Rotation),
    ("orientation", PairHalf::Rotation),
    ("quaternion", PairHalf::Rotation),
    ("quat", PairHalf::Rotation),
    ("rot", PairHalf::Rotation),
    ("rotation_rpy", PairHalf::Angles),
    ("rotation_euler", PairHalf::Angles),
    ("orientation_rpy", PairHalf::Angles),
    ("roll_pitch_yaw", PairHalf::Angles),
    ("rpy", PairHalf::Angles),
    ("euler", PairHalf::Angles),
    ("T", PairHalf::Translation),
    ("t", PairHalf::Translation),
    ("R", PairHalf::Rotation),
    ("q", PairHalf::Rotation),
];

/// Splits a key such as `extrinsicRot` or `camera_ext_t` into its stem and the half it names.
pub(super) fn half(key: &str) -> Option<(&str, PairHalf)> {
    let bare = without_units(key);
    HALVES.iter().find_map(|(ending, half)| {
        let at = bare.len().checked_sub(ending.len())?;
        let (stem, tail) = bare.split_at_checked(at)?;
        let single = ending.len() == 1;
        let same = if single {
            tail == *ending
        } else {
            tail.eq_ignore_ascii_case(ending)
        };
        let before = stem.chars().next_back();
        let starts_word = match before {
            None => true,
            Some(c) if !c.is_alphanumeric() => true,
            Some(c) => !single && c.is_lowercase() && tail.starts_with(char::is_uppercase),
        };
        // `originXYZ`, `extrinsicRPY`: an ending in capitals after a small letter.
        (same && starts_word).then(|| (stem.trim_end_matches(['_', '.', '-', '/']), *half))
    })
}

/// The key without its ending on units and order.
fn without_units(key: &str) -> &str {
    let mut bare = key;
    while let Some((rest, "deg" | "degrees" | "degree" | "rad" | "radians" | "m" | "mm" | "xyzw" | "wxyz")) =
        bare.rsplit_once('_')
    {
        bare = rest;
    }
    bare
}

/// Whether a key states that its angles are degrees.
pub(super) fn says_degrees(key: &str) -> bool {
    has(key, &["deg", "degree", "degrees"])
}

/// Whether comments of a text state that its angles are degrees: words on angles and that unit, without a number, which would be about one
/// angle (`# roll, pitch, yaw in deg`, not `# yaw: 90 deg to the left`). Another comment on radians leaves it open.
pub(super) fn comments_say_degrees(text: &str) -> bool {
    const ANGLES: &[&str] = &[
        "roll",
        "pitch",
        "yaw",
        "rpy",
        "angle",
        "angles",
        "euler",
        "rotation",
        "rotations",
    ];
    const DEGREES: &[&str] = &["deg", "degree", "degrees"];
    const RADIANS: &[&str] = &["rad", "radian", "radians"];
    let comments = text.lines().filter_map(|line| Some(line.split_once('#')?.1));
    let says = |comment: &str, units: &[&str]| {
        !comment.contains(|letter: char| letter.is_ascii_digit()) && has(comment, ANGLES) && has(comment, units)
    };
    let (mut degrees, mut radians) = (false, false);
    for comment in comments {
        let comment = comment.replace(['/', '.'], " ");
        degrees |= says(&comment, DEGREES);
        radians |= says(&comment, RADIANS);
    }
    degrees && !radians
}

/// Whether a key states that its lengths are millimetres.
pub(super) fn says_millimetres(key: &str) -> bool {
    has(key, &["mm", "millimetres", "millimeters"])
}

/// The order of a quaternion that a key states: `true` for x y z w, `false` for w x y z.
pub(super) fn says_order(key: &str) -> Option<bool> {
    if has(key, &["xyzw"]) {
        Some(true)
    } else if has(key, &["wxyz"]) {
        Some(false)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_comment_on_angles_states_their_unit() {
        for text in [
            "# xyz in m, roll/pitch/yaw in deg (fixed axes, as in URDF)\na: 1",
            "rpy: [0, 0, 90] # rpy in degrees.",
        ] {
            assert!(comments_say_degrees(text), "{text}");
        }
        for text in [
            "yaw: 1.5708 # yaw is 90 deg to the left",
            "# field of view in deg",
            "# angles in rad, limits of angles in deg",
            "degrees: yes",
        ] {
            assert!(!comments_say_degrees(text), "{text}");
        }
    }

    #[test]
    fn matrices_of_cameras_and_imus_are_never_transforms() {
        for key in [
            "camera_matrix",
            "K",
            "LEFT.K",
            "P",
            "P0",
            "P_rect_00",
            "LEFT.P",
            "T_a",
            "Tg",
            "Tw",
            "sm",
            "imu_intrinsic",
            "projection_matrix",
            "T_G_S_fixed_covariance",
            "linear_accel_covariance",
            "initial_pose",
            "Rot_LI_cov",
        ] {
            assert!(is_never(key) && !is_transform(key), "{key}");
        }
        for key in [
            "T_cam_imu",
            "T_BS",
            "rectification_matrix",
            "extrinsicRot",
            "ExtrinsicMat",
            "lidar_extr",
            "Tr_velo_to_cam",
            "R_rect_00",
            "IMU.T_b_c1",
            "T",
            "lidar_to_cam",
            "body_T_cam0",
            "extrinsic_R",
            "R_IMUtoACC",
        ] {
            assert!(!is_never(key), "{key}");
            assert!(is_transform(key), "{key}");
        }
    }

    #[test]
    fn halves_of_pairs_share_a_stem() {
        for (key, stem, expected) in [
            ("extrinsicRot", "extrinsic", PairHalf::Rotation),
            ("extrinsicTrans", "extrinsic", PairHalf::Translation),
            ("extrinsicRPY", "extrinsic", PairHalf::Angles),
            ("extrinsicRotation", "extrinsic", PairHalf::Rotation),
            ("extrinsicTranslation", "extrinsic", PairHalf::Translation),
            ("extrinsic_R", "extrinsic", PairHalf::Rotation),
            ("extrinsic_T", "extrinsic", PairHalf::Translation),
            ("camera_ext_t", "camera_ext", PairHalf::Translation),
            ("rotation", "", PairHalf::Rotation),
            ("t", "", PairHalf::Translation),
            ("rpy_deg", "", PairHalf::Angles),
            ("originXYZ", "origin", PairHalf::Translation),
            ("rotation_xyzw", "", PairHalf::Rotation),
        ] {
            assert_eq!(half(key), Some((stem, expected)), "{key}");
        }
        for key in ["robot", "lidarT", "start", "rate", "cubic_meter", "freq"] {
            assert_eq!(half(key), None, "{key}");
        }
    }
}
