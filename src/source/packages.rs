//! Packages of files whose folders each hold one kind: `launch/`, `config/`, `map/`.

use std::path::{Path, PathBuf};

/// Folders in which a package keeps one kind of its files.
const PARTS: &[&str] = &[
    "bringup",
    "calib",
    "calibration",
    "calibrations",
    "camera_info",
    "cfg",
    "conf",
    "config",
    "configs",
    "description",
    "extrinsics",
    "individual_params",
    "intrinsics",
    "kalibr",
    "kalibr_results",
    "launch",
    "map",
    "maps",
    "param",
    "parameters",
    "params",
    "result",
    "results",
    "survey",
    "urdf",
    "vins",
    "xacro",
];

/// The folder of which this one holds a kind of files, at most `root`; the folder itself where its name says nothing of the kind.
pub(crate) fn whole_of(dir: &Path, root: &Path) -> PathBuf {
    let is_part = |folder: &&Path| {
        let name = folder.file_name().map(|name| name.to_string_lossy().to_lowercase());
        **folder != *root && name.is_some_and(|name| PARTS.contains(&name.as_str()))
    };
    let whole = dir.ancestors().find(|folder| !is_part(folder));
    whole.unwrap_or(dir).to_path_buf()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_of_one_kind_are_of_the_folder_above_and_never_above_the_root() {
        let whole = |dir: &str| whole_of(Path::new(dir), Path::new("/ws/config"));
        assert_eq!(whole("/ws/config/rover/launch"), Path::new("/ws/config/rover"));
        assert_eq!(whole("/ws/config/rover/Config/params"), Path::new("/ws/config/rover"));
        assert_eq!(whole("/ws/config/rover/lidar"), Path::new("/ws/config/rover/lidar"));
        assert_eq!(whole("/ws/config/launch"), Path::new("/ws/config"));
    }
}
