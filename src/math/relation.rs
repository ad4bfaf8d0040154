//! Named convention errors: what turns the true transform into the one that a file holds.
//!
//! Owns the dictionary: the words, a sentence for each, and their order of simplicity. [`apply`](Relation::apply) is in
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

pub use classify::{Classification, EitherWay, Tolerance, classify, classify_either_way, classify_rotation};

/// Writes the enum, the list in prior order, the words and the sentences from one table, so that they can't drift.
macro_rules! relations {
    ($($name:ident $word:literal $sentence:literal)*) => {
        /// A named convention error: a map `f` with `held = f(truth)`. In prior order: the simplest and most frequent
        /// come first, and where the data can't tell two apart the earlier one is named.
        ///
        /// A "right" factor changes the axes of the source (child) frame, `T * A`; a "left" factor those of the target
        /// (parent) frame, `A * T`, which also turns the translation. A half turn about x is `FluFrd`: the same map has
        /// one name only.
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
            pub fn word(self) -> &'static str {
                match self { $(Relation::$name => $word,)* }
            }

            /// One plain sentence: which convention error this is.
            pub fn describe(self) -> &'static str {
                match self { $(Relation::$name => $sentence,)* }
            }
        }
    };
}

relations! {
    Equal "equal"
        "Both are the same transform."
    Inverse "inverse"
        "The transform is inverted: it maps parent to child where child to parent is meant, or the other way."
    Transposed "transposed"
        "The rotation is transposed and the translation is kept: a row-major matrix read as column-major, or a JPL quaternion read as Hamilton."
    Wxyz "wxyz"
        "The quaternion is stored as x, y, z, w and was read as w, x, y, z."
    Xyzw "xyzw"
        "The quaternion is stored as w, x, y, z and was read as x, y, z, w."
    RotationLost "rotation-lost"
        "The rotation is missing (identity); the translation is right."
    TranslationLost "translation-lost"
        "The translation is missing (zero); the rotation is right."
    TranslationNegated "translation-negated"
        "The translation has the opposite sign; the rotation is right."
    InverseTranslation "inverse-translation"
        "The translation is that of the inverse transform (-R^T t); the rotation is that of the transform itself."
    Millimetres "millimetres"
        "The translation is 1000 times too large: millimetres where metres are meant."
    Metres "metres"
        "The translation is 1000 times too small: metres, scaled once more as if they were millimetres."
    Z180 "z180"
        "The source frame is turned by half a turn about its z axis (as between the two frames of an Ouster lidar)."
    NedEnu "ned-enu"
        "The source frame's axes are north-east-down where east-north-up is meant, or the other way (x and y exchanged, z negated)."
    FluFrd "flu-frd"
        "The source frame's axes are forward-right-down where forward-left-up is meant, or the other way (half a turn about x)."
    Optical "optical"
        "The source frame has optical axes (x right, y down, z forward) where body axes (x forward, y left, z up) are meant."
    OpticalInverse "optical-inverse"
        "The source frame has body axes (x forward, y left, z up) where optical axes (x right, y down, z forward) are meant."
    Z90 "z90"
        "The source frame is turned by a quarter turn about its z axis."
    ZMinus90 "z-90"
        "The source frame is turned by minus a quarter turn about its z axis."
    Y180 "y180"
        "The source frame is turned by half a turn about its y axis."
    X90 "x90"
        "The source frame is turned by a quarter turn about its x axis."
    XMinus90 "x-90"
        "The source frame is turned by minus a quarter turn about its x axis (half of what an optical frame needs)."
    Y90 "y90"
        "The source frame is turned by a quarter turn about its y axis."
    YMinus90 "y-90"
        "The source frame is turned by minus a quarter turn about its y axis."
    LeftZ180 "left-z180"
        "The target frame is turned by half a turn about its z axis, translation included."
    LeftNedEnu "left-ned-enu"
        "The target frame's axes are north-east-down where east-north-up is meant, or the other way, translation included."
    LeftFluFrd "left-flu-frd"
        "The target frame's axes are forward-right-down where forward-left-up is meant, or the other way, translation included."
    LeftOptical "left-optical"
        "The target frame has body axes where optical axes are meant, translation included."
    LeftOpticalInverse "left-optical-inverse"
        "The target frame has optical axes where body axes are meant, translation included."
    LeftZ90 "left-z90"
        "The target frame is turned by a quarter turn about its z axis, translation included."
    LeftZMinus90 "left-z-90"
        "The target frame is turned by minus a quarter turn about its z axis, translation included."
    EnuFluNedFrd "ned-frd-enu-flu"
        "The pose is that of a forward-right-down body in north-east-down where forward-left-up in east-north-up is meant, or the other way."
    BothFluFrd "both-flu-frd"
        "Both frames have forward-right-down axes where forward-left-up is meant, or the other way."
    BothNedEnu "both-ned-enu"
        "Both frames have north-east-down axes where east-north-up is meant, or the other way (the body's x and y are exchanged as well)."
    RpyRotating "rpy-rotating"
        "Roll, pitch and yaw about fixed axes were read as angles about the rotating axes x, y, z."
    RpyFixed "rpy-fixed"
        "Angles about the rotating axes x, y, z were read as roll, pitch and yaw about fixed axes."
    Ypr "ypr"
        "Roll and yaw are exchanged: roll, pitch, yaw were read as yaw, pitch, roll."
    Degrees "degrees"
        "Roll, pitch and yaw are written in degrees and were read as radians."
    Radians "radians"
        "Roll, pitch and yaw are written in radians and were read as degrees."
    MirroredY "mirrored-y"
        "The transform is mirrored left to right: y, roll and yaw have the opposite sign (a left-handed simulator)."
    MirroredZ "mirrored-z"
        "The transform is mirrored top to bottom: z, roll and pitch have the opposite sign."
    InverseZ180 "inverse-z180"
        "The transform is inverted, and then its source frame is turned by half a turn about z."
    Z180Inverse "z180-inverse"
        "The source frame is turned by half a turn about its z axis, and the result is inverted."
    AppliedTwice "applied-twice"
        "The transform is applied twice."
}

impl Relation {
    /// The relation with this word, if there is one. `x180` is accepted for [`Relation::FluFrd`], which is that turn.
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
