//! Maps of a lidar's landmarks by the poses of its platform: with the right mounting, static objects stay in one place.
//!
//! Owns which points are mapped. With a yaw error of 180 degrees, landmarks move twice as fast as the platform. Must not judge.

use nalgebra::{Isometry3, Point3};

use crate::analysis::hand_eye::{is_by_scans, pose_at, tied};
use crate::analysis::motion::{Motion, Orientations};
use crate::analysis::{Estimates, lidar::Clouds, scan_motion::moved::Moment};
use crate::math::crispness::occupied_cells;
use crate::verdict::NotEvaluated;
use crate::world::FrameId;

/// Parameters of a map.
#[derive(Clone, Copy, Debug)]
#[expect(clippy::struct_field_names, reason = "the unit belongs to the name")]
pub(crate) struct Grid {
    /// Size of a cell, metres.
    pub(crate) cell_m: f64,
    /// Points further above or below the sensor are left out, metres: rings on the ground move with it.
    pub(crate) level_m: f64,
    /// Minimum distance that the platform moves in total, metres.
    pub(crate) way_m: f64,
}

/// Maps of one lidar under several mountings.
pub(crate) struct Maps {
    /// The frame that the poses move.
    pub(crate) body: FrameId,
    /// Name of the poses in reports, and their place.
    pub(crate) poses: (String, crate::source::Place),
    /// Distance that the platform moved while it was mapped, metres.
    pub(crate) way_m: f64,
    /// Cells with points under each mounting, in order.
    pub(crate) cells: Vec<usize>,
}

/// Maps the clouds of each run with `body_from_lidar * turn`, for each of these turns; or why that is not possible.
pub(crate) fn maps(
    world: &Estimates,
    clouds: &Clouds,
    turns: &[Isometry3<f64>],
    grid: &Grid,
) -> Result<Maps, (NotEvaluated, String)> {
    let missing = |why: &str| (NotEvaluated::MissingInput, why.to_owned());
    let motion = Motion::of(world);
    let lidar = clouds.frame().ok_or_else(|| missing(clouds.frameless()))?;
    let tied = tied(world, &motion, clouds, &lidar);
    let own = tied.into_iter().filter(|(poses, ..)| !is_by_scans(poses));
    let (poses, body, stated) = own.max_by_key(|(poses, ..)| poses.rows().count()).ok_or_else(|| {
        missing("no poses to compare with: record those of a frame that TF ties to the lidar, other than from scans")
    })?;
    let (turned, track) = (Orientations::of(poses), poses.track());
    let start_ns = clouds.bag.start_ns.unwrap_or_default();
    let mut way_m = 0.0;
    let mut cells = vec![0; turns.len()];
    for run in &clouds.evidence.runs {
        let mut placed: Vec<(Isometry3<f64>, &[[f64; 3]])> = Vec::new();
        for slice in run {
            let t_s = Moment::new(slice.stamp_ns, slice.log_ns, start_ns).on(poses.stamp_offset_s);
            if let Some(pose) = track.at(t_s).and_then(|place| pose_at(&turned, &place, t_s)) {
                placed.push((pose, &slice.points));
            }
        }
        let Some((first, _)) = placed.first().copied() else {
            continue;
        };
        for pair in placed.windows(2) {
            let [(from, _), (to, _)] = pair else { continue };
            way_m += from.inv_mul(to).translation.vector.norm();
        }
        for (turn, count) in turns.iter().zip(&mut cells) {
            let mounting = stated * turn;
            let points = placed.iter().flat_map(|(pose, points)| {
                let first_from_lidar = first.inv_mul(pose) * mounting;
                let level = points.iter().filter(|point| point[2].abs() <= grid.level_m);
                level.map(move |point| {
                    let place = first_from_lidar * Point3::from(*point);
                    [place.x, place.y]
                })
            });
            *count += occupied_cells(points, grid.cell_m);
        }
    }
    if way_m < grid.way_m {
        let why = format!(
            "by {} the platform moved only {way_m:.1} m during consecutive clouds, {} m are needed to compare landmarks",
            poses.subject, grid.way_m
        );
        return Err((NotEvaluated::TooLittleEvidence, why));
    }
    Ok(Maps {
        body,
        poses: (poses.subject.clone(), poses.place()),
        way_m,
        cells,
    })
}
