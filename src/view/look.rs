//! The initial camera of a scene. Does not draw.

use std::collections::BTreeMap;

use nalgebra::{Point3, Vector3};

use super::scene::{Content, Eye, Path, Places, Scene, View, narrow};

/// Place and time of the worst finding, if known.
pub(super) struct WorstFinding {
    pub(super) at_ns: Option<i64>,
    pub(super) frame: Option<Path>,
    /// Whether it concerns a track, not the pose of one frame.
    pub(super) is_of_a_track: bool,
}

/// The initial cameras of the spaces: that of the worst finding first, looking at its frame; of others, at their content.
pub(super) fn look(worst: &WorstFinding, tops: &[Path], spaces: &mut [View], scene: &Scene) {
    let places = Places::of(scene, worst.at_ns);
    // Either there is one space, or each has a name below the common root.
    let named: BTreeMap<&str, usize> = tops
        .iter()
        .enumerate()
        .filter_map(|(number, top)| Some((top.names().get(1)?.as_str(), number)))
        .collect();
    let of = |path: &Path| {
        let only = tops.first().filter(|top| path.is_in(top)).map(|_| 0);
        let name = path.names().get(1).map(String::as_str)?;
        named.get(name).copied().or(only)
    };
    let with_axes = scene.items.iter().filter(|item| matches!(item.what, Content::Axes(_)));
    let mut stands: Vec<Vec<Vector3<f64>>> = tops.iter().map(|_| Vec::new()).collect();
    for item in with_axes {
        if let Some(stands) = of(&item.path).and_then(|number| stands.get_mut(number)) {
            stands.extend(finite(places.place(&item.path).translation.vector));
        }
    }
    if worst.is_of_a_track {
        let tracks = scene.items.iter().filter_map(|item| match &item.what {
            Content::Lines(lines) if is_track(&item.path) => Some((&item.path, lines)),
            _ => None,
        });
        for (path, lines) in tracks {
            let Some(stands) = of(path).and_then(|number| stands.get_mut(number)) else {
                continue;
            };
            let place = places.place(path);
            let points = lines.strips_m.iter().flatten().step_by(TRACK_STEP);
            stands.extend(points.filter_map(|point| finite((place * Point3::from(point.map(f64::from))).coords)));
        }
    }
    for ((top, space), stands) in tops.iter().zip(spaces.iter_mut()).zip(&stands) {
        let frame = worst.frame.as_ref().filter(|frame| frame.is_in(top));
        let middle_m = stands.iter().sum::<Vector3<f64>>() / stands.len().max(1) as f64;
        let frame = frame.filter(|_| !worst.is_of_a_track);
        let of_frame = frame.and_then(|frame| finite(places.place(frame).translation.vector));
        let target_m = of_frame.unwrap_or(middle_m);
        let mut away_m: Vec<f64> = stands.iter().map(|at| (at - target_m).norm()).collect();
        away_m.sort_by(f64::total_cmp);
        // A few distant items would make everything else small.
        let most = away_m.get(away_m.len() * 9 / 10).copied().unwrap_or(0.0);
        let around_m = if worst.is_of_a_track {
            most.max(MIN_AROUND_M)
        } else {
            most.clamp(MIN_AROUND_M, MAX_AROUND_M)
        };
        let away = Vector3::new(-1.0, -1.3, 0.9).normalize() * around_m * 2.5;
        space.eye = Some(Eye {
            at_m: narrow(&(target_m + away)),
            target_m: narrow(&target_m),
        });
    }
    let of_worst = tops
        .iter()
        .position(|top| worst.frame.as_ref().is_some_and(|frame| frame.is_in(top)));
    spaces.rotate_left(of_worst.unwrap_or(0));
}

/// Whether an entity is a track, or one of several superimposed ones.
fn is_track(path: &Path) -> bool {
    path.names().iter().any(|name| name.contains(TRACK))
}

/// A part of the names of tracks.
pub(super) const TRACK: &str = "track";
/// Step between the points of a track that are used to place the camera.
const TRACK_STEP: usize = 10;

/// Minimum and maximum extent around the target, metres.
const MIN_AROUND_M: f64 = 0.5;
const MAX_AROUND_M: f64 = 20.0;

fn finite(place: Vector3<f64>) -> Option<Vector3<f64>> {
    place.iter().all(|value| value.is_finite()).then_some(place)
}
