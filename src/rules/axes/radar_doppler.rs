//! AXES15: a radar's range rates against the motion of its platform: their sign, the yaw of its mounting, and whether the motion has
//! been taken out of them already.

use std::collections::BTreeSet;
use std::f64::consts::PI;

use crate::analysis::radar::{Radar, Scan, Wanted, Way, found_again, scans};
use crate::math::circular::{circular_mean, difference, wrapped};
use crate::math::{doppler::Near, stats::median};
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
type Why = (NotEvaluated, String);

/// Which way the ranges go that the rates tell of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sign {
    AsPublished,
    Reversed,
    Unknown,
}

/// What the scans say together.
struct Seen {
    /// From the expected direction of the way to the one by the rates, radians.
    off_rad: f64,
    error_rad: f64,
    resultant: f64,
    scale: f64,
    sign: Sign,
    /// Detections found again with the sign as published, and with the other.
    found: [usize; 2],
    scans: usize,
    share: f64,
    /// What turning adds at the radar, at most: m/s, and radians of the direction of its way.
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

fn judge_radar(world: &Estimates, radar: &Radar, limits: &Limits, out: &mut Judge) -> Result<(), Why> {
    let evidence = radar.evidence;
    if evidence.speeds == SpeedForm::Components && evidence.sideways == 0 {
        let why = format!(
            "`{}` are components of which the second is always zero: nothing says along what",
            evidence.field
        );
        return Err((NotEvaluated::TooLittleEvidence, why));
    }
    let wanted = Wanted {
        min_speed_m_s: limits.min_speed_m_s,
        min_detections: limits.min_detections,
        tolerance_m_s: limits.tolerance_m_s,
        tolerance_share: limits.tolerance_share,
    };
    let ways = Way::all(world, radar);
    let of_way = |way| {
        let (all, enough) = scans(radar, way, &wanted);
        (way, all, enough)
    };
    // The first that is there often enough; else the one with the most scans.
    let mut best: Option<(&Way, Vec<Scan>, usize)> = None;
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
        let why = "no poses of a frame that its own is tied to, and no satellite fixes with a base that it is tied to, say how fast it goes";
        return Err((NotEvaluated::MissingInput, why.to_owned()));
    };
    let is_agreed = |scan: &&Scan| scan.share >= limits.min_share;
    let agreed: Vec<Scan> = all.iter().filter(is_agreed).copied().collect();
    if agreed.len() < limits.min_scans {
        let why = format!(
            "{enough} scans have {} detections, {} of these at more than {} m/s by {} and from enough directions, and in {} one velocity \
             explains {:.0} % of them; {} are needed",
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
    let seen = seen(way, &moving, limits)?;
    judge_seen(radar, way, &seen, limits, out)
}

/// The rates of what stands still are zero.
fn judge_still(radar: &Radar, way: &Way, agreed: &[Scan], limits: &Limits, out: &mut Judge) -> Result<(), Why> {
    let of = |value: fn(&Scan) -> f64| median(&agreed.iter().map(value).collect::<Vec<_>>()).unwrap_or(f64::NAN);
    let (speed, fitted) = (of(|scan| scan.expected.norm()), of(|scan| scan.fitted.norm()));
    let (share, as_expected) = (of(|scan| scan.share), of(|scan| scan.as_expected));
    let little = |why: String| Err((NotEvaluated::TooLittleEvidence, why));
    if radar.evidence.form == RadarForm::Tracks {
        return little(
            "the tracks' velocities are those over ground, which their type leaves open: they do not show the mounting"
                .to_owned(),
        );
    }
    // Among vehicles of the same speed most rates are nothing, too, but those of the roadside are not.
    if as_expected > limits.max_as_expected {
        return little(format!(
            "most detections move with the platform, and {:.0} % have the rates of what stands still: both are likely",
            as_expected * 100.0
        ));
    }
    let subject = subject(radar);
    let message = format!(
        "`{}` on {} is {fitted:.2} m/s by what most detections agree on, at {speed:.1} m/s by {}: the platform's own motion has been taken out \
         of it already",
        radar.evidence.field,
        radar.said.subject(),
        way.subject
    );
    let finding = Finding::warning(subject, message, radar.place())
        .confidence(confidence(radar))
        .relation("ego-compensated")
        .related(way.place.clone(), "how fast it goes")
        .measured(Measured::new("velocity by the rates", fitted, "m/s").limit(limits.still * speed).samples(agreed.len() as u64))
        .measured(Measured::new("speed", speed, "m/s").limit(limits.min_speed_m_s))
        .measured(Measured::new("share of the detections that agree", share, "1").limit(limits.min_share))
        .measured(Measured::new("share with the rates of what stands still", as_expected, "1").limit(limits.max_as_expected))
        .help(
            "publish the measured range rate, and the compensated one in a field of its own: who takes the motion out once more gets \
             the whole street moving",
        );
    out.fail(finding);
    Ok(())
}

fn seen(way: &Way, scans: &[Scan], limits: &Limits) -> Result<Seen, Why> {
    let little = |why: String| Err((NotEvaluated::TooLittleEvidence, why));
    if scans.len() < limits.min_scans {
        return little(format!(
            "what most detections agree on moves with the platform in some scans, and {} others are too few; {} are needed",
            scans.len(),
            limits.min_scans
        ));
    }
    let of = |value: &dyn Fn(&Scan) -> f64| median(&scans.iter().map(value).collect::<Vec<_>>()).unwrap_or(f64::NAN);
    let sideways_deg = of(&|scan| scan.body[0].y.abs().atan2(scan.body[0].x.abs())).to_degrees();
    if way.knows_forward() && sideways_deg > limits.max_sideways_deg {
        return little(format!(
            "by {} the platform goes {sideways_deg:.0} deg aside of its own x axis: its orientation is no measure for a mounting",
            way.subject
        ));
    }
    let scale = of(&|scan| scan.fitted.norm() / scan.expected.norm());
    // Also true where it is no number.
    if !(limits.min_scale..=limits.max_scale).contains(&scale) {
        return little(format!(
            "by the range rates it goes {scale:.2} times as fast as by {}: one of them is no measure for the other",
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
            "the way by the range rates and that by {} have no steady angle between them",
            way.subject
        ));
    };
    let near = Near {
        range_m: limits.near_m,
        angle_rad: limits.near_deg.to_radians(),
    };
    let found = found_again(scans, way, limits.least_way_m, near);
    let is_more =
        |more: usize, less: usize| more >= limits.min_found && more as f64 >= limits.found_ratio * less as f64;
    let sign = match found {
        [told, other] if is_more(told, other) => Sign::AsPublished,
        [told, other] if is_more(other, told) => Sign::Reversed,
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
    Ok(Seen {
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

fn judge_seen(radar: &Radar, way: &Way, seen: &Seen, limits: &Limits, out: &mut Judge) -> Result<(), Why> {
    let is_back = seen.off_rad.abs() > PI / 2.0;
    let half_turn_off_deg = (PI - seen.off_rad.abs()).to_degrees();
    let is_half_turn = half_turn_off_deg <= limits.half_turn_deg;
    if is_back && !way.knows_forward() && seen.sign != Sign::Reversed {
        let why = format!(
            "it goes backward by its range rates, and {} do not tell forward from backward",
            way.subject
        );
        return Err((NotEvaluated::TooLittleEvidence, why));
    }
    let is_reversed = seen.sign == Sign::Reversed;
    let is_open = seen.sign == Sign::Unknown && is_half_turn;
    if is_reversed || is_open {
        out.fail(reversed(radar, way, seen, is_reversed, limits));
    }
    // With the sign as it should be, the way lies opposite.
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
            "the mounting lacks a yaw of {off_deg:.1} deg, give or take {:.1}, and {} are allowed",
            seen.error_rad.to_degrees(),
            limits.pass_deg
        );
        return Err((NotEvaluated::TooLittleEvidence, why));
    }
    out.fail(turned(radar, way, seen, off_rad, limits));
    Ok(())
}

/// The sign of the rates is that of approaching.
fn reversed(radar: &Radar, way: &Way, seen: &Seen, is_sure: bool, limits: &Limits) -> Finding {
    let [told, other] = seen.found;
    let name = format!("`{}` on {}", radar.evidence.field, radar.said.subject());
    let (relation, message) = if is_sure {
        let message = format!(
            "{name} has the sign of approaching: {other} detections are found again where they would be if it did, {told} if it had \
             that of a range that grows"
        );
        ("doppler-sign", message)
    } else {
        let message = format!(
            "{name} makes the radar go backward where {} goes forward: it has the sign of approaching, or `{}_from_{}` lacks half a turn \
             about z; which of the two, the detections do not show",
            way.subject, way.body, way.radar
        );
        ("doppler-sign-or-half-turn", message)
    };
    Finding::warning(subject(radar), message, radar.place())
        .confidence(confidence(radar))
        .relation(relation)
        .related(way.place.clone(), "how it goes")
        .help(
            "publish range rates: negative for what comes nearer, v_r = -v . d for what stands still; or tell every consumer the sign of \
             this driver",
        )
        .measured(measured(seen, seen.off_rad, limits))
}

/// The mounting lacks a yaw.
fn turned(radar: &Radar, way: &Way, seen: &Seen, off_rad: f64, limits: &Limits) -> Finding {
    let off_deg = off_rad.to_degrees();
    // The way by the rates is turned as the mounting that was told is turned against the true one.
    let lacks_deg = -off_deg;
    let (_, _, told_yaw) = way.body_from_radar.rotation.euler_angles();
    // An azimuth that counts the other way mirrors the way at the axis of the radar.
    let mirrored = difference(off_rad, 2.0 * told_yaw).abs().to_degrees() <= limits.half_turn_deg
        && told_yaw.abs().to_degrees() > limits.half_turn_deg / 2.0;
    let also = if mirrored {
        "; or its azimuths count clockwise, which turns the way by twice the mounting's yaw"
    } else {
        ""
    };
    let message = format!(
        "`{}_from_{}` lacks a yaw of {lacks_deg:+.1} deg: what stands still around {} comes from another side than {} goes to{also}",
        way.body,
        way.radar,
        radar.said.subject(),
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
        .related(way.place.clone(), "how it goes")
        .help(format!(
            "turn the mounting by {lacks_deg:+.1} deg about z of `{}`, in front of the rotation that is there",
            way.body
        ))
        .measured(measured(seen, off_rad, limits))
}

fn measured(seen: &Seen, off_rad: f64, limits: &Limits) -> Vec<Measured> {
    let [lever_m_s, lever_rad] = seen.lever;
    let [told, other] = seen.found;
    vec![
        Measured::new(
            "yaw between the way by the rates and by the platform",
            off_rad.to_degrees(),
            "deg",
        )
        .limit(limits.pass_deg)
        .spread(seen.error_rad.to_degrees())
        .samples(seen.scans as u64),
        Measured::new("resultant", seen.resultant, "1").limit(limits.min_resultant),
        Measured::new("speed by the rates over that of the platform", seen.scale, "1"),
        Measured::new("share of the detections that agree", seen.share, "1").limit(limits.min_share),
        Measured::new(
            "what turning adds at the radar (yaw rate times lever arm), at most",
            lever_m_s,
            "m/s",
        ),
        Measured::new(
            "direction that this turns its way by, at most",
            lever_rad.to_degrees(),
            "deg",
        ),
        Measured::count("detections found again with the sign as published", told),
        Measured::count("detections found again with the other sign", other),
    ]
}

fn confidence(radar: &Radar) -> Confidence {
    if radar.is_guessed() {
        Confidence::Hint
    } else {
        Confidence::Likely
    }
}
