//! The views of a run: frames, clouds, tracks, plots and findings as a scene, in memory, for any viewer.
//!
//! Decides what is shown and where. Does not know the viewer, read files, or judge.

#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // viewers take single numbers and colours of a byte

mod budget;
mod cameras;
mod claims;
mod clouds;
mod findings;
mod look;
mod motion;
mod placed;
mod plots;
mod robot;
pub mod scene;
mod tree;
mod upright;

use std::collections::{BTreeMap, BTreeSet};

use crate::run::Run;
use crate::verdict::Finding;
use crate::world::World;

use plots::PlotPlace;
use scene::{Kind, Path, Scene, View, WORLD};

pub use budget::{Omission, estimate, fit};

/// The names of platforms with which subjects begin, if there are several.
struct Labels<'r>(BTreeMap<&'r str, usize>);

impl<'r> Labels<'r> {
    fn of(worlds: &'r [World]) -> Self {
        let labels = worlds.iter().enumerate().filter(|_| worlds.len() > 1);
        Self(labels.map(|(number, world)| (world.label.as_str(), number)).collect())
    }

    /// The index of the platform of a subject; `None` if it has none, or there is only one.
    fn number(&self, subject: &str) -> Option<usize> {
        let ends = subject.match_indices(": ").map(|(at, _)| at);
        let mut labels = ends.filter_map(|at| self.0.get(subject.get(..at)?));
        labels.next().copied()
    }
}

/// The scene of a run, which must have kept [`Run::seen`] and the plots of its rows.
pub fn scene(run: &Run) -> Scene {
    let mut scene = Scene::default();
    let labels = Labels::of(&run.seen);
    let (mut placed, mut tops, mut spaces, mut starts_ns) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut images = Vec::new();
    let findings = run.verdict.findings.iter();
    let findings_of: Vec<(Option<usize>, &Finding)> = findings
        .map(|finding| (labels.number(&finding.subject), finding))
        .collect();
    let grounds = clouds::Grounds::of(&run.verdict);
    for (number, world) in run.seen.iter().enumerate() {
        let label = Some(world.label.as_str()).filter(|_| run.seen.len() > 1);
        let (top, prefix) = match label {
            Some(label) => (Path::top(WORLD).then(label), format!("{label}: ")),
            None => (Path::top(WORLD), String::new()),
        };
        let mut events_ns: BTreeSet<i64> = clouds::stamps_ns(world);
        events_ns.extend(world.bags.iter().filter_map(|bag| bag.end_ns));
        let findings: Vec<&Finding> = findings_of
            .iter()
            .filter(|(of, _)| of.is_none_or(|of| of == number))
            .map(|(_, finding)| *finding)
            .collect();
        let frames = tree::frames(world, &findings, (&top, &events_ns), &mut scene);
        robot::robots(&frames, &mut scene);
        let hidden = clouds::clouds(&frames, &grounds, &mut scene);
        images.extend(cameras::cameras(&frames, &mut scene));
        motion::origins(world, &top, &mut scene);
        for bag in &world.bags {
            motion::streams(bag, &frames, (&top, &prefix), &mut scene);
        }
        starts_ns.push(world.bags.iter().filter_map(|bag| bag.start_ns).min());
        spaces.push(View {
            name: label.map_or_else(|| "Frames".to_owned(), |label| format!("Frames of {label}")),
            kind: Kind::Space,
            origin: top.clone(),
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
    look::look(&worst, &tops, &mut spaces, &scene);
    drop(placed);
    scene.views = views(run, spaces, images, &scene, &drawn);
    scene
}

/// The views: space, the plots (those of the worst finding first), time series, the findings.
fn views(run: &Run, spaces: Vec<View>, images: Vec<Path>, scene: &Scene, drawn: &[PlotPlace]) -> Vec<View> {
    let flat = |name: String, kind: Kind, origin: Path| View {
        name,
        kind,
        origin,
        hidden: Vec::new(),
        bounds: None,
        eye: None,
    };
    let worst = run.verdict.findings.first();
    let is_of_worst = |path: &Path| {
        worst.is_some_and(|worst| {
            path.names().get(1..3) == Some(&[worst.rule.clone(), worst.subject.clone()])
                || findings::view_of(run, worst)
                    .and_then(|view| view.see.as_ref())
                    .is_some_and(|see| path.words().starts_with(see))
        })
    };
    let plotted = drawn.iter().map(|drawn| {
        let rule = drawn.path.names().get(1).cloned().unwrap_or_default();
        let title = drawn.path.names().last().cloned().unwrap_or_default();
        let kind = if drawn.bounds.is_some() {
            Kind::Plane
        } else {
            Kind::Time
        };
        View {
            bounds: drawn.bounds,
            ..flat(format!("{rule} {title}"), kind, drawn.path.clone())
        }
    });
    let imaged = images.into_iter().map(|image| {
        let name = image.names().last().cloned().unwrap_or_default();
        flat(name, Kind::Plane, image)
    });
    let over_time = groups(scene, &Path::top(motion::TIME)).into_iter().map(|group| {
        let name = group.names().get(1..).unwrap_or_default().join(" ");
        flat(name, Kind::Time, group)
    });
    let (first, mut others): (Vec<View>, Vec<View>) = plotted
        .chain(imaged)
        .chain(over_time)
        .partition(|view| is_of_worst(&view.origin));
    others.truncate(MAX_OTHERS);
    let mut views = spaces;
    views.extend(first.into_iter().take(MAX_OTHERS).chain(others));
    let findings = Path::top(findings::FINDINGS);
    views.push(flat("Findings".to_owned(), Kind::Page, findings.then("page")));
    views.push(flat("Log of findings".to_owned(), Kind::Log, findings.then("log")));
    views
}

/// Maximum number of views of plots and time series of the worst finding, and of others; the entities of further ones exist too.
const MAX_OTHERS: usize = 32;

/// The content of one view over time: all timestamps; for an inertial sensor, each of its vectors.
fn groups(scene: &Scene, time: &Path) -> Vec<Path> {
    let mut groups: Vec<Path> = Vec::new();
    for item in scene.items.iter().filter(|item| item.path.is_in(time)) {
        let names = item.path.names();
        // Groups whose curves have one unit.
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
    groups
}
