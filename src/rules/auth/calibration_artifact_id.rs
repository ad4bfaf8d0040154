//! AUTH02: which calibration and which description a recording was made with.

use crate::analysis::auth::revision::{Differences, Limits, counterpart, differences, is_recorded};
use crate::rules::prelude::*;
use crate::world::{BagEvidence, FrameId, Robot, World};

pub(crate) struct CalibrationArtifactId;

/// Words of names and keys that identify a calibration or a vehicle.
#[rustfmt::skip]
const IDENTITY: &[&str] = &[
    "calib", "calibration", "calibrations", "extrinsic", "extrinsics", "urdf", "description", "hash", "sha", "sha256",
    "commit", "revision", "serial", "vin",
];

impl Rule for CalibrationArtifactId {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for robot in world
            .robots
            .iter()
            .filter(|robot| robot.fragment.is_none() && is_recorded(world, robot))
        {
            judge_description(world, robot, limits, out);
        }
        for bag in &world.bags {
            judge_notes(world, bag, out);
        }
    }
}

fn judge_description(world: &World, recorded: &Robot, limits: &Limits, out: &mut Judge) {
    let subject = format!(
        "description of `{}` in {}",
        recorded.name.value,
        world.path(recorded.source)
    );
    let Some(file) = counterpart(world, recorded, limits) else {
        return out.missing(
            subject,
            "no single URDF file of this robot to compare it with: add the file to the input",
        );
    };
    let Differences { found, rigid } = differences(file, recorded, limits);
    let measured = Measured::count("links and joints that differ", found.len()).limit(limits.max_differences);
    let Some(first) = found.first().filter(|_| found.len() as f64 > limits.max_differences) else {
        if rigid == 0 {
            out.pass(subject, [measured]);
        } else {
            let why = format!("only the origins of {rigid} fixed joint(s) differ; other rules compare transforms");
            out.not_applicable(subject, why);
        }
        return;
    };
    let words: Vec<&str> = found
        .iter()
        .take(4)
        .map(|difference| difference.words.as_str())
        .collect();
    let more = match found.len().saturating_sub(words.len()) {
        0 => String::new(),
        n => format!("; and {n} more"),
    };
    let message = format!(
        "the URDF in the recording differs from `{}` in {} link{} or joint{}",
        world.path(file.source),
        found.len(),
        if found.len() == 1 { "" } else { "s" },
        if found.len() == 1 { "" } else { "s" },
    );
    let finding = Finding::warning(subject, message, first.recorded.clone())
        .label("in the recording")
        .detail(format!("{}{more}.", words.join("; ")))
        .help(format!(
            "if the robot has changed since the recording, check the recording with the URDF of that time; otherwise correct `{}`",
            world.path(file.source)
        ))
        .measured(measured)
        .related(first.file.clone(), "in the file");
    out.fail(finding);
}

/// Metadata that a user wrote should identify the calibration; without any, this is not evaluated.
fn judge_notes(world: &World, bag: &BagEvidence, out: &mut Judge) {
    let subject = format!("calibration of {}", world.path(bag.source));
    let fields = || {
        let records = bag.annotations.iter();
        records.flat_map(|(name, fields)| fields.keys().map(move |key| (name.as_str(), key.as_str())))
    };
    let written = fields().filter(|(name, key)| !is_by_itself(name, key)).count();
    let says = |text: &str| IDENTITY.iter().any(|word| FrameId::new(text).has_token(word));
    let naming = fields().filter(|(name, key)| says(name) || says(key)).count();
    let measured = Measured::count("fields that may identify a calibration", naming).samples(written as u64);
    if naming > 0 {
        return out.pass(subject, [measured]);
    }
    if written == 0 {
        return out.missing(subject, "the recording has no metadata from a user");
    }
    let message = match written {
        1 => "the metadata field of the recording does not identify its calibration".to_owned(),
        n => format!("none of the {n} metadata fields of the recording identifies its calibration"),
    };
    out.fail(
        Finding::note(subject, message, Place::whole(bag.source))
            .hint()
            .detail("No name of a record or field has a word such as calibration, extrinsics, urdf, hash or serial.")
            .help("write the id or hash of calibration and URDF into the recording's metadata, as `calibration_id` and `urdf_hash`")
            .measured(measured.at_least(1.0)),
    );
}

/// What nobody wrote for the drive: the recorder's own fields, and attached files.
fn is_by_itself(name: &str, key: &str) -> bool {
    matches!(name, "rosbag2" | "rosbag" | "attachments") || key == "ros_distro"
}
