//! Programs' names for their sensors, mapped to one name each: `body` of a visual-inertial program is its IMU, `velo` a lidar, `camera` and
//! ORB-SLAM's `cam1` the first camera.
//!
//! That two programs mean the same sensor stays a guess: users of such names must say so.

use std::path::Path;

use crate::world::{FrameId, World};

/// Dialects whose files name the platform's frames.
const OWN_NAMES: [&str; 4] = ["generic", "autoware", "easy-handeye", "static_transform_publisher"];
/// Dialects whose `body` is not the IMU.
const OTHER_BODIES: [&str; 2] = ["ouster", "kalibr-imu"];

/// The common name of a sensor that a dialect calls `name`, in the file at `path`. The name of a frame of the robot stays.
pub(crate) fn role(world: &World, dialect: &str, path: &str, name: &FrameId) -> FrameId {
    if OWN_NAMES.contains(&dialect) || world.graph().frames.contains(&name.canonical()) {
        return name.canonical();
    }
    let text = name.as_str();
    let camera = |number: u32| FrameId::new(format!("cam{number}"));
    if dialect == "euroc" && text == "sensor" {
        return of_file(path).unwrap_or_else(|| name.canonical());
    }
    let stem = text.trim_end_matches(|letter: char| letter.is_ascii_digit());
    let number: Option<u32> = text.get(stem.len()..).and_then(|digits| digits.parse().ok());
    match (stem, number) {
        ("body", None) if !OTHER_BODIES.contains(&dialect) => FrameId::new("imu"),
        ("cam", Some(number)) if dialect == "orb-slam3" => camera(number.saturating_sub(1)),
        ("cam" | "camera", number) => camera(number.unwrap_or(0)),
        ("velo" | "velodyne" | "laser", None) => FrameId::new("lidar"),
        _ => name.canonical(),
    }
}

/// The sensor of a file of EuRoC's form: by its folder (`cam0/sensor.yaml`), or by Kimera's file name (`LeftCameraParams.yaml`).
fn of_file(path: &str) -> Option<FrameId> {
    let path = Path::new(path);
    let file = FrameId::new(path.file_stem()?.to_string_lossy().into_owned());
    let has = |word: &str| file.has_token(word);
    if has("camera") || has("cam") {
        return if has("left") {
            Some(FrameId::new("cam0"))
        } else {
            has("right").then(|| FrameId::new("cam1"))
        };
    }
    let folder = path.parent()?.file_name()?.to_string_lossy().into_owned();
    let stem = folder.trim_end_matches(|letter: char| letter.is_ascii_digit());
    (stem == "cam" && folder.len() > 3).then(|| FrameId::new(folder.as_str()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_several_programs_are_one() {
        let world = World::default();
        let of = |dialect: &str, path: &str, name: &str| role(&world, dialect, path, &name.into()).to_string();
        for (dialect, name, expected) in [
            ("vins-fusion", "body", "imu"),
            ("ouster", "body", "body"),
            ("orb-slam3", "cam1", "cam0"),
            ("rovio", "camera1", "cam1"),
            ("r3live", "camera", "cam0"),
            ("kitti", "velo", "lidar"),
            ("kitti", "cam0_rectified", "cam0_rectified"),
        ] {
            assert_eq!(of(dialect, "a.yaml", name), expected, "{dialect} {name}");
        }
        assert_eq!(of("euroc", "mav0/cam1/sensor.yaml", "sensor"), "cam1");
        assert_eq!(of("euroc", "params/RightCameraParams.yaml", "sensor"), "cam1");
        assert_eq!(of("euroc", "params/other.yaml", "sensor"), "sensor");
    }
}
