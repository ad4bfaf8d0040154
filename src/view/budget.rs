//! A scene that is no larger than it may be: what there is most of is thinned, evenly.

use std::collections::BTreeMap;

use super::scene::{Item, Path, Points, Scene, What};

/// Bytes that one item costs beside its numbers, as the viewer's files have it: what holds always, and one moment of many.
const OF_ALWAYS: usize = 1500;
const OF_MOMENT: usize = 12;
/// Rounds of thinning: each halves what is large.
const ROUNDS: usize = 24;

/// Thins a scene until it has about so many bytes. Says by how much, where anything was left out: every how many-th moment is
/// shown, and every how many-th point.
pub fn fit(scene: &mut Scene, max_bytes: usize) -> Option<(usize, usize)> {
    let (mut moments, mut points) = (1_usize, 1_usize);
    for _ in 0..ROUNDS {
        let size = Size::of(scene);
        if size.always + size.moments + size.points <= max_bytes || size.moments + size.points == 0 {
            break;
        }
        if size.points > size.moments {
            points = points.saturating_mul(2);
            scene.items.iter_mut().for_each(|item| thin(&mut item.what));
        } else {
            moments = moments.saturating_mul(2);
            every_other(&mut scene.items);
        }
    }
    (moments > 1 || points > 1).then_some((moments, points))
}

/// What a scene takes, bytes: by what of it can be thinned.
#[derive(Default)]
struct Size {
    always: usize,
    moments: usize,
    points: usize,
}

impl Size {
    fn of(scene: &Scene) -> Self {
        let mut size = Self::default();
        for item in &scene.items {
            size.points += points_of(&item.what).map_or(0, |points| points.xyz_m.len() * 12 + points.colors.len() * 4);
            match item.stamp_ns {
                None => size.always += OF_ALWAYS,
                Some(_) => size.moments += OF_MOMENT,
            }
        }
        size
    }
}

/// The points of a cloud: what has labels is none.
fn points_of(what: &What) -> Option<&Points> {
    match what {
        What::Points(points) | What::Pixels(points) => Some(points).filter(|points| points.labels.is_empty()),
        _ => None,
    }
}

/// Keeps every other point of clouds. What has labels is never thinned.
fn thin(what: &mut What) {
    fn half<T>(items: &mut Vec<T>) {
        let mut at = 0;
        items.retain(|_| {
            at += 1;
            at % 2 == 1
        });
    }
    if let What::Points(Points {
        xyz_m, colors, labels, ..
    })
    | What::Pixels(Points {
        xyz_m, colors, labels, ..
    }) = what
        && labels.is_empty()
        && xyz_m.len() > 1
    {
        if colors.len() == xyz_m.len() {
            half(colors);
        }
        half(xyz_m);
    }
}

/// Keeps every other moment of each entity, the first among them, and everything that holds always.
fn every_other(items: &mut Vec<Item>) {
    let mut seen: BTreeMap<Path, usize> = BTreeMap::new();
    items.retain(|item| {
        if item.stamp_ns.is_none() || matches!(item.what, What::Log(..)) {
            return true;
        }
        let count = seen.entry(item.path.clone()).or_default();
        *count += 1;
        *count % 2 == 1
    });
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use nalgebra::Isometry3;

    use super::*;

    fn scene() -> Scene {
        let mut scene = Scene::default();
        let cloud = Path::top("cloud");
        for stamp in 0..1000 {
            scene.at(&Path::top("frame"), stamp, What::Pose(Isometry3::identity()));
        }
        let xyz_m = vec![[0.0; 3]; 100_000];
        let colors = vec![[0; 3]; 100_000];
        scene.at(
            &cloud,
            0,
            What::Points(Points {
                xyz_m,
                colors,
                ..Points::default()
            }),
        );
        scene.always(&Path::top("label"), What::Page("words".to_owned()));
        scene
    }

    #[test]
    fn a_scene_that_fits_stays_as_it_is() {
        let mut fitted = scene();
        assert_eq!(fit(&mut fitted, 10_000_000), None);
        assert_eq!(fitted, scene());
    }

    #[test]
    fn what_there_is_most_of_is_thinned_and_words_stay() {
        let mut fitted = scene();
        let (moments, points) = fit(&mut fitted, 200_000).unwrap();
        assert!(moments <= 2 && points > 8, "{moments} {points}");
        let size = Size::of(&fitted);
        assert!(size.always + size.moments + size.points <= 200_000);
        assert!(fitted.has(&Path::top("label")) && fitted.has(&Path::top("frame")) && fitted.has(&Path::top("cloud")));
    }

    #[test]
    fn an_absurd_budget_ends() {
        let mut fitted = scene();
        assert!(fit(&mut fitted, 1).is_some());
        assert!(fitted.has(&Path::top("frame")), "the first moment stays");
        assert!(fitted.has(&Path::top("label")));
    }
}
