//! Poses whose distances have another scale than those of something that measures metres.

use crate::source::Place;
use crate::verdict::Finding;

/// Units that positions are published in by mistake, metres.
const UNITS: [(f64, &str); 4] = [
    (0.001, "millimetres"),
    (0.01, "centimetres"),
    (0.3048, "feet"),
    (1609.344, "miles"),
];

/// The finding on poses, by their name, that move a metre where `measure` moves `scale` metres; a unit is recognised within a share.
pub(crate) fn wrong_scale(
    (subject, place): (String, Place),
    (poses, measure): (&str, &str),
    scale: f64,
    within: f64,
) -> Finding {
    let unit = UNITS.iter().find(|(unit, _)| (scale / unit - 1.0).abs() <= within);
    let detail = unit.map_or_else(
        || "Usual causes: a wrong wheel radius or number of ticks, or a wrong unit.".to_owned(),
        |(_, name)| format!("The positions of the odometry are probably in {name}."),
    );
    let message = format!(
        "{poses}: the odometry moves {:.3} m for each metre of {measure}",
        1.0 / scale
    );
    Finding::warning(subject, message, place)
        .likely()
        .relation("scale")
        .detail(detail)
        .help(format!(
            "multiply the distances of the odometry by {scale:.3}, at their source: wheel radius, ticks, or unit"
        ))
}
