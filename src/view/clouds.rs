//! Point clouds in their frames at their timestamps, coloured by their height over the ground that a rule found in them, else over z = 0
//! of the fixed frame; that ground, and that plane.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Isometry3, Point3, Vector3};

use crate::verdict::{SeenPlane, Verdict};
use crate::world::bag::{TopicContent, TopicEvidence};
use crate::world::content::ContentEvidence;
use crate::world::{FrameId, World};

use super::claims::OF_PREFERRED;
use super::motion;
use super::placed::FrameEntities;
use super::scene::{Color, Content, Lines, Path, Points, Scene, narrow};

/// Half the side of the plane that is drawn, and the distance of its lines, metres.
const PLANE_M: (i32, usize) = (20, 2);
/// The same for a ground found in a cloud.
const PATCH_M: (i32, usize) = (8, 2);
/// Heights over and under the plane at which the colour no longer changes, metres.
const FULL_M: f64 = 0.5;
/// The speed at which the colour of a detection no longer changes, m/s.
const FULL_M_S: f64 = 10.0;
const OF_PLANE: Color = [70, 90, 70];
const OF_GROUND: Color = [60, 200, 210];

/// Stamps of the clouds that are shown, nanoseconds.
pub(super) fn stamps_ns(world: &World) -> BTreeSet<i64> {
    let topics = world.bags.iter().flat_map(|bag| bag.topics.values());
    let said = topics.flat_map(TopicEvidence::contents);
    said.flat_map(|said| shown(said.content))
        .map(|cloud| cloud.stamp_ns)
        .collect()
}

/// A cloud, or a scan of a plane.
struct TimedCloud {
    stamp_ns: i64,
    log_ns: i64,
    xyz_m: Vec<[f64; 3]>,
}

fn shown(content: &ContentEvidence) -> Vec<TimedCloud> {
    let clouds = content.clouds.iter().flat_map(|clouds| &clouds.samples);
    let clouds = clouds.map(|sample| TimedCloud {
        stamp_ns: sample.at.stamp_ns.unwrap_or(sample.at.log_ns),
        log_ns: sample.at.log_ns,
        xyz_m: sample.points.iter().map(|point| point.xyz).collect(),
    });
    let scans = content
        .lasers
        .iter()
        .flat_map(|lasers| lasers.projected.runs.iter().flatten());
    let scans = scans.map(|scan| TimedCloud {
        stamp_ns: scan.stamp_ns.unwrap_or(scan.log_ns),
        log_ns: scan.log_ns,
        xyz_m: scan.points.clone(),
    });
    clouds.chain(scans).collect()
}

/// The grounds that rules found in clouds, by topic and log time: the normal in the axes of the cloud, and metres along it.
pub(super) struct Grounds<'v>(BTreeMap<(&'v str, i64), &'v SeenPlane>);

impl<'v> Grounds<'v> {
    pub(super) fn of(verdict: &'v Verdict) -> Self {
        let planes = verdict.rows.iter().flat_map(|row| &row.planes);
        Self(
            planes
                .map(|plane| ((plane.topic.as_str(), plane.log_ns), plane))
                .collect(),
        )
    }
}

/// Clouds under the frames of their headers, each with the ground found in it. Returns the entities that are hidden at first: clouds
/// under frames corrected by rules.
pub(super) fn clouds(placed: &FrameEntities, grounds: &Grounds, scene: &mut Scene) -> Vec<Path> {
    let world = placed.world();
    let buffer = placed.buffer();
    let mut has_any = false;
    let mut hidden = Vec::new();
    let topics = world.bags.iter().flat_map(|bag| bag.topics.values());
    for said in topics.flat_map(TopicEvidence::contents) {
        let Some(frame) = said.header_frames.keys().next() else {
            continue;
        };
        let Some(path) = placed.path(frame) else { continue };
        let name = format!("points of {}", motion::name(&said));
        detections(&said, &path.then(name.clone()), scene);
        let clouds = shown(said.content);
        if clouds.is_empty() {
            continue;
        }
        let frame = frame.canonical();
        let root = placed.root(&frame).cloned().unwrap_or_else(|| frame.clone());
        let topic = said.topic.topic.as_str();
        let elsewhere = elsewhere(placed, &frame, &name, scene);
        for TimedCloud {
            stamp_ns,
            log_ns,
            xyz_m,
        } in clouds
        {
            let found = buffer.lookup(root.as_str(), frame.as_str(), stamp_ns).ok();
            let root_from_cloud = found.map_or_else(Isometry3::identity, |found| found.target_from_source);
            let ground = grounds.0.get(&(topic, log_ns));
            let residual_m = |xyz: [f64; 3]| match ground {
                Some(plane) => plane.normal.dot(&Vector3::from(xyz)) - plane.offset_m,
                None => placed.height_m(&root, &(root_from_cloud * Point3::from(xyz))),
            };
            has_any = true;
            let drawn = |colors: Vec<Color>| {
                Content::Points(Points {
                    xyz_m: xyz_m.iter().map(|xyz| xyz.map(|value| value as f32)).collect(),
                    colors,
                    radius: -1.5,
                    labels: Vec::new(),
                })
            };
            let by_residual = xyz_m.iter().map(|xyz| residual(residual_m(*xyz))).collect();
            scene.at(&path.then(name.clone()), stamp_ns, drawn(by_residual));
            for own in &elsewhere {
                scene.at(own, stamp_ns, drawn(vec![OF_PREFERRED]));
            }
            if let Some(plane) = ground {
                let own = path.then(format!("ground in {topic}"));
                scene.at(&own, stamp_ns, patch(plane));
            }
        }
        hidden.extend(elsewhere);
    }
    if let Some(path) = placed
        .fixed
        .as_ref()
        .filter(|_| has_any)
        .and_then(|frame: &FrameId| placed.path(frame))
    {
        plane(path, scene);
    }
    hidden
}

/// Radar detections: approaching ones are red, receding ones blue.
fn detections(said: &TopicContent, path: &Path, scene: &mut Scene) {
    let sweeps = said.content.radar.iter().flat_map(|radar| radar.runs.iter().flatten());
    // Points of clouds with speeds are shown with the clouds.
    for sweep in sweeps.filter(|_| said.content.clouds.is_none()) {
        let point = |[x, y, z, _]: &[f64; 4]| [*x, *y, *z].map(|value| value as f32);
        let color = |[.., speed_m_s]: &[f64; 4]| residual(-speed_m_s * FULL_M / FULL_M_S);
        let points = Points {
            xyz_m: sweep.echoes.iter().map(point).collect(),
            colors: sweep.echoes.iter().map(color).collect(),
            radius: -3.0,
            labels: Vec::new(),
        };
        scene.at(path, sweep.stamp_ns.unwrap_or(sweep.log_ns), Content::Points(points));
    }
}

/// The entities of a cloud under frames corrected by rules.
fn elsewhere(placed: &FrameEntities, frame: &FrameId, name: &str, scene: &mut Scene) -> Vec<Path> {
    let mut entities = Vec::new();
    for (moved, path) in &placed.candidates {
        let chain = placed.world().graph().chain(moved, frame, |edge| edge.is_rigid);
        let Some((moved_from_cloud, _)) = chain else { continue };
        if !placed.stands_beneath(frame, moved) {
            continue;
        }
        let own = path.then(name);
        scene.always(&own, Content::Pose(moved_from_cloud));
        entities.push(own);
    }
    entities
}

/// A part of the ground under the origin of a cloud, as lines, with its distance.
fn patch(plane: &SeenPlane) -> Content {
    let foot = plane.normal * plane.offset_m;
    let aside = if plane.normal.x.abs() < 0.9 {
        Vector3::x()
    } else {
        Vector3::y()
    };
    let right = plane.normal.cross(&aside).normalize();
    let ahead = plane.normal.cross(&right);
    let (half, step) = PATCH_M;
    let across = (-half..=half).step_by(step).map(f64::from);
    let edge = f64::from(half);
    let at = |u: f64, v: f64| narrow(&(foot + right * u + ahead * v));
    let strips = across.flat_map(|u| [vec![at(u, -edge), at(u, edge)], vec![at(-edge, u), at(edge, u)]]);
    let mut strips_m = vec![vec![[0.0; 3], narrow(&foot)]];
    strips_m.extend(strips);
    let mut labels = vec![String::new(); strips_m.len()];
    if let Some(first) = labels.first_mut() {
        *first = format!("ground, {:.2} m away", plane.offset_m.abs());
    }
    Content::Lines(Lines {
        strips_m,
        color: OF_GROUND,
        radius: -0.7,
        labels,
    })
}

/// Green at the plane, red over it, blue under it.
fn residual(height_m: f64) -> Color {
    let share = (height_m / FULL_M).clamp(-1.0, 1.0);
    let strong = (share.abs() * 200.0) as u8;
    if share >= 0.0 {
        [40 + strong, 220 - strong, 60]
    } else {
        [60, 220 - strong, 40 + strong]
    }
}

fn plane(path: &Path, scene: &mut Scene) {
    let (half, step) = PLANE_M;
    let edge = half as f32;
    let across = (-half..=half).step_by(step).map(|at| at as f32);
    let strips = across.flat_map(|at| {
        [
            vec![[at, -edge, 0.0], [at, edge, 0.0]],
            vec![[-edge, at, 0.0], [edge, at, 0.0]],
        ]
    });
    scene.always(
        &path.then("plane z = 0"),
        Content::Lines(Lines {
            strips_m: strips.collect(),
            color: OF_PLANE,
            radius: -0.5,
            labels: Vec::new(),
        }),
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_plane_is_green_and_what_stands_on_it_red() {
        assert_eq!(residual(0.0), [40, 220, 60]);
        assert_eq!(residual(3.0), [240, 20, 60]);
        assert_eq!(residual(-3.0), [60, 20, 240]);
    }
}
