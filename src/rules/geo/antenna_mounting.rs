//! GEO08: the mounting transform of a GNSS antenna, compared with how the fixes move while the platform turns.

use nalgebra::{Isometry3, Vector2};

use crate::analysis::geo::antenna::{AntennaEstimate, Antennas, Limits};
use crate::analysis::geo::overlay::body_from_antenna;
use crate::analysis::motion::{BagMotion, Motion, Stream};
use crate::analysis::{names, names::Standard};
use crate::rules::prelude::*;
use crate::world::motion::PoseRow;

pub(crate) struct AntennaMounting;

impl Rule for AntennaMounting {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for (index, bag) in Motion::of(world).bags.iter().enumerate() {
            for receiver in 0..bag.fixes.len() {
                judge_receiver(world, (index, bag), receiver, limits, out);
            }
        }
    }
}

fn judge_receiver(
    world: &Estimates,
    (index, bag): (usize, &BagMotion),
    receiver: usize,
    limits: &Limits,
    out: &mut Judge,
) {
    let Some(fixes) = bag.fixes.get(receiver) else { return };
    let subject = format!("antenna of {}", fixes.subject);
    let stated = |poses: &Stream<PoseRow>| body_from_antenna(world, poses, fixes);
    if bag.ways().all(|poses| stated(poses).is_none()) {
        let why = format!(
            "no transform connects {} of the fixes with the child frame of recorded poses",
            fixes.frame_name()
        );
        return out.missing(subject, why);
    }
    let is_of_fixes = |poses: &Stream<PoseRow>| {
        let kind = poses.frame.as_ref().and_then(|frame| names::standard(frame));
        matches!(kind, Some((_, Standard::Map | Standard::Earth)))
    };
    let antennas = Antennas::of(world);
    let best = |of_fixes: bool| {
        let is_used = |poses: &Stream<PoseRow>| is_of_fixes(poses) == of_fixes && stated(poses).is_some();
        antennas.best((index, bag), receiver, is_used)
    };
    let best = best(false).or_else(|| best(true));
    let Some((poses, antenna, stated)) = best.and_then(|(poses, antenna)| Some((poses, antenna, stated(poses)?)))
    else {
        let why = format!(
            "in fewer than {} windows the poses turn, and the fixes follow them: record left and right turns with changes of speed",
            limits.min_windows
        );
        return out.too_little(subject, why);
    };
    let place = stated.translation.vector.xy();
    let off = antenna.place_m - place;
    let error = limits.sigmas * antenna.error_m;
    let (body, frame) = (poses.child_name(), fixes.frame_name());
    // Near a singular motion (a circle) the few windows may understate a large error.
    let is_shown = antenna.error_m.map(|error| error <= limits.max_off_m);
    let is_off = off.zip_zip_map(&error, &is_shown, |off, error, is_shown| {
        is_shown && off.abs() > limits.max_off_m.max(error)
    });
    let measured = measured(antenna, place, &body);
    if !(is_off.x || is_off.y) {
        if error.max() > limits.max_off_m {
            let why = format!(
                "the fixes show the antenna in {body} only to +-{:.1} m along x and +-{:.1} m along y ({} standard errors), {} m are needed: \
                 record more left and right turns with changes of speed, with an RTK receiver",
                error.x, error.y, limits.sigmas, limits.max_off_m
            );
            return out.too_little(subject, why);
        }
        if is_of_fixes(poses) {
            let why = format!(
                "the poses in {} may be computed from the fixes with this transform, so their agreement shows nothing: record odometry",
                poses.frame_name()
            );
            return out.too_little(subject, why);
        }
        return out.pass(subject, measured);
    }
    let shown = |place: f64, is_shown: bool| {
        if is_shown {
            format!("{place:.2}")
        } else {
            "unknown".to_owned()
        }
    };
    let (x, y) = (
        shown(antenna.place_m.x, is_shown.x),
        shown(antenna.place_m.y, is_shown.y),
    );
    let message = format!(
        "`{}`: by the turns, the antenna is at ({x}, {y}) m in {body}, stated ({:.2}, {:.2}) m",
        fixes.topic, place.x, place.y
    );
    let finding = Finding::warning(subject, message, fixes.place())
        .likely()
        .detail(format!("Stated by the transform {body} -> {frame}."))
        .related(poses.place(), "compared with these poses");
    let finding = match named(&stated, antenna, limits) {
        Some((relation, what, help)) => finding.relation(relation).detail(what).help(help),
        None => finding
            .detail(format!(
                "Another possible cause: the poses of {} are of another point than {body}.",
                poses.subject
            ))
            .help(format!(
                "measure the antenna from the origin of {body}, and correct the translation of {body} -> {frame}"
            )),
    };
    out.fail(finding.measured(measured));
}

fn measured(antenna: &AntennaEstimate, place: Vector2<f64>, body: &str) -> [Measured; 3] {
    let row = |axis: &str, measured: f64, stated: f64, error: f64| {
        Measured::new(format!("{axis} of the antenna in {body}, by the fixes"), measured, "m")
            .expected(stated)
            .spread(error)
            .samples(antenna.steps as u64)
    };
    [
        row("x", antenna.place_m.x, place.x, antenna.error_m.x),
        row("y", antenna.place_m.y, place.y, antenna.error_m.y),
        Measured::new("delay of the fixes, by their time of arrival", antenna.late_s.0, "s").spread(antenna.late_s.1),
    ]
}

/// The mistake that explains the stated transform: its relation, a sentence, and what to do.
fn named(
    stated: &Isometry3<f64>,
    antenna: &AntennaEstimate,
    limits: &Limits,
) -> Option<(&'static str, &'static str, &'static str)> {
    let [x, y] = stated.translation.vector.xy().into();
    let inverse = stated.inverse().translation.vector;
    let near = (limits.sigmas * antenna.error_m).map(|error| error.max(0.5 * limits.max_off_m));
    let fits = |[x, y]: [f64; 2]| {
        let off = (antenna.place_m - Vector2::new(x, y)).abs();
        off.x <= near.x && off.y <= near.y
    };
    if x == 0.0 && y == 0.0 {
        let help = "measure the antenna from the origin of the poses' child frame, and write the translation into its transform";
        return Some(("translation-lost", "The translation is missing.", help));
    }
    let candidates = [
        (
            [inverse.x, inverse.y],
            "inverse",
            "The inverse of the transform fits.",
            "invert the transform",
        ),
        (
            [x, -y],
            "mirrored-y",
            "The transform with y negated fits.",
            "negate y of the translation: y points to the left (REP-103)",
        ),
        (
            [-x, y],
            "x-negated",
            "The transform with x negated fits.",
            "negate x of the translation: x points forward (REP-103)",
        ),
        (
            [y, x],
            "swap-xy",
            "The transform with x and y exchanged fits.",
            "exchange x and y of the translation: x points forward, y to the left (REP-103)",
        ),
        (
            [y, -x],
            "left-z90",
            "The translation rotated by -90 deg about z fits.",
            "rotate the translation by -90 deg about z: x points forward, y to the left (REP-103)",
        ),
        (
            [-y, x],
            "left-z-90",
            "The translation rotated by 90 deg about z fits.",
            "rotate the translation by 90 deg about z: x points forward, y to the left (REP-103)",
        ),
        (
            [0.0, 0.0],
            "translation-added",
            "The fixes move as the origin of the poses.",
            "correct the cause that applies:\n\
             (1) the receiver (an INS) publishes the position of its reference point: set `frame_id` of the fixes to the frame of that point\n\
             (2) the poses are computed from these fixes as if the antenna were at that origin: give the estimator the position of the antenna\n\
             (3) the antenna is at that origin: correct the translation of the transform",
        ),
        (
            [x / 1000.0, y / 1000.0],
            "millimetres",
            "The translation is in millimetres.",
            "write the translation in metres",
        ),
    ];
    let fitting: Vec<_> = candidates.into_iter().filter(|(place, ..)| fits(*place)).collect();
    let ([first_x, first_y], word, what, help) = *fitting.first()?;
    // Where a coordinate is hardly known, several mistakes fit.
    let is_same = |[x, y]: [f64; 2]| (x - first_x).hypot(y - first_y) <= limits.max_off_m;
    fitting
        .iter()
        .all(|(place, ..)| is_same(*place))
        .then_some((word, what, help))
}
