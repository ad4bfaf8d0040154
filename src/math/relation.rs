//! Named convention errors: what changes the true transform into the one that a file holds.
//!
//! Owns the dictionary: the words, a phrase and a sentence for each, and their order of simplicity. [`apply`](Relation::apply) is in
//! `apply.rs`, the decision which relation explains a difference in `classify.rs`. Must not know frame names, files or
//! rules. Source: `rules/cross/extrinsic-relation.md`; measured figures are at [`classify()`].

mod apply;
mod classify;
#[cfg(test)]
mod tests_detection;
#[cfg(test)]
mod tests_false_names;
#[cfg(test)]
mod tests_relation;
#[cfg(test)]
mod tests_setup;

use nalgebra::UnitQuaternion;

use super::rotation::turn_in_words;

pub use classify::{Classification, Tolerance, TwoWayMatch, classify, classify_either_way, classify_rotation};

/// Writes the enum, the list in prior order, the words, phrases and sentences from one table, so that they can't drift.
macro_rules! relations {
    ($($name:ident $word:literal $phrase:literal $sentence:literal)*) => {
        /// A named convention error: a map `f` with `held = f(truth)`. In prior order: the simplest and most frequent
        /// come first, and where the data can't distinguish two the earlier one is named.
        ///
        /// A "right" factor changes the axes of the source (child) frame, `T * A`; a "left" factor those of the target
        /// (parent) frame, `A * T`, which also rotates the translation. 180 degrees about x is `FluFrd`: a map has only
        /// one name.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Relation {
            $(#[doc = $sentence] $name,)*
        }

        impl Relation {
            /// Every relation, in prior order; `Equal` is the first.
            pub fn all() -> &'static [Relation] {
                &[$(Relation::$name,)*]
            }

            /// The stable word of this relation, as used in reports and settings.
            pub const fn word(self) -> &'static str {
                match self { $(Relation::$name => $word,)* }
            }

            /// One plain sentence: which convention error this is.
            pub const fn describe(self) -> &'static str {
                match self { $(Relation::$name => $sentence,)* }
            }

            /// The sentence, with the rotation that is missing where it is lost; `right` is the correct one.
            pub fn describe_beside(self, right: &UnitQuaternion<f64>) -> String {
                let sentence = self.describe();
                match self {
                    Relation::RotationLost => format!("{sentence} What is missing is {}.", turn_in_words(right)),
                    _ => sentence.to_owned(),
                }
            }

            /// The predicate of a sentence about a transform with this error; `right` names the correct one.
            pub fn relates_to(self, right: &str) -> String {
                let phrase = match self { $(Relation::$name => $phrase,)* };
                phrase.replace('%', right)
            }
        }
    };
}

relations! {
    Equal "equal"
        "equals %"
        "Both are the same transform."
    Inverse "inverse"
        "is the inverse of %"
        "The transform is inverted: it takes points in the opposite direction."
    Transposed "transposed"
        "has the transposed rotation of %"
        "The rotation is transposed and the translation is kept: a row-major matrix read as column-major, or a JPL quaternion read as Hamilton."
    Wxyz "wxyz"
        "is % with an x, y, z, w quaternion read as w, x, y, z"
        "The quaternion is stored as x, y, z, w and was read as w, x, y, z."
    Xyzw "xyzw"
        "is % with a w, x, y, z quaternion read as x, y, z, w"
        "The quaternion is stored as w, x, y, z and was read as x, y, z, w."
    RotationLost "rotation-lost"
        "is % without its rotation"
        "The rotation is missing (identity); the translation is right."
    TranslationLost "translation-lost"
        "has the rotation of %, but no translation"
        "The translation is missing (zero); the rotation is right."
    TranslationNegated "translation-negated"
        "has the translation of % with the opposite sign"
        "The translation has the opposite sign; the rotation is right."
    InverseTranslation "inverse-translation"
        "has the rotation of %, but the translation of its inverse"
        "The translation is that of the inverse transform (-R^T t); the rotation is that of the transform itself."
    Millimetres "millimetres"
        "has 1000 times the translation of %"
        "The translation is 1000 times too large: millimetres where metres are meant."
    Metres "metres"
        "has 1/1000 of the translation of %"
        "The translation is 1000 times too small: metres that were converted from millimetres once more."
    Z180 "z180"
        "is % rotated by 180 deg about the child's z"
        "The child frame is rotated by 180 deg about its z axis (as between the two frames of an Ouster lidar)."
    NedEnu "ned-enu"
        "is % with NED for ENU axes in the child, or vice versa"
        "The child frame's axes are north-east-down where east-north-up is meant, or vice versa (x and y exchanged, z negated)."
    FluFrd "flu-frd"
        "is % with FRD for FLU axes in the child, or vice versa"
        "The child frame's axes are forward-right-down where forward-left-up is meant, or vice versa (180 deg about x)."
    Optical "optical"
        "is % with optical axes in the child where body axes are meant"
        "The child frame has optical axes (x right, y down, z forward) where body axes (x forward, y left, z up) are meant."
    OpticalInverse "optical-inverse"
        "is % with body axes in the child where optical axes are meant"
        "The child frame has body axes (x forward, y left, z up) where optical axes (x right, y down, z forward) are meant."
    Z90 "z90"
        "is % rotated by 90 deg about the child's z"
        "The child frame is rotated by 90 deg about its z axis."
    ZMinus90 "z-90"
        "is % rotated by -90 deg about the child's z"
        "The child frame is rotated by -90 deg about its z axis."
    Y180 "y180"
        "is % rotated by 180 deg about the child's y"
        "The child frame is rotated by 180 deg about its y axis."
    X90 "x90"
        "is % rotated by 90 deg about the child's x"
        "The child frame is rotated by 90 deg about its x axis."
    XMinus90 "x-90"
        "is % rotated by -90 deg about the child's x"
        "The child frame is rotated by -90 deg about its x axis (one of the two rotations of an optical frame)."
    Y90 "y90"
        "is % rotated by 90 deg about the child's y"
        "The child frame is rotated by 90 deg about its y axis."
    YMinus90 "y-90"
        "is % rotated by -90 deg about the child's y"
        "The child frame is rotated by -90 deg about its y axis."
    LeftZ180 "left-z180"
        "is % rotated by 180 deg about the parent's z"
        "The parent frame is rotated by 180 deg about its z axis, translation included."
    LeftNedEnu "left-ned-enu"
        "is % with NED for ENU axes in the parent, or vice versa"
        "The parent frame's axes are north-east-down where east-north-up is meant, or vice versa, translation included."
    LeftFluFrd "left-flu-frd"
        "is % with FRD for FLU axes in the parent, or vice versa"
        "The parent frame's axes are forward-right-down where forward-left-up is meant, or vice versa, translation included."
    LeftOptical "left-optical"
        "is % with body axes in the parent where optical axes are meant"
        "The parent frame has body axes where optical axes are meant, translation included."
    LeftOpticalInverse "left-optical-inverse"
        "is % with optical axes in the parent where body axes are meant"
        "The parent frame has optical axes where body axes are meant, translation included."
    LeftZ90 "left-z90"
        "is % rotated by 90 deg about the parent's z"
        "The parent frame is rotated by 90 deg about its z axis, translation included."
    LeftZMinus90 "left-z-90"
        "is % rotated by -90 deg about the parent's z"
        "The parent frame is rotated by -90 deg about its z axis, translation included."
    EnuFluNedFrd "ned-frd-enu-flu"
        "is % as FRD in NED instead of FLU in ENU, or vice versa"
        "The pose is that of a forward-right-down body in north-east-down where forward-left-up in east-north-up is meant, or vice versa."
    BothFluFrd "both-flu-frd"
        "is % with FRD for FLU axes in both frames, or vice versa"
        "Both frames have forward-right-down axes where forward-left-up is meant, or vice versa."
    BothNedEnu "both-ned-enu"
        "is % with NED for ENU axes in both frames, or vice versa"
        "Both frames have north-east-down axes where east-north-up is meant, or vice versa (the body's x and y are exchanged as well)."
    RpyRotating "rpy-rotating"
        "is % with fixed-axis angles read as rotating-axis angles"
        "Roll, pitch and yaw about fixed axes were read as angles about the rotating axes x, y, z."
    RpyFixed "rpy-fixed"
        "is % with rotating-axis angles read as fixed-axis angles"
        "Angles about the rotating axes x, y, z were read as roll, pitch and yaw about fixed axes."
    Ypr "ypr"
        "has the angles of % with roll and yaw exchanged"
        "Roll and yaw are exchanged: roll, pitch, yaw were read as yaw, pitch, roll."
    Degrees "degrees"
        "has the angles of % in degrees, read as radians"
        "Roll, pitch and yaw are written in degrees and were read as radians."
    Radians "radians"
        "has the angles of % in radians, read as degrees"
        "Roll, pitch and yaw are written in radians and were read as degrees."
    MirroredY "mirrored-y"
        "is % mirrored left to right (y, roll and yaw negated)"
        "The transform is mirrored left to right: y, roll and yaw have the opposite sign (a left-handed simulator)."
    MirroredZ "mirrored-z"
        "is % mirrored top to bottom (z, roll and pitch negated)"
        "The transform is mirrored top to bottom: z, roll and pitch have the opposite sign."
    InverseZ180 "inverse-z180"
        "is the inverse of %, then rotated by 180 deg about its z"
        "The transform is inverted, and then its child frame is rotated by 180 deg about z."
    Z180Inverse "z180-inverse"
        "is the inverse of % with the child rotated by 180 deg about z"
        "The child frame is rotated by 180 deg about its z axis, and the result is inverted."
    AppliedTwice "applied-twice"
        "is % applied twice"
        "The transform is applied twice."
}

impl Relation {
    /// The relation with this word, if there is one. `x180` is accepted for [`Relation::FluFrd`], which is that rotation.
    pub fn from_word(word: &str) -> Option<Relation> {
        if word == "x180" {
            return Some(Relation::FluFrd);
        }
        Relation::all().iter().copied().find(|relation| relation.word() == word)
    }

    /// The relation that undoes this one for every transform: `truth = reversed.apply(held)`. What a fixer applies.
    ///
    /// `None` where the error destroyed what the repair needs (a lost part), or where the repair has several answers
    /// (degrees read as radians wrap around; the square root of a transform), or where it has no word.
    pub fn reversed(self) -> Option<Relation> {
        use Relation as R;
        match self {
            R::RotationLost | R::TranslationLost | R::InverseTranslation | R::Degrees | R::AppliedTwice => None,
            R::Wxyz => Some(R::Xyzw),
            R::Xyzw => Some(R::Wxyz),
            R::Millimetres => Some(R::Metres),
            R::Metres => Some(R::Millimetres),
            R::Optical => Some(R::OpticalInverse),
            R::OpticalInverse => Some(R::Optical),
            R::Z90 => Some(R::ZMinus90),
            R::ZMinus90 => Some(R::Z90),
            R::X90 => Some(R::XMinus90),
            R::XMinus90 => Some(R::X90),
            R::Y90 => Some(R::YMinus90),
            R::YMinus90 => Some(R::Y90),
            R::LeftOptical => Some(R::LeftOpticalInverse),
            R::LeftOpticalInverse => Some(R::LeftOptical),
            R::LeftZ90 => Some(R::LeftZMinus90),
            R::LeftZMinus90 => Some(R::LeftZ90),
            R::RpyRotating => Some(R::RpyFixed),
            R::RpyFixed => Some(R::RpyRotating),
            R::Radians => Some(R::Degrees),
            R::InverseZ180 => Some(R::Z180Inverse),
            R::Z180Inverse => Some(R::InverseZ180),
            _ => Some(self),
        }
    }

    /// Whether the relation is an order of a quaternion's numbers.
    pub fn is_quaternion_order(self) -> bool {
        matches!(self, Relation::Wxyz | Relation::Xyzw)
    }

    /// Whether the relation changes the translation only: such a one can't explain a difference of rotations.
    pub fn is_translation_only(self) -> bool {
        matches!(
            self,
            Relation::TranslationLost
                | Relation::TranslationNegated
                | Relation::InverseTranslation
                | Relation::Millimetres
                | Relation::Metres
        )
    }
}

impl std::fmt::Display for Relation {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.word())
    }
}
