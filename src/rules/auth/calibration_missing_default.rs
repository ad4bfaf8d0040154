//! AUTH05: a calibration file that is named but missing or empty, so that an identity may replace it.

use crate::analysis::names;
use crate::rules::prelude::*;
use crate::source::{ReadStatus, Source, SourceKind};
use crate::world::{Claim, ClaimKind, FileReference, FrameId, ReferenceState, World};

pub(crate) struct CalibrationMissingDefault;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    identity_deg: f64,
    identity_m: f64,
}

/// Tokens of a file name that mark a calibration.
const CALIBRATION: &[&str] = &["calib", "calibration", "extrinsic", "extrinsics", "camchain", "imucam"];

/// Tokens of the name of a sensor's frame.
const SENSORS: &[&[&str]] = &[names::LIDARS, names::CAMERAS, names::GNSS, &["os", "imu", "radar"]];

impl Rule for CalibrationMissingDefault {
    const NEEDS: &'static [Need] = &[];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let stand_in = identity_mount(world, limits);
        for reference in &world.references {
            judge_reference(reference, stand_in, out);
        }
        for source in world.members.iter().filter_map(|id| world.source(*id)) {
            if is_calibration(source) && source.status == ReadStatus::Unreadable {
                let why = source.detail.as_deref().unwrap_or("it cannot be read");
                let message = format!("calibration file `{}` contains no transform", source.path);
                let subject = format!("calibration {}", source.path);
                let finding = finding(subject, message, Place::whole(source.id), stand_in, true);
                out.fail(finding.detail(format!("Reason: {why}.")));
            }
        }
    }
}

fn judge_reference(reference: &FileReference, stand_in: Option<&Claim>, out: &mut Judge) {
    let subject = format!("reference `{}` to {}", reference.key, reference.path.value);
    let what = match reference.state {
        ReferenceState::Found => {
            let absent = Measured::count("missing calibration files", 0);
            return out.pass(subject, absent.limit(0.0));
        }
        ReferenceState::Unknown => {
            let why = "an absolute path that does not exist here, but may exist on the robot: run the check there, or use a relative path";
            return out.missing(subject, why);
        }
        ReferenceState::Empty => "is empty",
        ReferenceState::Missing => "does not exist",
    };
    let message = format!(
        "`{}`: calibration file `{}` {what}",
        reference.key, reference.path.value
    );
    let certain = reference.state == ReferenceState::Empty;
    let finding = finding(subject, message, reference.path.place.clone(), stand_in, certain);
    out.fail(if certain {
        finding
    } else {
        finding.detail("The path was read relative to the folder of this file. A program may look in another folder.")
    });
}

/// Empty files are always wrong. A file that is not in the input may be elsewhere: only an identity in its place makes an effect
/// likely.
fn finding(subject: String, message: String, place: Place, stand_in: Option<&Claim>, certain: bool) -> Finding {
    let finding = match (certain, stand_in) {
        (true, _) => Finding::error(subject, message, place),
        (false, Some(_)) => Finding::error(subject, message, place).likely(),
        (false, None) => Finding::warning(subject, message, place).hint(),
    };
    let (help, what) = if certain {
        (
            "write the calibration into the file, and make the loader fail on an empty file (some loaders use the identity instead)",
            "calibration files without content",
        )
    } else {
        (
            "find the folder from which the program reads the path:\n(1) if the file is in that folder, waive this finding\n(2) if not, correct the path or add the file, and make the loader fail on a missing file (some loaders use the identity instead)",
            "missing calibration files",
        )
    };
    let identity = "the identity, perhaps used instead of this calibration";
    let finding = finding.help(help).measured(Measured::count(what, 1).limit(0.0));
    match stand_in {
        Some(claim) => finding.related(claim.place.clone(), identity),
        None => finding,
    }
}

fn is_calibration(source: &Source) -> bool {
    let name = FrameId::new(source.path.rsplit('/').next().unwrap_or(&source.path));
    matches!(source.kind, SourceKind::Yaml | SourceKind::Json | SourceKind::Text)
        && CALIBRATION.iter().any(|word| name.has_token(word))
}

/// A sensor that is mounted with the identity.
fn identity_mount<'w>(world: &'w World, limits: &Limits) -> Option<&'w Claim> {
    world.claims.iter().find(|claim| {
        let is_mount = matches!(claim.kind, ClaimKind::Joint { fixed: true, .. });
        let is_sensor = claim.source_frame().is_some_and(|frame| {
            SENSORS.iter().copied().flatten().any(|word| frame.has_token(word)) && !frame.has_token("optical")
        });
        let is_identity = claim.pose.is_some_and(|pose| {
            let pose = pose.isometry();
            pose.rotation.angle().to_degrees() <= limits.identity_deg
                && pose.translation.vector.norm() <= limits.identity_m
        });
        is_mount && is_sensor && is_identity
    })
}
