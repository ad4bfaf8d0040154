//! One whole cloud of a recording, for other programs.

use crate::collect::pcd::{PcdFile, pcd};
use crate::read::bag::Recording;
use crate::source::SourceKind;

use super::{Options, UsageError, inputs};

/// The first cloud of the topic, or of the only topic with clouds, as a file; see [`pcd`]. The inputs must be one recording.
pub fn cloud(options: &Options, topic: Option<&str>) -> Result<PcdFile, UsageError> {
    let inputs = inputs(options)?;
    let recordings = || inputs.files.iter().filter(|input| input.kind.is_bag());
    let mut all = recordings();
    let (Some(input), None) = (all.next(), all.next()) else {
        let count = recordings().count();
        return Err(UsageError(format!(
            "a cloud is written of one recording; {count} are given"
        )));
    };
    // A rosbag2 folder's metadata lists its files again, with information about them.
    let parts = match input.kind {
        SourceKind::Rosbag2 => &[],
        _ => input.parts.as_slice(),
    };
    let recording = Recording {
        path: &input.path,
        parts,
    };
    pcd(&recording, &options.definitions()?, topic, &|_, _| {})
        .map_err(|why| UsageError(format!("`{}`: {why}", input.display)))
}
