//! Which model a calibration of beams is of, and by which mistake it differs from that model's published angles.
//!
//! Must not judge.

use crate::source::Place;
use crate::tables::beams::{BeamModel, models};
use crate::world::BeamCalibration;
use crate::world::beams::Beam;

/// How the elevations of a file relate to those of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Written {
    AsMeant,
    /// With the other sign, or from the last beam to the first where these are opposite.
    UpsideDown,
    /// From the last beam to the first.
    Backwards,
    /// In degrees where radians are meant, or the reverse.
    OtherUnit,
}

/// The nearest model of a calibration.
pub(crate) struct BeamFit {
    pub(crate) model: BeamModel,
    pub(crate) written: Written,
    /// The largest difference of elevations after the mistake is undone, and before, degrees.
    pub(crate) off_deg: [f64; 2],
    /// The largest difference of azimuths as they are written, and with the other sign, degrees.
    pub(crate) azimuth_off_deg: Option<[f64; 2]>,
}

/// What is wrong with the numbers of the lasers.
pub(crate) enum Numbering<'w> {
    Whole,
    Twice(&'w Beam),
    /// The first number that is missing.
    Missing(u32),
}

/// The numbers of the beams: Velodyne counts from 0, Hesai from 1.
pub(crate) fn numbering(file: &BeamCalibration) -> Numbering<'_> {
    let first = u32::from(file.maker == "Hesai");
    let mut seen = std::collections::BTreeSet::new();
    if let Some(beam) = file.beams.iter().find(|beam| !seen.insert(beam.id)) {
        return Numbering::Twice(beam);
    }
    let missing = (first..).zip(&seen).find(|(wanted, id)| wanted != *id);
    missing.map_or(Numbering::Whole, |(wanted, _)| Numbering::Missing(wanted))
}

/// The models that have as many beams.
pub(crate) fn sized(file: &BeamCalibration) -> impl Iterator<Item = BeamModel> {
    models().filter(|model| model.maker == file.maker && model.count() == file.beams.len())
}

/// The model whose elevations are nearest, by the least mistake.
pub(crate) fn fit(file: &BeamCalibration) -> Option<BeamFit> {
    let mut beams: Vec<&Beam> = file.beams.iter().collect();
    beams.sort_by_key(|beam| beam.id);
    let degrees = |value: f64| if file.is_radians { value.to_degrees() } else { value };
    let other = |value: f64| if file.is_radians { value } else { value.to_degrees() };
    let read: Vec<f64> = beams.iter().map(|beam| degrees(beam.elevation)).collect();
    let azimuths: Vec<f64> = beams.iter().map(|beam| degrees(beam.azimuth)).collect();
    let forms = [
        (Written::AsMeant, read.clone()),
        (Written::UpsideDown, read.iter().map(|angle| -angle).collect()),
        (Written::Backwards, read.iter().rev().copied().collect()),
        (
            Written::OtherUnit,
            beams.iter().map(|beam| other(beam.elevation)).collect(),
        ),
    ];
    let mut best: Option<BeamFit> = None;
    for model in sized(file) {
        let table = model.elevations_deg();
        if table.is_empty() {
            continue;
        }
        for (written, angles) in &forms {
            let off = farthest(angles, &table);
            // A mistake must explain much more than none.
            if best.as_ref().is_none_or(|best| off + 0.01 < best.off_deg[0]) {
                let known = model.azimuths_deg();
                let mirrored: Vec<f64> = azimuths.iter().map(|angle| -angle).collect();
                best = Some(BeamFit {
                    model,
                    written: *written,
                    off_deg: [off, farthest(&read, &table)],
                    azimuth_off_deg: (!known.is_empty())
                        .then(|| [farthest(&azimuths, &known), farthest(&mirrored, &known)]),
                });
            }
        }
    }
    best
}

/// The beam that points farthest up or down, as its driver reads it, degrees.
pub(crate) fn steepest(file: &BeamCalibration) -> Option<(f64, &Place)> {
    let degrees = |beam: &Beam| {
        if file.is_radians {
            beam.elevation.to_degrees()
        } else {
            beam.elevation
        }
    };
    let all = file.beams.iter().map(|beam| (degrees(beam), &beam.place));
    all.max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))
}

fn farthest(angles: &[f64], others: &[f64]) -> f64 {
    angles
        .iter()
        .zip(others)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}
