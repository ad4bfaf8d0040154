//! COV03: IMU messages without an orientation that are not marked so.

use crate::rules::prelude::*;
use crate::world::BagEvidence;
use crate::world::bag::{TopicContent, TopicEvidence};
use crate::world::content::{ContentEvidence, ImuEvidence};

pub(crate) struct CovUnknownMarking;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    min_messages: u64,
    constant_share: f64,
    turned_rad: f64,
    turning_rad_s: f64,
}

impl Rule for CovUnknownMarking {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for bag in &world.bags {
            for said in bag.topics.values().flat_map(TopicEvidence::contents) {
                if let Some(imu) = &said.content.imu {
                    judge_imu(bag, &said, imu, limits, out);
                }
            }
        }
    }
}

/// How the orientation is marked by its covariance.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Marking {
    /// -1: no estimate.
    Nothing,
    /// All zeros: an orientation whose covariance is unknown.
    Zeros,
    /// Numbers.
    Numbers,
}

fn marking(content: &ContentEvidence) -> Marking {
    let Some(covariance) = content.covariances.get("orientation_covariance") else {
        return Marking::Zeros;
    };
    if covariance.minus_one.saturating_mul(2) > covariance.count {
        Marking::Nothing
    } else if covariance.all_zero.saturating_mul(2) > covariance.count {
        Marking::Zeros
    } else {
        Marking::Numbers
    }
}

fn judge_imu(bag: &BagEvidence, said: &TopicContent<'_>, imu: &ImuEvidence, limits: &Limits, out: &mut Judge) {
    let subject = said.subject();
    let marked = marking(said.content);
    let share = |count: u64| count as f64 / (imu.count as f64).max(1.0);
    let constant = share(imu.same_as_first);
    let measured = Measured::new("share of equal orientations", constant, "1")
        .limit(limits.constant_share)
        .samples(imu.count);
    let turned = Measured::new("rotation by the gyroscope", imu.turned_rad, "rad").limit(limits.turned_rad);
    if marked == Marking::Nothing {
        let marks = Measured::new("orientations marked with -1", 1.0, "1").samples(imu.count);
        return out.pass(subject, [marks, measured]);
    }
    if imu.count < limits.min_messages {
        return out.too_little(
            subject,
            format!("{} messages, {} are needed", imu.count, limits.min_messages),
        );
    }
    if constant < limits.constant_share {
        return out.pass(subject, [measured, turned]);
    }
    let turns = imu.turned_rad >= limits.turned_rad && imu.angular_velocity_rms >= limits.turning_rad_s;
    if !turns {
        let why = "the orientation is constant and the gyroscope shows no rotation: it may be right; record a turn";
        return out.too_little(subject, why);
    }
    let (what, severity) = if share(imu.zero) >= limits.constant_share {
        // Consumers recognise that there is none.
        ("all zeros", Severity::Note)
    } else {
        let what = if share(imu.identity) >= limits.constant_share {
            "the identity"
        } else {
            "constant"
        };
        (
            what,
            if marked == Marking::Zeros {
                Severity::Warning
            } else {
                Severity::Error
            },
        )
    };
    let place = match &imu.first {
        Some(first) => Place::message(bag.source, first.clone()),
        None => Place::whole(bag.source),
    };
    let message = format!(
        "{subject}: orientation is {what} in all messages, but the gyroscope turns {:.1} rad",
        imu.turned_rad
    );
    out.fail(
        Finding::new(severity, subject, message, place)
            .likely()
            .detail("There is no orientation, but `orientation_covariance[0]` is not -1.")
            .help("set `orientation_covariance[0] = -1` where the device gives no orientation")
            .measured(measured)
            .measured(turned),
    );
}
