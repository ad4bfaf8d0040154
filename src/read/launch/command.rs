//! The arguments of `static_transform_publisher`: six or seven numbers and two frames, or flags.
//!
//! Orders and counts are those of the programs themselves: `static_transform_publisher.cpp` of `tf` (ROS 1, with a period in milliseconds
//! after the frames) and `static_transform_broadcaster_program.cpp` of `tf2_ros` (ROS 1 and 2). All read yaw pitch roll and x y z w.

use crate::math::rotation;
use crate::source::{Confidence, Place, SourceId, Span};
use crate::world::launch::{ArgumentForm, ReadObstacle, StaticPublisher};
use crate::world::{Claim, ClaimKind, FrameId, Literal, Pose, Spelling};

use super::{Call, CallCondition, PROGRAM, Word};

/// The dialect's name in claims.
const DIALECT: &str = PROGRAM;

/// The content of the arguments, before it becomes a claim.
struct Arguments<'w> {
    form: ArgumentForm,
    /// Roll, pitch, yaw or x, y, z, w, independent of the order in the file; zero if it is not written.
    rotation: Vec<Option<&'w Word>>,
    translation: [Option<&'w Word>; 3],
    frames: [Option<&'w Word>; 2],
}

/// Reads a call. The claim is `None` where the transform is not known; the publisher then has the reason.
pub(super) fn read(call: &Call, source: SourceId, ordinal: usize) -> (StaticPublisher, Option<Claim>) {
    let words = without_ros(&call.words);
    let has_period = !is_flagged(&words) && words.last().is_some_and(|word| is_number(word)) && words.len() > 7;
    // The value of a substitution is written elsewhere.
    let own = || {
        words
            .iter()
            .filter(|word| call.span.start <= word.span.start && word.span.end <= call.span.end)
    };
    let span = own()
        .next()
        .zip(own().next_back())
        .map_or(call.span, |(a, b)| a.span.cover(b.span));
    let mut publisher = StaticPublisher {
        label: call.name.clone().unwrap_or_else(|| format!("{PROGRAM} {ordinal}")),
        package: call.package.clone(),
        is_ros2: call.is_ros2,
        form: None,
        arguments: u32::try_from(words.len()).unwrap_or(u32::MAX),
        has_period,
        place: Place::text(source, span),
        unread: None,
    };
    let claimed = arguments(&words).and_then(|arguments| {
        publisher.form = Some(arguments.form);
        claim(&arguments, call, &publisher, source)
    });
    match claimed {
        Ok(claim) => (publisher, Some(claim)),
        Err(why) => {
            publisher.unread = Some(why);
            (publisher, None)
        }
    }
}

/// The arguments without remappings (`__name:=x`) and everything between `--ros-args` and `--`.
fn without_ros(words: &[Word]) -> Vec<&Word> {
    let mut of_ros = false;
    let mut kept = Vec::new();
    for word in words {
        match word.text.as_str() {
            "--ros-args" => of_ros = true,
            "--" if of_ros => of_ros = false,
            text if of_ros || text.contains(":=") || text == "&" => {}
            _ => kept.push(word),
        }
    }
    kept
}

fn is_number(word: &Word) -> bool {
    number(&word.text).is_some()
}

/// A number as `atof` and `stod` would read it whole.
fn number(text: &str) -> Option<f64> {
    let digits = text.bytes().any(|byte| byte.is_ascii_digit());
    text.parse::<f64>().ok().filter(|_| digits)
}

fn is_flagged(words: &[&Word]) -> bool {
    words.iter().any(|word| word.text.starts_with("--"))
}

fn arguments<'w>(words: &[&'w Word]) -> Result<Arguments<'w>, ReadObstacle> {
    if is_flagged(words) {
        return flagged(words);
    }
    if let [only] = words
        && (only.is_open || only.text.starts_with('/') || !only.text.contains(' '))
    {
        return Err(if only.is_open {
            ReadObstacle::Open(only.text.clone())
        } else {
            ReadObstacle::Parameter(only.text.clone())
        });
    }
    // A number after the frames is the period.
    let frames_end = match words {
        [.., last] if is_number(last) => words.len() - 1,
        _ => words.len(),
    };
    let (numbers, frames) = match frames_end {
        8 => (words.get(..6), words.get(6..8)),
        9 => (words.get(..7), words.get(7..9)),
        _ => (None, None),
    };
    let (Some(numbers), Some([parent, child])) = (numbers, frames) else {
        let open = words.iter().find(|word| word.is_open && word.text.starts_with('$'));
        if let Some(open) = open {
            return Err(ReadObstacle::Open(open.text.clone()));
        }
        let numbers = words.iter().filter(|word| is_number(word)).count();
        let others = words.len() - numbers;
        return Err(ReadObstacle::Misread(if matches!((numbers, others), (6 | 7, 2)) {
            "the two frames must come after the numbers".to_owned()
        } else {
            let plural = if others == 1 { "" } else { "s" };
            format!("{numbers} numbers and {others} other word{plural}, not 6 or 7 and 2")
        }));
    };
    if let Some(name) = numbers.iter().find(|word| !word.is_open && !is_number(word)) {
        return Err(ReadObstacle::Misread(format!(
            "`{}` is not a number where one is required",
            name.text
        )));
    }
    if let Some(frame) = [parent, child].into_iter().find(|word| is_number(word)) {
        return Err(ReadObstacle::Misread(format!(
            "`{}` is a number where a frame is required",
            frame.text
        )));
    }
    let at = |index: usize| numbers.get(index).copied();
    let is_quaternion = numbers.len() == 7;
    Ok(Arguments {
        form: if is_quaternion {
            ArgumentForm::Quaternion
        } else {
            ArgumentForm::Angles
        },
        translation: [at(0), at(1), at(2)],
        // The file has yaw first.
        rotation: if is_quaternion {
            vec![at(3), at(4), at(5), at(6)]
        } else {
            vec![at(5), at(4), at(3)]
        },
        frames: [Some(parent), Some(child)],
    })
}

/// `--x 1 --frame-id a`; the programs do not accept `--x=1`.
fn flagged<'w>(words: &[&'w Word]) -> Result<Arguments<'w>, ReadObstacle> {
    const TRANSLATION: [&str; 3] = ["--x", "--y", "--z"];
    const ANGLES: [&str; 3] = ["--roll", "--pitch", "--yaw"];
    const QUATERNION: [&str; 4] = ["--qx", "--qy", "--qz", "--qw"];
    const FRAMES: [&str; 2] = ["--frame-id", "--child-frame-id"];
    let mut given: Vec<(&str, &'w Word)> = Vec::new();
    let mut words = words.iter().copied();
    while let Some(flag) = words.next() {
        let known = TRANSLATION
            .iter()
            .chain(&ANGLES)
            .chain(&QUATERNION)
            .chain(&FRAMES)
            .any(|known| *known == flag.text);
        if !known {
            return Err(if flag.is_open {
                ReadObstacle::Open(flag.text.clone())
            } else {
                ReadObstacle::Misread(format!("`{}` is not an argument of {PROGRAM}", flag.text))
            });
        }
        let value = words
            .next()
            .ok_or_else(|| ReadObstacle::Misread(format!("`{}` has no value", flag.text)))?;
        given.push((&flag.text, value));
    }
    let of = |flag: &str| {
        given
            .iter()
            .rev()
            .find(|(known, _)| *known == flag)
            .map(|(_, word)| *word)
    };
    let any = |flags: &[&str]| flags.iter().any(|flag| of(flag).is_some());
    if any(&ANGLES) && any(&QUATERNION) {
        return Err(ReadObstacle::Misread(
            "both angles and a quaternion are given".to_owned(),
        ));
    }
    let rotation = if any(&QUATERNION) {
        QUATERNION.map(of).to_vec()
    } else {
        ANGLES.map(of).to_vec()
    };
    let frames = FRAMES.map(of);
    if let Some((_, flag)) = frames.iter().zip(FRAMES).find(|(frame, _)| frame.is_none()) {
        return Err(ReadObstacle::Misread(format!("`{flag}` is missing")));
    }
    Ok(Arguments {
        form: ArgumentForm::Flags,
        translation: TRANSLATION.map(of),
        rotation,
        frames,
    })
}

fn claim(
    arguments: &Arguments<'_>,
    call: &Call,
    publisher: &StaticPublisher,
    source: SourceId,
) -> Result<Claim, ReadObstacle> {
    let translation = literals(&arguments.translation)?;
    let mut rotation = literals(&arguments.rotation)?;
    let is_quaternion = arguments.rotation.len() == 4;
    if is_quaternion && let (Some(None), Some(w)) = (arguments.rotation.get(3), rotation.get_mut(3)) {
        // The program starts from the identity.
        *w = written(1.0, publisher.place.span().unwrap_or(call.span));
    }
    let xyz =
        values::<3>(&translation).ok_or_else(|| ReadObstacle::Misread("a translation has three numbers".to_owned()))?;
    let (spelling, pose) = if let Some(xyzw) = values::<4>(&rotation) {
        let order_known = true;
        (
            Spelling::Quaternion { xyz, xyzw, order_known },
            Pose::from_raw(xyz, xyzw),
        )
    } else {
        let rpy =
            values::<3>(&rotation).ok_or_else(|| ReadObstacle::Misread("a rotation has three angles".to_owned()))?;
        let [roll, pitch, yaw] = rpy;
        let q = rotation::from_rpy(roll, pitch, yaw).coords;
        (Spelling::Rpy { xyz, rpy }, Pose::from_raw(xyz, [q.x, q.y, q.z, q.w]))
    };
    let [parent, child] = arguments.frames;
    // `tf` strips the leading slash of ROS 1; for `tf2_ros` it belongs to the name.
    let is_tf1 = call.package.as_deref() == Some("tf");
    let frame = |word: &Word| {
        let spelled = FrameId::new(word.text.as_str());
        (!word.is_open).then(|| if is_tf1 { spelled.canonical() } else { spelled })
    };
    let frames = parent.and_then(frame).zip(child.and_then(frame));
    let used = || {
        let numbers = arguments.translation.iter().chain(&arguments.rotation);
        numbers.chain(&arguments.frames).flatten()
    };
    let reading = match call.when {
        _ if frames.is_none() => Confidence::Hint,
        CallCondition::Always if !used().any(|word| word.is_default) => Confidence::Certain,
        CallCondition::Always | CallCondition::ByDefault => Confidence::Likely,
        CallCondition::Perhaps | CallCondition::Off => Confidence::Hint,
    };
    let place = |word: Option<&Word>| word.map(|word| Place::text(source, word.span));
    Ok(Claim {
        target_place: place(parent).filter(|_| frames.is_some()),
        source_place: place(child).filter(|_| frames.is_some()),
        frames,
        label: publisher.label.clone(),
        pose,
        has_rotation: true,
        has_translation: true,
        spelling,
        translation_literals: written_ones(translation),
        rotation_literals: written_ones(rotation),
        kind: ClaimKind::File {
            dialect: DIALECT.to_owned(),
            roles: false,
        },
        reading,
        doubt: None,
        place: publisher.place.clone(),
    })
}

/// Numbers that flags omit are zero and are written nowhere.
fn literals(words: &[Option<&Word>]) -> Result<Vec<Literal>, ReadObstacle> {
    let literal = |word: Option<&Word>| match word {
        None => Ok(written(0.0, Span::default())),
        Some(word) => match number(&word.text) {
            Some(value) if !word.is_open => Ok(Literal {
                text: word.text.as_str().into(),
                value,
                span: word.span,
            }),
            _ if word.is_open => Err(ReadObstacle::Open(word.text.clone())),
            _ => Err(ReadObstacle::Misread(format!(
                "`{}` is not a number where one is required",
                word.text
            ))),
        },
    };
    words.iter().copied().map(literal).collect()
}

fn written(value: f64, span: Span) -> Literal {
    Literal {
        text: value.to_string().into(),
        value,
        span,
    }
}

/// All literals, or none if one of them is written nowhere.
fn written_ones(literals: Vec<Literal>) -> Vec<Literal> {
    if literals.iter().any(|literal| literal.span == Span::default()) {
        Vec::new()
    } else {
        literals
    }
}

fn values<const N: usize>(literals: &[Literal]) -> Option<[f64; N]> {
    let values: Vec<f64> = literals.iter().map(|literal| literal.value).collect();
    values.try_into().ok()
}
