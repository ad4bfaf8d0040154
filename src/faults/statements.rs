//! Mistakes of stated transforms: every relation, on every statement of a file, a joint or a static transform.

use nalgebra::Isometry3;

use super::restate::{relations_between, restate_claim, restate_edge, scale_angles};
use super::subject::constant_edges;
use super::{Change, Fault, Subject, SubjectPlace};
use crate::math::relation::Relation;
use crate::math::rotation::is_near;
use crate::world::{ClaimKind, World};

macro_rules! statements {
    ($($relation:ident $name:literal)*) => {
        /// Every relation but [`Relation::Equal`], in its order.
        pub(super) static FAULTS: &[Fault] = &[$(
            fault!(
                Statement,
                $name,
                Relation::$relation.describe(),
                Restated(Relation::$relation),
                [Relation::$relation.word()],
                [],
                ["CROSS02", "CROSS01", "CROSS07", "CROSS04", "CROSS03"],
                "a second statement of the transform: the URDF, /tf_static or a calibration file",
            ),
        )*];
    };
}

statements! {
    Inverse "stated-inverse"
    Transposed "stated-transposed"
    Wxyz "stated-wxyz"
    Xyzw "stated-xyzw"
    RotationLost "stated-rotation-lost"
    TranslationLost "stated-translation-lost"
    TranslationNegated "stated-translation-negated"
    InverseTranslation "stated-inverse-translation"
    Millimetres "stated-millimetres"
    Metres "stated-metres"
    Z180 "stated-z180"
    NedEnu "stated-ned-enu"
    FluFrd "stated-flu-frd"
    Optical "stated-optical"
    OpticalInverse "stated-optical-inverse"
    Z90 "stated-z90"
    ZMinus90 "stated-z-90"
    Y180 "stated-y180"
    X90 "stated-x90"
    XMinus90 "stated-x-90"
    Y90 "stated-y90"
    YMinus90 "stated-y-90"
    LeftZ180 "stated-left-z180"
    LeftNedEnu "stated-left-ned-enu"
    LeftFluFrd "stated-left-flu-frd"
    LeftOptical "stated-left-optical"
    LeftOpticalInverse "stated-left-optical-inverse"
    LeftZ90 "stated-left-z90"
    LeftZMinus90 "stated-left-z-90"
    EnuFluNedFrd "stated-ned-frd-enu-flu"
    BothFluFrd "stated-both-flu-frd"
    BothNedEnu "stated-both-ned-enu"
    RpyRotating "stated-rpy-rotating"
    RpyFixed "stated-rpy-fixed"
    Ypr "stated-ypr"
    Degrees "stated-degrees"
    Radians "stated-radians"
    MirroredY "stated-mirrored-y"
    MirroredZ "stated-mirrored-z"
    InverseZ180 "stated-inverse-z180"
    Z180Inverse "stated-z180-inverse"
    AppliedTwice "stated-applied-twice"
}

/// A smaller change is none: an angle in radians and a distance in metres.
const LEAST: [f64; 2] = [1e-3, 1e-3];

/// A statement with the error of a relation.
struct Restated(Relation);

impl Restated {
    /// What the subject states, and what it would state with the error; none if it cannot have the error, or looks the same with it.
    fn held(&self, world: &World, subject: &Subject) -> Option<[Isometry3<f64>; 2]> {
        let truth = match subject.at {
            SubjectPlace::Claim(number) => {
                let claim = world.claims.get(number)?;
                let is_whole = claim.has_rotation && claim.has_translation;
                let can_have = is_whole || claim.has_translation && self.0.is_translation_only();
                claim.pose.filter(|_| can_have)?
            }
            SubjectPlace::Edge { bag, edge } => world.bags.get(bag)?.tf.get(edge)?.first()?.pose,
            _ => return None,
        };
        let truth = truth.isometry();
        let held = self.0.apply(&truth)?;
        (!is_near(&truth, &held, LEAST)).then_some([truth, held])
    }
}

impl Change for Restated {
    fn subjects(&self, world: &World) -> Vec<Subject> {
        let subjects = claims(world).chain(edges(world));
        subjects.filter(|subject| self.held(world, subject).is_some()).collect()
    }

    fn apply(&self, world: &mut World, subject: &Subject) -> bool {
        let Some([_, held]) = self.held(world, subject) else {
            return false;
        };
        match subject.at {
            SubjectPlace::Claim(number) => {
                let scaled = match self.0 {
                    Relation::Degrees => scale_angles(world, number, f64::to_degrees),
                    Relation::Radians => scale_angles(world, number, f64::to_radians),
                    _ => false,
                };
                if !scaled {
                    restate_claim(world, number, &held);
                }
            }
            SubjectPlace::Edge { bag, edge } => {
                let bag = world.bags.get_mut(bag);
                if let Some(edge) = bag.and_then(|bag| bag.tf.get_mut(edge)) {
                    restate_edge(edge, &held);
                }
            }
            _ => return false,
        }
        true
    }

    /// The relations that fit as well, seen from either statement and in either direction.
    fn same_as(&self, world: &World, subject: &Subject) -> Vec<&'static str> {
        let Some([truth, held]) = self.held(world, subject) else {
            return Vec::new();
        };
        relations_between(&truth, &held)
    }
}

/// The statements of files and descriptions on rigid transforms.
fn claims(world: &World) -> impl Iterator<Item = Subject> {
    let rigid = world.claims.iter().enumerate().filter(|(_, claim)| claim.is_rigid());
    rigid.filter_map(|(number, claim)| {
        let (target, source) = claim.frames.as_ref()?;
        let path = world.path(claim.place.source);
        let name = match &claim.kind {
            ClaimKind::Joint { joint, .. } => format!("`{path}`: joint `{joint}`"),
            ClaimKind::File { .. } => format!("`{path}`: `{target}` from `{source}`"),
        };
        let mut words = frames_in_rows(target.canonical().as_str(), source.canonical().as_str());
        words.push(format!("`{}`", claim.label));
        Some(Subject {
            name,
            words,
            at: SubjectPlace::Claim(number),
        })
    })
}

/// The constant transforms of recordings.
fn edges(world: &World) -> impl Iterator<Item = Subject> {
    constant_edges(world).into_iter().map(|([bag, number], edge)| {
        let (parent, child) = (edge.parent.canonical(), edge.child.canonical());
        let recording = world.bags.get(bag).filter(|_| world.bags.len() > 1);
        let path = recording.map_or_else(String::new, |bag| format!("`{}`: ", world.path(bag.source)));
        Subject {
            name: format!("{path}`{}`: `{parent}` -> `{child}`", edge.topic),
            words: frames_in_rows(parent.as_str(), child.as_str()),
            at: SubjectPlace::Edge { bag, edge: number },
        }
    })
}

/// How the subjects of rows name the frames of a transform.
fn frames_in_rows(target: &str, source: &str) -> Vec<String> {
    vec![
        format!("`{target}` from `{source}`"),
        format!("`{source}` from `{target}`"),
        format!("`{target}` -> `{source}`"),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_relation_is_a_mistake() {
        let words: Vec<&str> = FAULTS
            .iter()
            .filter_map(|fault| fault.name.strip_prefix("stated-"))
            .collect();
        let relations: Vec<&str> = Relation::all().iter().skip(1).map(|relation| relation.word()).collect();
        assert_eq!(words, relations);
    }
}
