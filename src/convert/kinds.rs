//! Maps the frames of one dialect to those of another: by their names, or by the kind of sensor that a name indicates.

use crate::tables::{Dialect, FileTemplate, KeyedTransform, Rows, TransformTemplate};
use crate::world::FrameId;

use super::links::Links;

/// Words for kinds of frames; a VIO's body is its IMU.
const KINDS: [(Kind, &[&str]); 6] = [
    (Kind::Imu, &["imu", "body", "b", "i", "ins"]),
    (Kind::Camera, &["cam", "camera", "c", "fisheye", "image"]),
    (
        Kind::Lidar,
        &[
            "lidar", "velo", "velodyne", "laser", "l", "os", "ouster", "livox", "hesai", "pandar", "rslidar",
        ],
    ),
    (
        Kind::Base,
        &["base", "egovehicle", "ego", "vehicle", "robot", "car", "chassis"],
    ),
    (Kind::Radar, &["radar"]),
    (Kind::Wheel, &["wheel", "wheels", "odometer"]),
];

/// A kind of frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Imu,
    Camera,
    Lidar,
    Base,
    Radar,
    Wheel,
}

/// The kind that a name indicates, and its number.
fn kind(name: &str) -> Option<(Kind, u32)> {
    let tokens = FrameId::new(name).tokens();
    let numbered = |token: &String| {
        let word = token.trim_end_matches(|letter: char| letter.is_ascii_digit());
        let digits = token.get(word.len()..).unwrap_or_default();
        (word.to_owned(), digits.parse::<u32>().ok())
    };
    let parts: Vec<(String, Option<u32>)> = tokens.iter().map(numbered).collect();
    let found = parts.iter().find_map(|(word, number)| {
        let (kind, _) = KINDS.iter().find(|(_, words)| words.contains(&word.as_str()))?;
        Some((*kind, *number))
    });
    let side = || {
        parts.iter().find_map(|(word, _)| match word.as_str() {
            "left" => Some(0),
            "right" => Some(1),
            _ => None,
        })
    };
    let lone = || {
        parts
            .iter()
            .find_map(|(word, number)| if word.is_empty() { *number } else { None })
    };
    match found {
        Some((kind, number)) => Some((kind, number.or_else(lone).or_else(side).unwrap_or(0))),
        None => side().map(|number| (Kind::Camera, number)),
    }
}

/// From which number cameras are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Camera(u32);

impl Camera {
    /// The smallest number of a camera among the frames of links.
    pub(super) fn first_of(links: &Links) -> Self {
        let frames = links.frames();
        let cameras = frames
            .iter()
            .filter_map(|name| kind(name).filter(|(kind, _)| *kind == Kind::Camera));
        Self(cameras.map(|(_, number)| number).min().unwrap_or(0).min(1))
    }
}

/// A transform of a dialect, and the frames that take its parts.
pub(super) struct Assignment<'t> {
    pub(super) transform: &'t TransformTemplate,
    /// Units and order.
    pub(super) keyed: Option<KeyedTransform>,
    /// The frame that the file itself names, where it names one.
    pub(super) name: String,
    /// The frames for the key's target and source.
    pub(super) target: String,
    pub(super) source: String,
    /// The number that replaces `#`.
    pub(super) number: u32,
    /// Whether it is the inverse of what was requested.
    pub(super) is_turned: bool,
    /// Why its direction is in doubt.
    pub(super) doubt: Option<String>,
}

/// A place for a frame in a transform: a name, perhaps with a number, or any name.
#[derive(Clone, Debug)]
enum Part {
    Any,
    Named(String),
}

impl Part {
    fn of(word: &str) -> Self {
        if word == "*" || word.starts_with('@') {
            Self::Any
        } else {
            Self::Named(word.to_owned())
        }
    }

    /// The number that a frame gives to `#`, where it matches; zero where nothing is counted.
    fn fits(&self, frame: &str, writing: &FileTemplate, first: Camera) -> Option<u32> {
        let Self::Named(word) = self else { return Some(0) };
        if !word.contains('#') && FrameId::new(word.as_str()).tokens() == FrameId::new(frame).tokens() {
            return Some(0);
        }
        let (wanted, number) = kind(word.split('#').next().unwrap_or_default())?;
        let (is, counted) = kind(frame)?;
        let counted = if is == Kind::Camera {
            counted.saturating_sub(first.0) + writing.first
        } else {
            counted
        };
        if wanted != is {
            return None;
        }
        if word.contains("#-1") {
            return Some(counted + 1);
        }
        if word.contains('#') {
            return Some(counted);
        }
        // `camera` is the first one, `cam1` is that one.
        let is_bare = !word.ends_with(|letter: char| letter.is_ascii_digit());
        let wanted = if is_bare && is == Kind::Camera {
            writing.first
        } else {
            number
        };
        (wanted == counted || is != Kind::Camera && is_bare).then_some(0)
    }
}

/// The frame for a part that may be any: the source, where both may.
fn named(a: &Part, b: &Part, target: &str, source: &str) -> String {
    match (a, b) {
        (Part::Any, Part::Named(_)) => target.to_owned(),
        _ => source.to_owned(),
    }
}

/// The transforms that a dialect can hold, with their frames; with a key, those under it.
fn parts<'t>(
    writing: &'t FileTemplate,
    dialects: &Rows<Dialect>,
    key: Option<&str>,
) -> Vec<(&'t TransformTemplate, Option<KeyedTransform>, Part, Part)> {
    let mut all = Vec::new();
    let is_under =
        |transform: &TransformTemplate, key: &str| key == transform.key || transform.key.ends_with(&format!("/{key}"));
    let asked = |transform: &&TransformTemplate| key.is_none_or(|key| is_under(transform, key));
    for transform in writing.transforms.iter().filter(asked) {
        let rows = dialects.iter().filter(|row| row.name == writing.dialect);
        let keyed = rows
            .flat_map(|row| &row.transforms)
            .find(|keyed| keyed.keys.contains(&transform.key))
            .cloned();
        let is = transform.is.clone().or_else(|| keyed.as_ref()?.is.clone());
        let named = || {
            let name = crate::world::transform_name::parse(&transform.key)?;
            Some(format!("{} from {}", name.target, name.source))
        };
        let Some(is) = is.or_else(named) else { continue };
        if let Some((target, source)) = is.split_once(" from ") {
            all.push((transform, keyed, Part::of(target), Part::of(source)));
        }
    }
    all
}

/// The transforms of a dialect that two frames match, in either direction.
fn fitting<'t>(
    writing: &'t FileTemplate,
    dialects: &Rows<Dialect>,
    target: &str,
    source: &str,
    key: Option<&str>,
    first: Camera,
) -> Vec<Assignment<'t>> {
    let mut casts = Vec::new();
    for (transform, keyed, a, b) in parts(writing, dialects, key) {
        for (target, source, is_turned) in [(target, source, false), (source, target, true)] {
            let (Some(of_target), Some(of_source)) = (a.fits(target, writing, first), b.fits(source, writing, first))
            else {
                continue;
            };
            // Both parts of `T_cn_cnm1` determine the number.
            let is_counted = |part: &Part| matches!(part, Part::Named(word) if word.contains('#'));
            if is_counted(&a) && is_counted(&b) && of_target != of_source {
                continue;
            }
            casts.push(Assignment {
                transform,
                name: named(&a, &b, target, source),
                doubt: keyed
                    .as_ref()
                    .and_then(|keyed| keyed.doubt.clone().or_else(|| keyed.algebra_doubt.clone())),
                keyed: keyed.clone(),
                target: target.to_owned(),
                source: source.to_owned(),
                number: of_target.max(of_source),
                is_turned,
            });
            break;
        }
    }
    casts
}

/// The place of one requested transform.
pub(super) fn cast_one<'t>(
    writing: &'t FileTemplate,
    dialects: &Rows<Dialect>,
    target: &str,
    source: &str,
    key: Option<&str>,
    first: Camera,
) -> Result<Assignment<'t>, String> {
    let mut fits = fitting(writing, dialects, target, source, key, first);
    if fits.is_empty() {
        // Names that indicate no kind: assigned in the given order, where there is only one place for them.
        let all = parts(writing, dialects, key);
        let count = all.len();
        if let (Some((transform, keyed, a, b)), 1) = (all.into_iter().next(), count) {
            fits.push(Assignment {
                transform,
                name: named(&a, &b, target, source),
                doubt: Some(format!(
                    "the frames `{target}` and `{source}` were assigned by their order, not by their names"
                )),
                keyed,
                target: target.to_owned(),
                source: source.to_owned(),
                number: writing.first,
                is_turned: false,
            });
        }
    }
    fits.into_iter().next().ok_or_else(|| {
        let keys: Vec<&str> = writing
            .transforms
            .iter()
            .map(|transform| transform.key.as_str())
            .collect();
        format!(
            "`{target}` from `{source}` matches no key of `{}` by the names of the frames: choose one with --key: {}",
            writing.dialect,
            keys.join(", ")
        )
    })
}

/// The places of everything that was read: each link once, and no frame twice where one transform already connects it.
pub(super) fn cast_all<'t>(
    writing: &'t FileTemplate,
    dialects: &Rows<Dialect>,
    links: &Links,
    key: Option<&str>,
) -> Vec<Assignment<'t>> {
    let first = Camera::first_of(links);
    let frames = links.frames();
    let mut casts: Vec<Assignment<'t>> = Vec::new();
    // Stated transforms come before chains of them.
    let stated = links.all.iter().map(|link| (&link.target, &link.source));
    let made = frames
        .iter()
        .enumerate()
        .flat_map(|(index, a)| frames.iter().skip(index + 1).map(move |b| (a, b)));
    let mut tied: Vec<Vec<String>> = Vec::new();
    for (target, source) in stated.chain(made) {
        let group = |tied: &[Vec<String>], frame: &String| tied.iter().position(|group| group.contains(frame));
        let (a, b) = (group(&tied, target), group(&tied, source));
        if a.is_some() && a == b {
            continue;
        }
        if links.chain(target, source).is_none() {
            continue;
        }
        let Some(cast) = fitting(writing, dialects, target, source, key, first)
            .into_iter()
            .next()
        else {
            continue;
        };
        let is_taken = casts.iter().any(|other| {
            other.transform.key == cast.transform.key
                && other.number == cast.number
                && !cast.transform.write.contains("{name}")
        });
        if is_taken {
            continue;
        }
        casts.push(cast);
        let mut joined: Vec<String> = vec![target.clone(), source.clone()];
        let mut gone: Vec<usize> = [a, b].into_iter().flatten().collect();
        gone.sort_unstable();
        gone.dedup();
        for index in gone.into_iter().rev() {
            joined.extend(tied.remove(index));
        }
        tied.push(joined);
    }
    casts.sort_by(|a, b| {
        let place = |cast: &Assignment<'_>| {
            writing
                .transforms
                .iter()
                .position(|transform| transform.key == cast.transform.key)
        };
        (a.number, place(a), &a.source).cmp(&(b.number, place(b), &b.source))
    });
    casts
}
