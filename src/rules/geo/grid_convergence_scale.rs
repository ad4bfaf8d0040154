//! GEO04: a map that is rotated and scaled like the UTM grid.

use crate::analysis::geo::grid::{Grid, GridFit};
use crate::analysis::geo::overlay::{Overlay, is_way};
use crate::analysis::motion::{Motion, Stream};
use crate::analysis::names;
use crate::rules::prelude::*;
use crate::world::motion::{FixRow, PoseRow};
use crate::world::{EarthOrigin, FrameId, World};

pub(crate) struct GridConvergenceScale;

/// Words in names of frames that are a grid.
const GRIDS: &[&str] = &["utm", "mgrs", "grid"];

/// Projections of Autoware's `map_projector_info` that are this grid.
const PROJECTIONS: &[&str] = &["MGRS", "LocalCartesianUTM", "UTM"];

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    max_angle_deg: f64,
    max_scale: f64,
    sigmas: f64,
    min_convergence_deg: f64,
    min_extent_m: f64,
    min_points: usize,
    blocks: usize,
    on_grid_m: f64,
    follow_scale: f64,
    follow_share: f64,
    errors_last_s: f64,
    untold_m: f64,
}

impl Rule for GridConvergenceScale {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for bag in &Motion::of(world).bags {
            for fixes in &bag.fixes {
                for poses in bag.poses.iter().filter(|poses| is_way(poses)) {
                    judge_pair(world, poses, fixes, limits, out);
                }
            }
        }
    }
}

fn judge_pair(world: &World, poses: &Stream<PoseRow>, fixes: &Stream<FixRow>, limits: &Limits, out: &mut Judge) {
    let subject = format!("{} against {}", poses.subject, fixes.subject);
    let too_little = NotEvaluated::TooLittleEvidence;
    let Some(overlay) = Overlay::of(world, poses, fixes) else {
        return out.not_evaluated(subject, too_little, "poses and fixes do not overlap in time");
    };
    let (points, extent_m) = (overlay.both.len(), overlay.extent_m());
    if points < limits.min_points || extent_m < limits.min_extent_m {
        let why = format!(
            "{points} fixes over {extent_m:.0} m have poses at the same time; {} over {:.0} m are needed to measure rotation and scale",
            limits.min_points, limits.min_extent_m
        );
        return out.not_evaluated(subject, too_little, why);
    }
    if overlay.fit(limits.follow_scale, limits.follow_share).is_none() {
        let why = "the poses do not follow the fixes: no rotation, scale and shift takes one track to the other";
        return out.not_evaluated(subject, too_little, why);
    }
    let Some(grid_fit) = GridFit::of(&overlay, limits.blocks) else {
        return out.not_applicable(
            subject,
            "the place is outside of the UTM zones, or the platform does not move",
        );
    };
    let receiver = overlay.receiver_deviation(limits.errors_last_s, limits.untold_m);
    let sigmas = |angle_rad: f64, scale: f64| (limits.sigmas * angle_rad.to_degrees(), limits.sigmas * scale);
    // A grid is recognised by the scatter alone; that it is none must hold for all errors that the receiver may have.
    let narrow = sigmas(grid_fit.deviations.0, grid_fit.deviations.1);
    let (angle_deg, scale) = sigmas(
        grid_fit.deviations.0.hypot(receiver),
        grid_fit.deviations.1.hypot(receiver),
    );
    let fits = |grid: &Grid, (angle_deg, scale): (f64, f64)| {
        let (angle_off, scale_off) = grid_fit.beside(grid);
        angle_off.abs().to_degrees() <= limits.max_angle_deg + angle_deg && scale_off.abs() <= limits.max_scale + scale
    };
    let measured = measured(&grid_fit, points as u64, limits);
    if !grid_fit.grids.iter().any(|grid| fits(grid, (angle_deg, scale))) {
        return out.pass(subject, measured);
    }
    let is_sure = narrow.0 <= limits.max_angle_deg && narrow.1 <= limits.max_scale;
    let found = grid_fit
        .grids
        .iter()
        .find(|grid| fits(grid, narrow))
        .filter(|_| is_sure);
    let Some(grid) = found else {
        let why = format!(
            "the poses are rotated by {:.2} +- {angle_deg:.2} deg and scaled by {:.5} +- {scale:.5} from the fixes: too uncertain to \
             distinguish ENU from the UTM grid (within {} deg and {} is needed)",
            grid_fit.fit.angle_rad.to_degrees(),
            grid_fit.fit.scale,
            limits.max_angle_deg,
            limits.max_scale
        );
        return out.not_evaluated(subject, too_little, why);
    };
    let convergence_deg = grid.fit.angle_rad.to_degrees();
    if convergence_deg.abs() < limits.min_convergence_deg {
        let why = format!(
            "grid north is {convergence_deg:.2} deg from true north here, near the middle of zone {}; at least {} deg are needed to \
             distinguish them",
            grid.zone, limits.min_convergence_deg
        );
        return out.not_evaluated(subject, too_little, why);
    }
    let is_said = |origin: &EarthOrigin| {
        origin
            .projection
            .as_deref()
            .is_some_and(|name| PROJECTIONS.contains(&name))
    };
    if is_meant(poses.frame.as_ref(), grid, limits) || world.origins.iter().any(is_said) {
        return out.pass(subject, measured);
    }
    let finding = finding(&subject, &overlay, poses, fixes, &grid_fit, grid);
    out.fail(finding.measured(measured));
}

/// Whether the frame is a grid by its name or by its coordinates.
fn is_meant(frame: Option<&FrameId>, grid: &Grid, limits: &Limits) -> bool {
    frame.is_some_and(|frame| names::has_word(frame, GRIDS))
        || grid.off_m <= limits.on_grid_m
        || grid.off_in_square_m <= limits.on_grid_m
}

fn measured(grid_fit: &GridFit, points: u64, limits: &Limits) -> Vec<Measured> {
    let mut all = vec![
        Measured::new(
            "rotation of the poses from ENU",
            grid_fit.fit.angle_rad.to_degrees(),
            "deg",
        )
        .spread(grid_fit.deviations.0.to_degrees())
        .samples(points),
        Measured::new("scale of the poses from ENU", grid_fit.fit.scale, "1")
            .spread(grid_fit.deviations.1)
            .samples(points),
    ];
    if let Some(grid) = grid_fit.grids.first() {
        let (angle, scale) = grid_fit.beside(grid);
        all.push(
            Measured::new("rotation of the poses from the UTM grid", angle.to_degrees(), "deg")
                .turn()
                .limit(limits.max_angle_deg),
        );
        all.push(Measured::new("scale of the poses from the UTM grid, minus 1", scale, "1").limit(limits.max_scale));
    }
    all
}

fn finding(
    subject: &str,
    overlay: &Overlay,
    poses: &Stream<PoseRow>,
    fixes: &Stream<FixRow>,
    grid_fit: &GridFit,
    grid: &Grid,
) -> Finding {
    let frame = poses.frame.as_ref().map_or("?", FrameId::as_str);
    let (from, to) = overlay.span_s();
    let (angle, of_grid) = (grid_fit.fit.angle_rad.to_degrees(), grid.fit.angle_rad.to_degrees());
    let message = format!(
        "{}: `{frame}` is the grid of UTM zone {}, not ENU: rotated by {angle:.3} deg, scaled by {:.5}",
        poses.subject, grid.zone, grid_fit.fit.scale
    );
    let clockwise = if of_grid > 0.0 {
        "clockwise"
    } else {
        "counter-clockwise"
    };
    let aside = 1e3 * grid.fit.angle_rad.sin().abs();
    let longer = 1e3 * (grid.fit.scale - 1.0);
    let detail = format!(
        "Measured against `{}` from {from:.0} to {to:.0} s: {angle:.3} +- {:.3} deg, scale {:.5} +- {:.5}. Expected at this place: \
         {of_grid:.3} deg and {:.5} in the UTM grid, 0 deg and 1 in ENU. In `{frame}`, headings from true north are off by \
         {of_grid:.2} deg, and a point at 1 km is off by {aside:.1} m sideways and {longer:+.2} m in distance.",
        fixes.topic,
        grid_fit.deviations.0.to_degrees(),
        grid_fit.fit.scale,
        grid_fit.deviations.1,
        grid.fit.scale,
    );
    Finding::warning(subject, message, poses.place())
        .likely()
        .relation("utm-grid")
        .detail(detail)
        .related(fixes.place(), "the fixes")
        .help(format!(
            "do one of these:\n(1) navsat_transform: set `use_local_cartesian: true`\n(2) another program: rotate the positions by {:.4} deg \
             {clockwise} and divide by {:.6}\n(3) the grid is intended: put `utm` into the name of `{frame}`",
            of_grid.abs(),
            grid.fit.scale
        ))
}
