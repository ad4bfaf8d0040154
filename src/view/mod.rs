//! What a run has to be looked at: its frames, clouds, tracks, plots and findings as a scene, in memory, for any viewer.
//!
//! Owns what is shown and where it stands. Must not know the viewer, read files, nor judge.

#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // viewers take single numbers and colours of a byte

mod budget;
mod cameras;
mod clouds;
mod findings;
mod motion;
mod plots;
mod robot;
pub mod scene;
mod tree;
mod upright;

use std::collections::BTreeSet;

use nalgebra::{Point3, Vector3};

use crate::run::Run;
use crate::verdict::Finding;
use crate::world::World;

use plots::Drawn;
use scene::{Eye, Kind, Path, Places, Scene, View, WORLD, What, narrow};

pub use budget::fit;

/// What subjects of several platforms open with: each its platform's name.
struct Labels<'r>(Vec<&'r str>);

impl<'r> Labels<'r> {
    fn of(worlds: &'r [World]) -> Self {
        let labels = worlds.iter().map(|world| world.label.as_str());
        Self(if worlds.len() > 1 { labels.collect() } else { Vec::new() })
    }

    /// The number of the platform that a subject is of; `None` where it is of none, or there is only one.
    fn number(&self, subject: &str) -> Option<usize> {
        let opens = |label: &&str| subject.strip_prefix(label).is_some_and(|rest| rest.starts_with(": "));
        self.0.iter().position(opens)
    }

    /// Whether a subject is not that of another platform.
    fn may_be(&self, subject: &str, number: usize) -> bool {
        self.number(subject).is_none_or(|of| of == number)
    }
}

/// Everything that a run has to be looked at. It must have kept what was [`Run::seen`], its rows their plots.
pub fn scene(run: &Run) -> Scene {
    let mut scene = Scene::default();
    let labels = Labels::of(&run.seen);
    let (mut placed, mut tops, mut spaces, mut starts_ns) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut images = Vec::new();
    let grounds = clouds::Grounds::of(&run.verdict);
    for (number, world) in run.seen.iter().enumerate() {
        let (top, prefix) = match labels.0.get(number) {
            Some(label) => (Path::top(WORLD).then(*label), format!("{label}: ")),
            None => (Path::top(WORLD), String::new()),
        };
        let mut events_ns: BTreeSet<i64> = clouds::stamps_ns(world);
        events_ns.extend(world.bags.iter().filter_map(|bag| bag.end_ns));
        let findings = run.verdict.findings.iter();
        let findings: Vec<&Finding> = findings
            .filter(|finding| labels.may_be(&finding.subject, number))
            .collect();
        let mut frames = tree::frames(world, &findings, (&top, &events_ns), &mut scene);
        frames.number = number;
        robot::robots(&frames, &mut scene);
        let hidden = clouds::clouds(&frames, &grounds, &mut scene);
        images.extend(cameras::cameras(&frames, &mut scene));
        motion::origins(world, &top, &mut scene);
        for bag in &world.bags {
            motion::streams(bag, &frames, (&top, &prefix), &mut scene);
        }
        starts_ns.push(world.bags.iter().filter_map(|bag| bag.start_ns).min());
        spaces.push(View {
            name: labels
                .0
                .get(number)
                .map_or_else(|| "Frames".to_owned(), |label| format!("Frames of {label}")),
            kind: Kind::Space,
            origin: top.clone(),
            shown: vec![top.clone()],
            hidden,
            bounds: None,
            eye: None,
        });
        tops.push(top);
        placed.push(frames);
    }
    let at = |subject: &str| {
        let number = labels.number(subject).unwrap_or(0);
        let start_ns = starts_ns.get(number).copied().flatten().unwrap_or(0);
        tops.get(number).map(|top| (start_ns, top))
    };
    let drawn = plots::plots(&run.verdict, &at, &mut scene);
    let worst = findings::findings(run, &placed, &labels, &mut scene);
    scene.at_ns = worst.at_ns;
    look(&worst, &tops, &mut spaces, &scene);
    drop(placed);
    scene.views = views(run, spaces, images, &scene, &drawn);
    scene
}

/// From where the spaces are seen at first: that of the worst finding before the others, with what is around its frame; of others, what
/// stands in them.
fn look(worst: &findings::Worst, tops: &[Path], spaces: &mut [View], scene: &Scene) {
    let places = Places::of(scene, worst.at_ns);
    let with_axes = scene.items.iter().filter(|item| matches!(item.what, What::Axes(_)));
    let mut stands: Vec<Vec<Vector3<f64>>> = tops.iter().map(|_| Vec::new()).collect();
    for item in with_axes {
        let of = tops.iter().zip(&mut stands).find(|(top, _)| item.path.is_in(top));
        if let Some((_, stands)) = of {
            stands.push(places.place(&item.path).translation.vector);
        }
    }
    if worst.is_of_a_track {
        let tracks = scene.items.iter().filter_map(|item| match &item.what {
            What::Lines(lines) if is_track(&item.path) => Some((&item.path, lines)),
            _ => None,
        });
        for (path, lines) in tracks {
            let of = tops.iter().zip(&mut stands).find(|(top, _)| path.is_in(top));
            let Some((_, stands)) = of else { continue };
            let place = places.place(path);
            let points = lines.strips_m.iter().flatten().step_by(TRACK_STEP);
            stands.extend(points.map(|point| (place * Point3::from(point.map(f64::from))).coords));
        }
    }
    for ((top, space), stands) in tops.iter().zip(spaces.iter_mut()).zip(&stands) {
        let frame = worst.frame.as_ref().filter(|frame| frame.is_in(top));
        let middle_m = stands.iter().sum::<Vector3<f64>>() / stands.len().max(1) as f64;
        let frame = frame.filter(|_| !worst.is_of_a_track);
        let target_m = frame.map_or(middle_m, |frame| places.place(frame).translation.vector);
        let mut away_m: Vec<f64> = stands.iter().map(|at| (at - target_m).norm()).collect();
        away_m.sort_by(f64::total_cmp);
        // What is far away with few others would make everything else small.
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

/// Whether an entity is a track, or one of several that are laid over each other.
fn is_track(path: &Path) -> bool {
    path.names().iter().any(|name| name.contains(TRACK))
}

/// What the names of tracks hold.
const TRACK: &str = "track";
/// Every so many points of a track are looked at when it is decided from where it is seen.
const TRACK_STEP: usize = 10;

/// How much is seen around what one looks at, metres: no less and no more.
const MIN_AROUND_M: f64 = 0.5;
const MAX_AROUND_M: f64 = 20.0;

/// The views: space, the plots with those of the worst finding first, what goes over time, the findings.
fn views(run: &Run, spaces: Vec<View>, images: Vec<Path>, scene: &Scene, drawn: &[Drawn]) -> Vec<View> {
    let flat = |name: String, kind: Kind, origin: Path| View {
        name,
        kind,
        shown: vec![origin.clone()],
        origin,
        hidden: Vec::new(),
        bounds: None,
        eye: None,
    };
    let mut views = spaces;
    let worst = run.verdict.findings.first();
    let mut drawn: Vec<&Drawn> = drawn.iter().collect();
    drawn.sort_by_key(|drawn| {
        let names = drawn.path.names().get(1..3);
        let is_of_worst = worst.is_some_and(|worst| names == Some(&[worst.rule.clone(), worst.subject.clone()]));
        !is_of_worst
    });
    for drawn in drawn.into_iter().take(MAX_PLOTS) {
        let rule = drawn.path.names().get(1).cloned().unwrap_or_default();
        let title = drawn.path.names().last().cloned().unwrap_or_default();
        let kind = if drawn.bounds.is_some() {
            Kind::Plane
        } else {
            Kind::Time
        };
        views.push(View {
            bounds: drawn.bounds,
            ..flat(format!("{rule} {title}"), kind, drawn.path.clone())
        });
    }
    for image in images {
        let name = image.names().last().cloned().unwrap_or_default();
        views.push(flat(name, Kind::Plane, image));
    }
    for group in groups(scene, &Path::top(motion::TIME)) {
        let name = group.names().get(1..).unwrap_or_default().join(" ");
        views.push(flat(name, Kind::Time, group));
    }
    let findings = Path::top(findings::FINDINGS);
    views.push(flat("Findings".to_owned(), Kind::Page, findings.then("page")));
    views.push(flat("Log of findings".to_owned(), Kind::Log, findings.then("log")));
    views
}

/// Views of plots; the entities of more are there all the same.
const MAX_PLOTS: usize = 24;
/// Views of what goes over time.
const MAX_GROUPS: usize = 24;

/// What is shown in one view over time: all stamps; of an inertial sensor, each of its vectors.
fn groups(scene: &Scene, time: &Path) -> Vec<Path> {
    let mut groups: Vec<Path> = Vec::new();
    for item in scene.items.iter().filter(|item| item.path.is_in(time)) {
        let names = item.path.names();
        // What has one unit for all its curves.
        let depth = match names.get(1).map(String::as_str) {
            Some("inertial" | "position") => 4,
            Some("orientation") => 3,
            _ => 2,
        };
        let mut names = names.iter().take(depth);
        let Some(first) = names.next() else { continue };
        let group = names.fold(Path::top(first.clone()), |path, name| path.then(name.clone()));
        if groups.last() != Some(&group) && !groups.contains(&group) {
            groups.push(group);
        }
    }
    groups.truncate(MAX_GROUPS);
    groups
}
