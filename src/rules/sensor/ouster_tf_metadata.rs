//! SENSOR02: the parts of an Ouster where TF, URDF and files have them, against its metadata.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use serde::Deserialize;

use crate::rules::cross::statements::{Statement, statements};
use crate::rules::{Judge, Need, Rule};
use crate::tables::{OusterPart, ouster_places};
use crate::verdict::{Finding, Measured, NotEvaluated};
use crate::world::{FrameId, World};

/// SENSOR02.
pub struct OusterTfMetadata;

/// Limits of SENSOR02.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(clippy::struct_field_names)] // each is a largest one
pub struct Limits {
    max_off_mm: f64,
    max_turn_deg: f64,
    max_known_deg: f64,
}

/// A statement of where a part is in the Sensor frame.
struct Part {
    of: OusterPart,
    /// `sensor_from_part`.
    pose: Isometry3<f64>,
    /// Whether it is the sensor's own metadata.
    is_metadata: bool,
    statement: Statement,
}

impl Rule for OusterTfMetadata {
    const PAGE: &'static str = include_str!("../../../rules/sensor/ouster-tf-metadata.md");
    const NEEDS: &'static [Need] = &[Need::TransformsOrBag];
    type Limits = Limits;

    fn judge(world: &World, limits: &Limits, out: &mut Judge) {
        let parts: Vec<Part> = statements(world).into_iter().filter_map(Part::of).collect();
        for part in &parts {
            part.judge(world, &parts, limits, out);
        }
    }
}

/// A frame of an Ouster.
enum Named {
    Sensor,
    Part(OusterPart),
}

/// Which frame of an Ouster a name is: `os_sensor`, `os1_lidar`, `front/os_imu`.
fn named(frame: &FrameId, is_metadata: bool) -> Option<Named> {
    let tokens = frame.tokens();
    let is_ouster = |token: &String| {
        let rest = token.strip_prefix("os");
        token == "ouster" || rest.is_some_and(|rest| rest.chars().all(|letter| letter.is_ascii_digit()))
    };
    if !is_metadata && !tokens.iter().any(is_ouster) {
        return None;
    }
    match tokens.last().map(String::as_str)? {
        "sensor" => Some(Named::Sensor),
        "lidar" => Some(Named::Part(OusterPart::Lidar)),
        "imu" => Some(Named::Part(OusterPart::Imu)),
        _ => None,
    }
}

impl Part {
    fn of(statement: Statement) -> Option<Self> {
        let is_metadata = statement.label.ends_with("_to_sensor_transform");
        if !statement.has_rotation || !statement.has_translation {
            return None;
        }
        let known = [&statement.target, &statement.source_frame].map(|name| named(name, is_metadata));
        let (part, pose) = match known {
            [Some(Named::Sensor), Some(Named::Part(part))] => (part, statement.pose),
            [Some(Named::Part(part)), Some(Named::Sensor)] => (part, statement.pose.inverse()),
            _ => return None,
        };
        Some(Self {
            of: part,
            pose,
            is_metadata,
            statement,
        })
    }

    /// How it should be turned.
    fn turn(&self) -> UnitQuaternion<f64> {
        match self.of {
            OusterPart::Lidar => UnitQuaternion::from_axis_angle(&Vector3::z_axis(), std::f64::consts::PI),
            OusterPart::Imu => UnitQuaternion::identity(),
        }
    }

    fn judge(&self, world: &World, parts: &[Self], limits: &Limits, out: &mut Judge) {
        let statement = &self.statement;
        let path = world.path(statement.place.source);
        let subject = format!(
            "`{}` from `{}` by {} in {path}",
            statement.target, statement.source_frame, statement.who
        );
        // Metadata beside it say it exactly; of several sensors any may be meant.
        let stated: Vec<&Self> = parts
            .iter()
            .filter(|other| !self.is_metadata && other.is_metadata && other.of == self.of)
            .collect();
        let known: Vec<(Vector3<f64>, String)> = if stated.is_empty() {
            let rows = ouster_places(self.of);
            rows.map(|row| (Vector3::from(row.xyz_mm), row.models.clone()))
                .collect()
        } else {
            let own = stated.iter().map(|other| {
                let place = other.pose.translation.vector * 1e3;
                (
                    place,
                    format!(
                        "{} in {}",
                        other.statement.label,
                        world.path(other.statement.place.source)
                    ),
                )
            });
            own.collect()
        };
        let turned_deg = self.turn().angle_to(&self.pose.rotation).to_degrees();
        let place_mm = self.pose.translation.vector * 1e3;
        let nearest = known
            .iter()
            .map(|(place, who)| ((place - place_mm).norm(), who))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((off_mm, who)) = nearest else {
            return out.not_evaluated(subject, NotEvaluated::MissingInput, "nothing says where it should be");
        };
        let measured = [
            Measured::new("rotation from what it should be", turned_deg, "deg").limit(limits.max_turn_deg),
            Measured::new("distance from the nearest place that is known", off_mm, "mm").limit(limits.max_off_mm),
        ];
        if turned_deg <= limits.max_turn_deg && off_mm <= limits.max_off_mm {
            return out.pass(subject, measured);
        }
        let (relation, what) = self.fault(&known, turned_deg, off_mm, limits);
        let message = format!(
            "{subject}: {what}; known is x {:.3}, y {:.3}, z {:.3} mm{} ({who})",
            known_place(&known, &place_mm).x,
            known_place(&known, &place_mm).y,
            known_place(&known, &place_mm).z,
            match self.of {
                OusterPart::Lidar => ", turned by 180 deg about z",
                OusterPart::Imu => ", not turned",
            }
        );
        // A place that no table has may be that of a new model.
        let is_sure = relation != "place" || !stated.is_empty();
        let finding = if is_sure {
            Finding::error(subject.clone(), message, statement.place.clone())
        } else {
            Finding::warning(subject.clone(), message, statement.place.clone())
        };
        let finding = if is_sure { finding.likely() } else { finding.hint() };
        let finding = finding.confidence(statement.reading).relation(relation).help(
            "take `lidar_to_sensor_transform` and `imu_to_sensor_transform` of the sensor's metadata, millimetres: they are the poses of the \
             parts in the Sensor frame",
        );
        out.fail(measured.into_iter().fold(finding, Finding::measured));
    }

    /// What is wrong, and its name.
    fn fault(
        &self,
        known: &[(Vector3<f64>, String)],
        turned_deg: f64,
        off_mm: f64,
        limits: &Limits,
    ) -> (&'static str, String) {
        let is_place = |mm: Vector3<f64>| known.iter().any(|(place, _)| (place - mm).norm() <= limits.max_off_mm);
        let inverse = self.pose.inverse();
        let is_turned = turned_deg > limits.max_turn_deg;
        let is_inverse = self.turn().angle_to(&inverse.rotation).to_degrees() <= limits.max_turn_deg
            && is_place(inverse.translation.vector * 1e3);
        if off_mm > limits.max_off_mm && is_inverse {
            return ("inverse", "it is told the wrong way round".to_owned());
        }
        if is_turned && self.of == OusterPart::Lidar && self.pose.rotation.angle().to_degrees() <= limits.max_known_deg
        {
            return (
                "identity",
                "it is not turned, where the Lidar frame is turned by half a turn: clouds come out behind the car"
                    .to_owned(),
            );
        }
        if is_turned {
            return (
                "turned",
                format!("it is turned by {turned_deg:.2} deg from what it should be"),
            );
        }
        ("place", format!("it is {off_mm:.2} mm from any place that is known"))
    }
}

fn known_place(known: &[(Vector3<f64>, String)], place_mm: &Vector3<f64>) -> Vector3<f64> {
    let off = |(place, _): &&(Vector3<f64>, String)| (place - place_mm).norm();
    let nearest = known.iter().min_by(|a, b| off(a).total_cmp(&off(b)));
    nearest.map_or_else(Vector3::zeros, |(place, _)| *place)
}
