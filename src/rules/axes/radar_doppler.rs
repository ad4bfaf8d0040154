//! AXES15: a radar's range rates compared with the motion of its platform: their sign, the yaw of the mounting, and whether they are
//! already ego-compensated.

use std::collections::BTreeSet;
use std::f64::consts::PI;

use crate::advice::places::with_mounting;
use crate::analysis::radar::{MotionSource, Radar, Scan, ScanCriteria, found_again, scans};
use crate::math::circular::{circular_mean, difference, wrapped};
use crate::math::{doppler::MatchGate, stats::median};
use crate::rules::prelude::*;
use crate::source::Confidence;
use crate::world::radar::{RadarForm, SpeedForm};

pub(crate) struct RadarDoppler;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    min_speed_m_s: f64,
    min_detections: usize,
    min_scans: usize,
    min_share: f64,
    tolerance_m_s: f64,
    tolerance_share: f64,
    still: f64,
    min_still: f64,
    max_as_expected: f64,
    min_scale: f64,
    max_scale: f64,
    max_sideways_deg: f64,
    min_resultant: f64,
    max_error_deg: f64,
    pass_deg: f64,
    error_deg: f64,
    half_turn_deg: f64,
    least_way_m: f64,
    near_m: f64,
    near_deg: f64,
    min_found: usize,
    found_ratio: f64,
}

/// Why a radar is not judged.
type Reason = (NotEvaluated, String);

/// Sign of the rates: of the growing range, or reversed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sign {
    AsPublished,
    Reversed,
    Unknown,
}

/// Result of all scans.
struct DirectionEstimate {
    /// Angle from the expected direction of motion to the one by the rates, radians.
    off_rad: f64,
    error_rad: f64,
    resultant: f64,
    scale: f64,
    sign: Sign,
    /// Detections found again with the sign as published, and with the opposite sign.
    found: [usize; 2],
    scans: usize,
    share: f64,
    /// Largest effect of rotation at the radar: m/s, and radians of its direction of motion.
    lever: [f64; 2],
}

impl Rule for RadarDoppler {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for radar in Radar::all(world) {
            if let Err((reason, why)) = judge_radar(world, &radar, limits, out) {
                out.not_evaluated(subject(&radar), reason, why);
            }
        }
    }
}

fn subject(radar: &Radar) -> String {
    format!("range rates of {}", radar.said.subject())
}

fn judge_radar(world: &Estimates, radar: &Radar, limits: &Limits, out: &mut Judge) -> Result<(), Reason> {
    let evidence = radar.evidence;
    if evidence.speeds == SpeedForm::Components && evidence.sideways == 0 {
        let why = format!(
            "`{}` are velocity components with the second always zero, so their axes are unknown",
            evidence.field
        );
        return Err((NotEvaluated::TooLittleEvidence, why));
    }
    let wanted = ScanCriteria {
        min_speed_m_s: limits.min_speed_m_s,
        min_detections: limits.min_detections,
        tolerance_m_s: limits.tolerance_m_s,
        tolerance_share: limits.tolerance_share,
    };
    let ways = MotionSource::all(world, radar);
    let of_way = |way| {
        let (all, enough) = scans(radar, way, &wanted);
        (way, all, enough)
    };
    // The first one with enough scans, else the one with the most.
    let mut best: Option<(&MotionSource, Vec<Scan>, usize)> = None;
    for way in &ways {
        let other = of_way(way);
        if best.as_ref().is_none_or(|best| other.1.len() > best.1.len()) {
            best = Some(other);
        }
        if best.as_ref().is_some_and(|best| best.1.len() >= limits.min_scans) {
            break;
        }
    }
    let Some((way, all, enough)) = best else {
        let why = "no poses or GNSS fixes to compare with: record poses of a frame, or fixes with a base, that TF ties to the radar";
        return Err((NotEvaluated::MissingInput, why.to_owned()));
    };
    let is_agreed = |scan: &&Scan| scan.share >= limits.min_share;
    let agreed: Vec<Scan> = all.iter().filter(is_agreed).copied().collect();
    if agreed.len() < limits.min_scans {
        let why = format!(
            "{enough} scans have {} detections, {} of these at more than {} m/s (by {}) and from enough directions, and in {} of these one \
             velocity explains {:.0} % of the detections; {} are needed",
            limits.min_detections,
            all.len(),
            limits.min_speed_m_s,
            way.subject,
            agreed.len(),
            limits.min_share * 100.0,
            limits.min_scans
        );
        return Err((NotEvaluated::TooLittleEvidence, why));
    }
    let is_still = |scan: &&Scan| scan.fitted.norm() <= limits.still * scan.expected.norm();
    let still = agreed.iter().filter(is_still).count() as f64 / agreed.len() as f64;
    if still >= limits.min_still {
        return judge_still(radar, way, &agreed, limits, out);
    }
    let moving: Vec<Scan> = agreed.iter().filter(|scan| !is_still(scan)).copied().collect();
    let seen = estimate(way, &moving, limits)?;
    judge_seen(world, radar, way, &seen, limits, out)
}

/// The rates of static objects are zero.
fn judge_still(
    radar: &Radar,
    way: &MotionSource,
    agreed: &[Scan],
    limits: &Limits,
    out: &mut Judge,
) -> Result<(), Reason> {
    let of = |value: fn(&Scan) -> f64| median(&agreed.iter().map(value).collect::<Vec<_>>()).unwrap_or(f64::NAN);
    let (speed, fitted) = (of(|scan| scan.expected.norm()), of(|scan| scan.fitted.norm()));
    let (share, as_expected) = (of(|scan| scan.share), of(|scan| scan.as_expected));
    let little = |why: String| Err((NotEvaluated::TooLittleEvidence, why));
    if radar.evidence.form == RadarForm::Tracks {
        return little("the velocities of the tracks are over ground, which does not show the mounting".to_owned());
    }
    // Among vehicles of the same speed most rates are zero as well, but those of the roadside are not.
    if as_expected > limits.max_as_expected {
        return little(format!(
            "most detections move with the platform, and {:.0} % have the rates of static objects: ambiguous",
            as_expected * 100.0
        ));
    }
    let subject = subject(radar);
    let message = format!(
        "{}: `{}` is already ego-compensated ({fitted:.2} m/s at a speed of {speed:.1} m/s)",
        topic(radar),
        radar.evidence.field
    );
    let finding = Finding::warning(subject, message, radar.place())
        .confidence(confidence(radar))
        .relation("ego-compensated")
        .detail(format!("Most detections show that velocity of the radar. The speed of the platform is by {}.", way.subject))
        .related(way.place.clone(), "compared with this motion")
        .measured(Measured::new("velocity of the radar by the rates", fitted, "m/s").limit(limits.still * speed).samples(agreed.len() as u64))
        .measured(Measured::new("speed of the platform", speed, "m/s").at_least(limits.min_speed_m_s))
        .measured(Measured::new("share of the detections that agree on the velocity", share, "1").at_least(limits.min_share))
        .measured(Measured::new("share of the detections with the rates of static objects", as_expected, "1").limit(limits.max_as_expected))
        .help(
            "publish the measured range rate, and the compensated rate in a field of its own: a consumer that compensates again sees static \
             objects move",
        );
    out.fail(finding);
    Ok(())
}

fn estimate(way: &MotionSource, scans: &[Scan], limits: &Limits) -> Result<DirectionEstimate, Reason> {
    let little = |why: String| Err((NotEvaluated::TooLittleEvidence, why));
    if scans.len() < limits.min_scans {
        return little(format!(
            "in some scans most detections move with the platform, and only {} other scans remain, {} are needed",
            scans.len(),
            limits.min_scans
        ));
    }
    let of = |value: &dyn Fn(&Scan) -> f64| median(&scans.iter().map(value).collect::<Vec<_>>()).unwrap_or(f64::NAN);
    let sideways_deg = of(&|scan| scan.body[0].y.abs().atan2(scan.body[0].x.abs())).to_degrees();
    if way.knows_forward() && sideways_deg > limits.max_sideways_deg {
        return little(format!(
            "by {} the platform moves {sideways_deg:.0} deg off its own x axis, so its orientation cannot verify a mounting",
            way.subject
        ));
    }
    let scale = of(&|scan| scan.fitted.norm() / scan.expected.norm());
    // Also true for NaN.
    if !(limits.min_scale..=limits.max_scale).contains(&scale) {
        return little(format!(
            "the speed by the range rates is {scale:.2} times that by {}, so the two cannot be compared",
            way.subject
        ));
    }
    let angle = |scan: &Scan| {
        difference(
            scan.fitted.y.atan2(scan.fitted.x),
            scan.expected.y.atan2(scan.expected.x),
        )
    };
    let runs: BTreeSet<usize> = scans.iter().map(|scan| scan.run).collect();
    let mean = circular_mean(scans.iter().map(|scan| (angle(scan), 1.0)));
    let steady = mean.filter(|mean| mean.resultant >= limits.min_resultant);
    let error = |sd_rad: f64| sd_rad / (runs.len() as f64).sqrt();
    let Some(mean) = steady.filter(|mean| error(mean.sd_rad()).to_degrees() <= limits.max_error_deg) else {
        return little(format!(
            "the angle between the directions of motion by the range rates and by {} is not steady",
            way.subject
        ));
    };
    let near = MatchGate {
        range_m: limits.near_m,
        angle_rad: limits.near_deg.to_radians(),
    };
    let found = found_again(scans, way, limits.least_way_m, near);
    let is_more =
        |more: usize, less: usize| more >= limits.min_found && more as f64 >= limits.found_ratio * less as f64;
    let sign = match found {
        [same, other] if is_more(same, other) => Sign::AsPublished,
        [same, other] if is_more(other, same) => Sign::Reversed,
        _ => Sign::Unknown,
    };
    let lever = |scan: &Scan| {
        let body = scan.body[0].xy();
        let turned = difference(scan.expected.y.atan2(scan.expected.x), body.y.atan2(body.x)).abs();
        [(scan.expected - body).norm(), turned]
    };
    let most = scans
        .iter()
        .map(lever)
        .fold([0.0_f64; 2], |[a, b], [c, d]| [a.max(c), b.max(d)]);
    Ok(DirectionEstimate {
        off_rad: mean.mean_rad,
        error_rad: error(mean.sd_rad()),
        resultant: mean.resultant,
        scale,
        sign,
        found,
        scans: scans.len(),
        share: of(&|scan| scan.share),
        lever: most,
    })
}

fn judge_seen(
    world: &Estimates,
    radar: &Radar,
    way: &MotionSource,
    seen: &DirectionEstimate,
    limits: &Limits,
    out: &mut Judge,
) -> Result<(), Reason> {
    let is_back = seen.off_rad.abs() > PI / 2.0;
    let half_turn_off_deg = (PI - seen.off_rad.abs()).to_degrees();
    let is_half_turn = half_turn_off_deg <= limits.half_turn_deg;
    if is_back && !way.knows_forward() && seen.sign != Sign::Reversed {
        let why = format!(
            "it moves backward by its range rates, and {} cannot distinguish forward from backward",
            way.subject
        );
        return Err((NotEvaluated::TooLittleEvidence, why));
    }
    let is_reversed = seen.sign == Sign::Reversed;
    let is_open = seen.sign == Sign::Unknown && is_half_turn;
    if is_reversed || is_open {
        out.fail(reversed(radar, way, seen, is_reversed, limits));
    }
    // With the correct sign, the direction of motion is opposite.
    let off_rad = if is_reversed || is_open {
        wrapped(seen.off_rad + PI)
    } else {
        seen.off_rad
    };
    let off_deg = off_rad.abs().to_degrees();
    if off_deg <= limits.pass_deg {
        if !(is_reversed || is_open) {
            out.pass(subject(radar), measured(seen, off_rad, limits));
        }
        return Ok(());
    }
    if off_deg <= limits.pass_deg + 2.0 * seen.error_rad.to_degrees() {
        if is_reversed || is_open {
            return Ok(());
        }
        let why = format!(
            "the mounting is missing a yaw of {off_deg:.1} +- {:.1} deg, {} deg are allowed",
            seen.error_rad.to_degrees(),
            limits.pass_deg
        );
        return Err((NotEvaluated::TooLittleEvidence, why));
    }
    let finding = turned(radar, way, seen, off_rad, limits);
    out.fail(with_mounting(world, [&way.body, &way.radar], finding));
    Ok(())
}

/// The rates are positive for approaching objects.
fn reversed(radar: &Radar, way: &MotionSource, seen: &DirectionEstimate, is_sure: bool, limits: &Limits) -> Finding {
    const NEGATE: &str = "publish range rates that are negative for approaching objects (v_r = -v . d for static ones), or configure the \
                          sign of this driver in every consumer";
    let (name, mounting) = (topic(radar), format!("`{}` -> `{}`", way.body, way.radar));
    let (relation, message, detail, help) = if is_sure {
        (
            "doppler-sign",
            format!("{name}: range rates have the wrong sign (positive when approaching)"),
            "Detections are found again in later scans where rates of the opposite sign predict them.".to_owned(),
            NEGATE.to_owned(),
        )
    } else {
        (
            "doppler-sign-or-half-turn",
            format!("{name}: wrong sign of the range rates, or {mounting} is missing a yaw of 180 deg"),
            format!(
                "By the rates the radar moves backward while {} moves forward. The detections cannot distinguish the two causes.",
                way.subject
            ),
            format!(
                "look at the range rate of an object that the radar approaches, then:\n(1) if positive, {NEGATE}\n\
                 (2) if negative, add 180 deg to the yaw of {mounting}"
            ),
        )
    };
    Finding::warning(subject(radar), message, radar.place())
        .confidence(confidence(radar))
        .relation(relation)
        .detail(detail)
        .related(way.place.clone(), "compared with this motion")
        .help(help)
        .measured(measured(seen, seen.off_rad, limits))
}

/// The mounting is missing a yaw.
fn turned(radar: &Radar, way: &MotionSource, seen: &DirectionEstimate, off_rad: f64, limits: &Limits) -> Finding {
    let off_deg = off_rad.to_degrees();
    // The direction by the rates is rotated as the stated mounting is against the true one.
    let lacks_deg = -off_deg;
    let (_, _, stated_yaw) = way.body_from_radar.rotation.euler_angles();
    // A reversed azimuth mirrors the direction of motion at the axis of the radar.
    let mirrored = difference(off_rad, 2.0 * stated_yaw).abs().to_degrees() <= limits.half_turn_deg
        && stated_yaw.abs().to_degrees() > limits.half_turn_deg / 2.0;
    let mounting = format!("`{}` -> `{}`", way.body, way.radar);
    let add = format!(
        "add {lacks_deg:+.1} deg to the yaw of {mounting} (about z of `{}`), and keep the translation",
        way.body
    );
    let (also, help) = if mirrored {
        (
            " Alternatively, the azimuths of the radar may count clockwise: that rotates the direction by twice the yaw of the mounting.",
            format!(
                "check how the azimuths of the radar count, seen from above, then:\n(1) if counter-clockwise, {add}\n\
                 (2) if clockwise, negate the azimuths"
            ),
        )
    } else {
        ("", add)
    };
    let message = format!(
        "{mounting} is missing a yaw of {lacks_deg:+.1} deg, by the range rates of {}",
        topic(radar)
    );
    let detail = format!(
        "By the range rates of static objects, the direction of motion is rotated by {off_deg:+.1} deg from that of {}. The mounting needs the opposite \
         rotation.{also}",
        way.subject
    );
    let finding = if off_deg.abs() > limits.error_deg {
        Finding::error(subject(radar), message, radar.place())
    } else {
        Finding::warning(subject(radar), message, radar.place())
    };
    finding
        .confidence(confidence(radar))
        .relation("mount-yaw")
        .detail(detail)
        .related(way.place.clone(), "compared with this motion")
        .help(help)
        .measured(measured(seen, off_rad, limits))
}

fn measured(seen: &DirectionEstimate, off_rad: f64, limits: &Limits) -> Vec<Measured> {
    let [lever_m_s, lever_rad] = seen.lever;
    let [same, other] = seen.found;
    vec![
        Measured::new(
            "direction of motion by the rates, minus that of the platform",
            off_rad.to_degrees(),
            "deg",
        )
        .limit(limits.pass_deg)
        .spread(seen.error_rad.to_degrees())
        .samples(seen.scans as u64),
        Measured::new(
            "steadiness of that difference (1: always the same)",
            seen.resultant,
            "1",
        )
        .at_least(limits.min_resultant),
        Measured::new("speed by the rates / speed of the platform", seen.scale, "1"),
        Measured::new("share of the detections that agree on the velocity", seen.share, "1").at_least(limits.min_share),
        Measured::new(
            "largest velocity of the radar by yaw rate and lever arm",
            lever_m_s,
            "m/s",
        ),
        Measured::new(
            "largest change of direction by yaw rate and lever arm",
            lever_rad.to_degrees(),
            "deg",
        ),
        Measured::count("detections found where the rates as published predict them", same),
        Measured::count("detections found where rates of the opposite sign predict them", other),
    ]
}

/// The name of its topic in messages.
fn topic(radar: &Radar) -> String {
    let subject = radar.said.subject();
    subject.trim_start_matches("topic ").to_owned()
}

fn confidence(radar: &Radar) -> Confidence {
    if radar.is_guessed() {
        Confidence::Hint
    } else {
        Confidence::Likely
    }
}
