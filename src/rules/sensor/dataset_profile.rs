//! SENSOR10: calibrations, transforms and data compared with the conventions of the dataset that the user names.

mod data;

mod records;

use std::path::Path;

use nalgebra::{UnitQuaternion, Vector3};

use crate::analysis::sensor::dataset::{Limits, rotation};
use crate::analysis::{cross::pair::Statement, cross::statements::statements, suffix::axes_in_words};
use crate::math::{rotation::rpy_in_words, stats::rounded};
use crate::rules::prelude::*;
use crate::tables::{Dataset, DatasetFrame};
use crate::world::{Claim, FrameId, NamedDataset, World};

pub(crate) struct DatasetProfile;

impl Rule for DatasetProfile {
    const NEEDS: &'static [Need] = &[];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let Some(dataset) = &world.dataset else {
            let why = "no dataset is named: set for example `dataset: KITTI` in frames-lint.yaml";
            return out.missing("dataset", why);
        };
        let mut count = 0;
        for statement in statements(world) {
            let path = world.path(statement.place.source);
            // The file's own names come first: words of several programs are unified (`velo` is a lidar).
            let called = [&statement.called.0, &statement.called.1].map(|frame| known(&dataset.row, frame, path));
            let [target, source] =
                [&statement.target, &statement.source_frame].map(|frame| known(&dataset.row, frame, path));
            let frames = [called[0].or(target), called[1].or(source)];
            if let [Some(target), Some(source)] = frames
                && statement.has_rotation
            {
                count += 1;
                judge_statement(world, dataset, &statement, (target, source), limits, out);
            }
        }
        count += records::judge(world, dataset, limits, out);
        count += data::judge(world, dataset, limits, out);
        if count == 0 {
            let why = format!(
                "no transform, record, sensor or cloud is of frames that the table has for {} ({})",
                dataset.row.name, dataset.row.source
            );
            out.missing("dataset", why);
        }
    }
}

/// What is known of a frame. `S`, or the dialect's `sensor`, is the sensor whose file it is, as in EuRoC's `cam0/sensor.yaml`.
fn known<'d>(dataset: &'d Dataset, frame: &FrameId, path: &str) -> Option<&'d DatasetFrame> {
    let name = frame.as_str().to_lowercase();
    if !matches!(name.as_str(), "s" | "sensor") {
        return dataset.frame(&name);
    }
    let path = Path::new(path);
    let folder = path.parent().and_then(Path::file_name);
    let places = [folder, path.file_stem()].into_iter().flatten();
    let mut names = places.flat_map(|place| {
        let place = FrameId::new(place.to_string_lossy());
        let whole = place.as_str().to_lowercase();
        std::iter::once(whole).chain(place.tokens())
    });
    names.find_map(|name| dataset.frame(&name))
}

/// How far a rotation is from that between two frames of the dataset, degrees. Where one of them may have any yaw, only its tilt counts.
fn off_deg(turn: &UnitQuaternion<f64>, target: &DatasetFrame, source: &DatasetFrame) -> f64 {
    let [body_from_target, body_from_source] = [target, source].map(|frame| rotation(&frame.axes));
    if target.any_yaw || source.any_yaw {
        let up = Vector3::z();
        let stated = turn * (body_from_source.inverse() * up);
        return stated.angle(&(body_from_target.inverse() * up)).to_degrees();
    }
    let expected = body_from_target.inverse() * body_from_source;
    expected.angle_to(turn).to_degrees()
}

/// The nearest choice of forward, back, left, right, up and down for the axes of a frame with this rotation on the vehicle.
pub(super) fn nearest_word(body_from_frame: &UnitQuaternion<f64>) -> String {
    let letter = |axis: Vector3<f64>| {
        let stated = body_from_frame * axis;
        let words = [("F", "B"), ("L", "R"), ("U", "D")];
        let (index, value) = stated
            .iter()
            .copied()
            .enumerate()
            .fold((0, 0.0_f64), |best, (index, value)| {
                if value.abs() > best.1.abs() {
                    (index, value)
                } else {
                    best
                }
            });
        let (plus, minus) = words.get(index).copied().unwrap_or(("?", "?"));
        if value >= 0.0 { plus } else { minus }
    };
    [Vector3::x(), Vector3::y(), Vector3::z()].map(letter).concat()
}

fn judge_statement(
    world: &World,
    dataset: &NamedDataset,
    statement: &Statement,
    (target, source): (&DatasetFrame, &DatasetFrame),
    limits: &Limits,
    out: &mut Judge,
) {
    let (Dataset { name, .. }, turn) = (&*dataset.row, statement.pose.rotation);
    let source_frame = &statement.source_frame;
    let subject = format!(
        "`{}` from `{source_frame}` by {} in {}",
        statement.target,
        statement.who,
        world.path(statement.place.source)
    );
    let off = off_deg(&turn, target, source);
    let measured = Measured::new(format!("angle from the rotation of {name}"), off, "deg").limit(limits.max_off_deg);
    if off <= limits.max_off_deg {
        return out.pass(subject, [measured]);
    }
    let fits = |turn: &UnitQuaternion<f64>| off_deg(turn, target, source) <= limits.max_off_deg;
    let [x, y, z, w] = <[f64; 4]>::from(turn.coords);
    // Tables of sensors are read as w, x, y, z, other files as x, y, z, w.
    let is_row = statement.claim(world).is_some_and(Claim::is_row);
    let [w, x, y, z] = if is_row { [z, w, x, y] } else { [x, y, z, w] };
    let reordered = UnitQuaternion::new_normalize(nalgebra::Quaternion::new(w, x, y, z));
    let (relation, what, why) = if fits(&turn.inverse()) {
        (
            "inverse",
            format!("has the inverse of the {name} rotation"),
            String::new(),
        )
    } else if statement.is_bare_quaternion() && fits(&reordered) {
        let why = " In the other order of the four numbers the rotation matches.".to_owned();
        (
            "quaternion-order",
            format!("is not in the quaternion order of {name}"),
            why,
        )
    } else {
        let found = nearest_word(&(rotation(&target.axes) * turn));
        let why = format!(
            " If `{}` has {}, the stated rotation means that `{source_frame}` has {} (to the nearest axes). In {name} `{source_frame}` \
             has {}.",
            statement.target,
            axes_in_words(&target.axes.word),
            axes_in_words(&found),
            axes_in_words(&source.axes.word)
        );
        ("axes", format!("is rotated from the {name} transform"), why)
    };
    let expected = rotation(&target.axes).inverse() * rotation(&source.axes);
    let message = format!("`{}` -> `{source_frame}` {what} ({off:.0} deg off)", statement.target);
    let to_do = match relation {
        "quaternion-order" if is_row => "write the quaternion as w, x, y, z, to get a rotation of",
        "quaternion-order" => "write the quaternion as x, y, z, w, to get a rotation of",
        "inverse" => "transpose the rotation (the translation is not judged here), to get a rotation of",
        _ => "set the rotation to",
    };
    let numbers = match <[f64; 4]>::from(expected.coords).map(|value| rounded(value, 4)) {
        _ if target.any_yaw || source.any_yaw => ", apart from the yaw of this sensor".to_owned(),
        [x, y, z, w] if is_row => format!(" (w, x, y, z = {w}, {x}, {y}, {z})"),
        [x, y, z, w] if statement.is_bare_quaternion() => format!(" (x, y, z, w = {x}, {y}, {z}, {w})"),
        _ => String::new(),
    };
    let entry = if is_row { "entry " } else { "" };
    let mut finding = Finding::error(subject, message, statement.place.clone())
        .likely()
        .confidence(statement.reading)
        .relation(relation)
        .detail(format!(
            "Stated by {entry}{}.{why} Source of the convention: {}.",
            statement.who, dataset.row.source
        ))
        .help(format!(
            "{to_do} about {}{numbers}; if the data are not of {name}, or were converted to other axes, remove `dataset` from the \
             configuration",
            rpy_in_words(&expected)
        ))
        .measured(measured);
    if let Some(place) = &dataset.place {
        finding = finding.related(place.clone(), "named here");
    }
    out.fail(finding);
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use nalgebra::Matrix3;

    fn frame(axes: &str, any_yaw: bool) -> DatasetFrame {
        serde_yaml::from_str(&format!("{{names: [a], axes: {axes}, any_yaw: {any_yaw}}}")).unwrap()
    }

    #[test]
    fn the_rotation_of_kitti_is_that_of_its_files() {
        // calib_velo_to_cam.txt of the drives of 2011-09-26.
        let velo_to_cam = Matrix3::new(
            7.533_745e-3,
            -0.999_971_4,
            -6.166_02e-4,
            1.480_249e-2,
            7.280_733e-4,
            -0.999_890_2,
            0.999_862_1,
            7.523_79e-3,
            1.480_755e-2,
        );
        let turn = UnitQuaternion::from_matrix(&velo_to_cam);
        let (cam, velo) = (frame("RDF", false), frame("FLU", false));
        assert!(off_deg(&turn, &cam, &velo) < 2.0);
        assert!(off_deg(&turn.inverse(), &cam, &velo) > 90.0);
        assert!(off_deg(&turn.inverse(), &velo, &cam) < 2.0);
    }

    #[test]
    fn a_frame_that_may_look_aside_is_held_to_what_is_upright() {
        let (ego, cam) = (frame("FLU", false), frame("RDF", true));
        let front = rotation(&cam.axes);
        let aside = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 1.0) * front;
        assert!(off_deg(&front, &ego, &cam) < 1e-6 && off_deg(&aside, &ego, &cam) < 1e-6);
        let tilted = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 1.0) * front;
        assert!((off_deg(&tilted, &ego, &cam) - 1.0_f64.to_degrees()).abs() < 1e-6);
    }

    #[test]
    fn axes_have_the_nearest_word() {
        for word in ["FLU", "RDF", "URF", "FRD"] {
            assert_eq!(nearest_word(&rotation(&frame(word, false).axes)), word);
        }
    }
}
