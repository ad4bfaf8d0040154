//! Calibrations of the beams of lidars: of velodyne_pointcloud (YAML), and of Hesai (a table of channels, elevations and azimuths).
//!
//! Owns their keys. Sources: ros-drivers/velodyne `calibration.cc` (angles in radians, lasers from 0); tier4/nebula
//! `hesai_common.hpp` (degrees, channels from 1, before which a line with the mark `EEFF` may be).

use crate::source::{Place, SourceId};
use crate::world::BeamCalibration;
use crate::world::beams::Beam;
use crate::world::ouster::PlacedNumber;

use super::document::Node;

/// Names of the columns of a table of Hesai: of the channel, the elevation and the azimuth.
const CHANNELS: [&str; 4] = ["laser id", "channel", "laser_id", "channel id"];
const ELEVATION: &str = "elevation";
const AZIMUTH: &str = "azimuth";
/// The keys of a laser of Velodyne.
const LASER: [&str; 3] = ["laser_id", "vert_correction", "rot_correction"];

/// Whether these are the names of columns of Hesai's table.
pub(super) fn are_columns(names: &[String]) -> bool {
    let has = |name: &str| names.iter().any(|known| known == name);
    CHANNELS.iter().any(|name| has(name)) && has(ELEVATION) && has(AZIMUTH)
}

/// The calibration of a document, if it is one.
pub(super) fn collect(root: &Node, source: SourceId) -> Option<BeamCalibration> {
    velodyne(root, source).or_else(|| hesai(root, source))
}

fn velodyne(root: &Node, source: SourceId) -> Option<BeamCalibration> {
    let list = root.get("lasers")?;
    let items = list.items()?;
    items
        .iter()
        .any(|item| LASER.iter().all(|key| item.get(key).is_some()))
        .then_some(())?;
    let stated = |key: &str| {
        let node = root.get(key)?;
        let value = number(node)?;
        Some(PlacedNumber {
            value,
            place: Place::text(source, node.span),
        })
    };
    Some(BeamCalibration {
        maker: "Velodyne".to_owned(),
        is_radians: true,
        stated: stated("num_lasers"),
        resolution_m: stated("distance_resolution"),
        ..beams(list, items, LASER, source)
    })
}

/// The table is a list under the name of the file.
fn hesai(root: &Node, source: SourceId) -> Option<BeamCalibration> {
    let [(_, list)] = root.pairs() else { return None };
    let items = list.items()?;
    let first = items.first()?;
    let channel = CHANNELS.into_iter().find(|name| first.get(name).is_some())?;
    (first.get(ELEVATION).is_some() && first.get(AZIMUTH).is_some()).then_some(())?;
    Some(beams(list, items, [channel, ELEVATION, AZIMUTH], source))
}

fn beams(list: &Node, items: &[Node], [id, elevation, azimuth]: [&str; 3], source: SourceId) -> BeamCalibration {
    let mut broken = None;
    let mut beams = Vec::with_capacity(items.len());
    for item in items {
        let beam = || {
            Some(Beam {
                id: item.get(id)?.text()?.trim().parse().ok()?,
                elevation: number(item.get(elevation)?)?,
                azimuth: number(item.get(azimuth)?)?,
                place: Place::text(source, item.span),
            })
        };
        match beam() {
            Some(beam) => beams.push(beam),
            None => {
                broken.get_or_insert_with(|| Place::text(source, item.span));
            }
        }
    }
    BeamCalibration {
        place: Place::text(source, list.span),
        maker: "Hesai".to_owned(),
        is_radians: false,
        stated: None,
        resolution_m: None,
        beams,
        broken,
    }
}

fn number(node: &Node) -> Option<f64> {
    let value: f64 = node.text()?.trim().parse().ok()?;
    value.is_finite().then_some(value)
}
