//! SENSOR02: the parts of an Ouster by TF, URDF and files compared with its metadata; and its metadata compared with known models.

mod beams;

use nalgebra::Vector3;

use crate::analysis::ouster::Part;
use crate::rules::{prelude::*, sensor::ouster_tf_metadata::beams::Limits};
use crate::tables::OusterPart;
use crate::world::World;

pub(crate) struct OusterTfMetadata;

impl Rule for OusterTfMetadata {
    const NEEDS: &'static [Need] = &[Need::TransformsOrBag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let parts = Part::all(world);
        for part in &parts {
            Statement::of(world, part, &parts).judge(limits, out);
        }
        beams::judge(world, &parts, limits, out);
    }
}

/// Sensors whose metadata are compared: no platform has more.
const MAX_SENSORS: usize = 64;

/// A known position, and its source.
type KnownPlace = (Vector3<f64>, String);

/// A statement that is judged, and what it is compared with.
struct Statement<'p, 'w> {
    part: &'p Part<'w>,
    subject: String,
    /// The positions that it may have.
    known: Vec<KnownPlace>,
    /// The positions of other models.
    others: Vec<KnownPlace>,
    /// Whether the sensor's own metadata state it.
    is_stated: bool,
    /// The sensor by its metadata, in words.
    model: Option<String>,
}

impl<'p, 'w> Statement<'p, 'w> {
    fn of(world: &World, part: &'p Part<'w>, parts: &[Part<'_>]) -> Self {
        let path = |of: &Part<'_>| world.path(of.statement.place.source).to_owned();
        // Available metadata state it exactly: those of its own recording, else of any sensor.
        let is_beside = |other: &&Part<'_>| other.metadata.is_some() && other.kind == part.kind;
        let beside = || {
            let all = parts.iter().filter(|other| part.metadata.is_none() && is_beside(other));
            all.take(MAX_SENSORS)
        };
        let own = || beside().filter(|other| path(other) == path(part));
        let stated: Vec<&Part<'_>> = if own().count() > 0 {
            own().collect()
        } else {
            beside().collect()
        };
        let by_metadata = stated.iter().map(|other| {
            let place = other.pose.translation.vector * 1e3;
            (place, format!("{} in {}", other.statement.label, path(other)))
        });
        let product = part.metadata.and_then(|metadata| metadata.product.as_deref());
        let image = part.metadata.and_then(|metadata| metadata.image.as_deref());
        let (known, others): (Vec<_>, Vec<_>) = world
            .tables
            .ouster_places(part.kind)
            .partition(|row| row.may_be_of(product, image));
        let row = |row: &crate::tables::OusterPlace| (Vector3::from(row.xyz_mm), row.models.clone());
        let is_stated = !stated.is_empty();
        Self {
            subject: format!(
                "`{}` from `{}` by {} in {}",
                part.statement.target,
                part.statement.source_frame,
                part.statement.who,
                path(part)
            ),
            known: if is_stated {
                by_metadata.collect()
            } else {
                known.into_iter().map(row).collect()
            },
            others: if is_stated {
                Vec::new()
            } else {
                others.into_iter().map(row).collect()
            },
            is_stated,
            model: product.map(|product| match image.and_then(board) {
                Some(board) => format!("an {product} with the firmware image `{board}`"),
                None => format!("an {product}"),
            }),
            part,
        }
    }

    fn judge(self, limits: &Limits, out: &mut Judge) {
        let statement = &self.part.statement;
        let turned_deg = self.part.turn().angle_to(&self.part.pose.rotation).to_degrees();
        let place_mm = self.part.pose.translation.vector * 1e3;
        let nearest = self
            .known
            .iter()
            .map(|known| ((known.0 - place_mm).norm(), known))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let is_turned = turned_deg > limits.max_turn_deg;
        let turn = Measured::new("rotation from the expected one", turned_deg, "deg")
            .turn()
            .limit(limits.max_turn_deg);
        let (Some((off_mm, nearest)), _) = (nearest, is_turned) else {
            let model = self.model.as_deref().unwrap_or("this sensor");
            let why = format!(
                "the table has no metadata of {model}: the right position of the part is unknown (its rotation is {turned_deg:.2} deg off)"
            );
            return out.missing(self.subject, why);
        };
        let max_mm = self.max_mm(limits);
        let measured = [
            turn,
            Measured::new("distance from the nearest known position", off_mm, "mm").limit(max_mm),
        ];
        if !is_turned && off_mm <= max_mm {
            return out.pass(self.subject, measured);
        }
        let (relation, what, why) = self.fault(turned_deg, off_mm, limits);
        let ([x, y, z], who) = (<[f64; 3]>::from(nearest.0), &nearest.1);
        let message = format!("`{}` -> `{}` {what}", statement.target, statement.source_frame);
        let detail = format!(
            "{why}Expected in the {} frame: x {x:.3}, y {y:.3}, z {z:.3} mm{} ({who}).",
            if self.part.kind == OusterPart::Beam {
                "Lidar"
            } else {
                "Sensor"
            },
            match self.part.kind {
                OusterPart::Lidar => ", rotated by 180 deg about z",
                OusterPart::Imu | OusterPart::Beam => ", not rotated",
            }
        );
        // A position that no table has may be that of a new model.
        let is_sure = relation != "place" || self.is_stated;
        let finding = if is_sure {
            Finding::error(self.subject.clone(), message, statement.place.clone()).likely()
        } else {
            Finding::warning(self.subject.clone(), message, statement.place.clone()).hint()
        };
        let help = self.step(relation);
        let finding = finding.confidence(statement.reading).relation(relation).detail(detail);
        out.fail(finding.help(help).measured(measured));
    }

    /// What to do, by the relation.
    fn step(&self, relation: &str) -> &'static str {
        match relation {
            _ if self.part.metadata.is_some() => {
                "read the metadata from the sensor again: their transforms are in millimetres"
            }
            "inverse" => "invert the transform: the pose of the child in the parent is meant",
            "identity" => "set the yaw of the Lidar frame in the Sensor frame to 180 deg (pi)",
            "unit" => "convert the translation to metres",
            _ => {
                "use `lidar_to_sensor_transform` and `imu_to_sensor_transform` of the sensor's metadata: the poses of the parts in the \
                 Sensor frame, in millimetres"
            }
        }
    }

    fn max_mm(&self, limits: &Limits) -> f64 {
        match self.part.kind {
            OusterPart::Beam => limits.max_beam_mm,
            OusterPart::Lidar | OusterPart::Imu => limits.max_off_mm,
        }
    }

    /// The relation, what is wrong, and a sentence of evidence that may be empty.
    fn fault(&self, turned_deg: f64, off_mm: f64, limits: &Limits) -> (&'static str, String, String) {
        let plain = |relation, what: String| (relation, what, String::new());
        let max_mm = self.max_mm(limits);
        let among = |places: &[KnownPlace], mm: Vector3<f64>| {
            places
                .iter()
                .find(|(place, _)| (place - mm).norm() <= max_mm)
                .map(|(_, who)| who.clone())
        };
        let pose = &self.part.pose;
        let place_mm = pose.translation.vector * 1e3;
        let inverse = pose.inverse();
        let is_turned = turned_deg > limits.max_turn_deg;
        let is_inverse = self.part.turn().angle_to(&inverse.rotation).to_degrees() <= limits.max_turn_deg
            && among(&self.known, inverse.translation.vector * 1e3).is_some();
        if off_mm > max_mm && is_inverse {
            return plain("inverse", "is the inverse of the expected transform".to_owned());
        }
        let is_none = pose.rotation.angle().to_degrees() <= limits.known_deg;
        if is_turned && self.part.kind == OusterPart::Lidar && is_none {
            let what = "lacks the rotation by 180 deg about z of the Lidar frame";
            return (
                "identity",
                what.to_owned(),
                "Clouds appear behind the vehicle. ".to_owned(),
            );
        }
        if is_turned {
            return plain(
                "turned",
                format!("is rotated {turned_deg:.2} deg off the expected rotation"),
            );
        }
        for (scale, what) in [
            (1e-3, "millimetres instead of metres"),
            (1e3, "metres instead of millimetres"),
        ] {
            if among(&self.known, place_mm * scale).is_some() {
                return plain("unit", format!("is in {what}"));
            }
        }
        if let (Some(who), Some(model)) = (among(&self.others, place_mm), &self.model) {
            let why = format!("It is the position in {who}, but this is {model}. ");
            return ("model", "has the position of another model".to_owned(), why);
        }
        plain("place", format!("is {off_mm:.2} mm from the nearest known position"))
    }
}

/// The board in the name of an image: `ousteros-image-prod-aries-v2.5.2`.
fn board(image: &str) -> Option<&str> {
    image.split('-').find(|word| matches!(*word, "aries" | "bootes"))
}
