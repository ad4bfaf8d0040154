//! Keeps a scene below a size: the largest kinds of data are thinned evenly.

use std::collections::BTreeMap;

use super::scene::{Body, Content, Item, Path, Points, Scene};

/// Bytes of one item besides its numbers, in the viewer's files: of a constant item, and of one sample of many.
const OF_ALWAYS: usize = 800;
const OF_MOMENT: usize = 12;
/// Maximum number of rounds of thinning: each halves what is large.
const ROUNDS: usize = 24;

/// What was removed from a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Omission {
    /// One in this many samples is shown.
    pub moments: usize,
    /// One in this many points of clouds is shown.
    pub points: usize,
    /// Number of meshes removed.
    pub meshes: usize,
}

impl Omission {
    /// Nothing.
    pub const NOTHING: Self = Self {
        moments: 1,
        points: 1,
        meshes: 0,
    };

    /// What is removed in total after removing more.
    #[must_use]
    pub fn and(self, more: Self) -> Self {
        Self {
            moments: self.moments.saturating_mul(more.moments),
            points: self.points.saturating_mul(more.points),
            meshes: self.meshes + more.meshes,
        }
    }
}

/// The approximate size of a scene, bytes.
pub fn estimate(scene: &Scene) -> usize {
    Size::of(scene).sum()
}

/// Thins a scene to about this many bytes. Returns what was removed.
pub fn fit(scene: &mut Scene, max_bytes: usize) -> Omission {
    let mut left_out = Omission::NOTHING;
    for _ in 0..ROUNDS {
        let size = Size::of(scene);
        let most = size.moments.max(size.points).max(size.meshes);
        if size.sum() <= max_bytes || most == 0 {
            break;
        }
        if size.meshes == most {
            left_out.meshes += without_large_meshes(scene, size.meshes / 2);
        } else if size.points == most {
            left_out.points = left_out.points.saturating_mul(2);
            scene.items.iter_mut().for_each(|item| thin(&mut item.what));
        } else {
            left_out.moments = left_out.moments.saturating_mul(2);
            every_other(&mut scene.items);
        }
    }
    left_out
}

/// The size of a scene, bytes, by what can be thinned.
#[derive(Default)]
struct Size {
    always: usize,
    moments: usize,
    points: usize,
    meshes: usize,
}

impl Size {
    fn sum(&self) -> usize {
        self.always + self.moments + self.points + self.meshes
    }

    fn of(scene: &Scene) -> Self {
        let mut size = Self::default();
        for item in &scene.items {
            size.points += points_of(&item.what).map_or(0, |points| points.xyz_m.len() * 12 + points.colors.len() * 4);
            size.meshes += mesh_bytes(&item.what);
            match item.stamp_ns {
                None => size.always += OF_ALWAYS,
                Some(_) => size.moments += OF_MOMENT,
            }
        }
        size
    }
}

fn mesh_bytes(what: &Content) -> usize {
    match what {
        Content::Body(Body::Mesh(file, _)) => usize::try_from(file.bytes).unwrap_or(usize::MAX),
        _ => 0,
    }
}

/// Removes meshes, the largest first, until the others have at most this many bytes. Returns the number removed.
fn without_large_meshes(scene: &mut Scene, max_bytes: usize) -> usize {
    let mut sizes: Vec<usize> = scene.items.iter().map(|item| mesh_bytes(&item.what)).collect();
    sizes.retain(|bytes| *bytes > 0);
    sizes.sort_unstable();
    let mut stay = 0_usize;
    let limit = sizes.into_iter().find(|bytes| {
        stay = stay.saturating_add(*bytes);
        stay > max_bytes
    });
    let Some(limit) = limit else { return 0 };
    let before = scene.items.len();
    scene.items.retain(|item| mesh_bytes(&item.what) < limit);
    before - scene.items.len()
}

/// The points of a cloud: points with labels are not one.
fn points_of(what: &Content) -> Option<&Points> {
    match what {
        Content::Points(points) | Content::Pixels(points) => Some(points).filter(|points| points.labels.is_empty()),
        _ => None,
    }
}

/// Keeps every other point of clouds. Points with labels are never thinned.
fn thin(what: &mut Content) {
    fn half<T>(items: &mut Vec<T>) {
        let mut at = 0;
        items.retain(|_| {
            at += 1;
            at % 2 == 1
        });
    }
    if let Content::Points(Points {
        xyz_m, colors, labels, ..
    })
    | Content::Pixels(Points {
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

/// Keeps every other sample of each entity, including the first, and everything constant.
fn every_other(items: &mut Vec<Item>) {
    let mut seen: BTreeMap<Path, usize> = BTreeMap::new();
    items.retain(|item| {
        if item.stamp_ns.is_none() || matches!(item.what, Content::Log(..)) {
            return true;
        }
        let count = seen.entry(item.path.clone()).or_default();
        *count += 1;
        *count % 2 == 1
    });
}

#[cfg(test)]
mod tests {
    use nalgebra::Isometry3;

    use crate::source::MeshFile;

    use super::*;

    fn scene() -> Scene {
        let mut scene = Scene::default();
        let cloud = Path::top("cloud");
        for stamp in 0..1000 {
            scene.at(&Path::top("frame"), stamp, Content::Pose(Isometry3::identity()));
        }
        let xyz_m = vec![[0.0; 3]; 100_000];
        let colors = vec![[0; 3]; 100_000];
        scene.at(
            &cloud,
            0,
            Content::Points(Points {
                xyz_m,
                colors,
                ..Points::default()
            }),
        );
        scene.always(&Path::top("label"), Content::Page("words".to_owned()));
        scene
    }

    #[test]
    fn a_scene_that_fits_stays_as_it_is() {
        let mut fitted = scene();
        assert_eq!(fit(&mut fitted, 10_000_000), Omission::NOTHING);
        assert_eq!(fitted, scene());
    }

    #[test]
    fn what_there_is_most_of_is_thinned_and_words_stay() {
        let mut fitted = scene();
        let left_out = fit(&mut fitted, 200_000);
        assert!(left_out.moments <= 2 && left_out.points > 8, "{left_out:?}");
        let size = Size::of(&fitted);
        assert!(size.always + size.moments + size.points <= 200_000);
        assert!(fitted.has(&Path::top("label")) && fitted.has(&Path::top("frame")) && fitted.has(&Path::top("cloud")));
    }

    #[test]
    fn large_meshes_are_left_out_before_small_ones() {
        let mut fitted = Scene::default();
        for bytes in [10_000, 400_000, 20_000, 900_000] {
            let path = std::path::PathBuf::from(format!("{bytes}.stl"));
            let mesh = Body::Mesh(MeshFile { path, bytes }, [1.0; 3]);
            fitted.always(&Path::top(format!("{bytes}")), Content::Body(mesh));
        }
        assert_eq!(fit(&mut fitted, 100_000).meshes, 2);
        assert!(fitted.has(&Path::top("10000")) && fitted.has(&Path::top("20000")));
        assert!(!fitted.has(&Path::top("400000")) && !fitted.has(&Path::top("900000")));
    }

    #[test]
    fn an_absurd_budget_ends() {
        let mut fitted = scene();
        assert_ne!(fit(&mut fitted, 1), Omission::NOTHING);
        assert!(fitted.has(&Path::top("frame")), "the first moment stays");
        assert!(fitted.has(&Path::top("label")));
    }
}
