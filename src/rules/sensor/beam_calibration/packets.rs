//! The model of a calibration compared with that of packets. Part of SENSOR11.

use crate::analysis::beams::BeamFit;
use crate::verdict::{Finding, Judge, Measured};
use crate::world::{BeamCalibration, World};

/// A recording's packets and the calibrations beside them are of the same models.
pub(super) fn judge(world: &World, files: &[(&BeamCalibration, Option<BeamFit>)], out: &mut Judge) {
    let known: Vec<(&BeamCalibration, &str)> = files
        .iter()
        .filter_map(|(file, fit)| Some((*file, fit.as_ref()?.model.name)))
        .collect();
    for topic in world.bags.iter().flat_map(|bag| bag.topics.values()) {
        let sensor = topic.content.clouds.as_ref().and_then(|clouds| clouds.packets.as_ref());
        let Some(sensor) = sensor else { continue };
        let of_maker: Vec<_> = known.iter().filter(|(file, _)| file.maker == sensor.maker).collect();
        let Some((file, name)) = of_maker.first().copied() else {
            continue;
        };
        let subject = format!("model of the packets on `{}`", topic.topic);
        let measured = [Measured::count("calibrations of this maker", of_maker.len())];
        if of_maker.iter().any(|(_, name)| *name == sensor.model) {
            out.pass(subject, measured);
            continue;
        }
        let message = format!(
            "`{}`: the angles are those of a {name}, but `{}` has packets of a {}",
            world.path(file.place.source),
            topic.topic,
            sensor.model
        );
        let finding = Finding::warning(subject, message, file.place.clone())
            .likely()
            .relation("model");
        let detail = "No calibration beside the recording is of the model of its packets.";
        out.fail(
            finding
                .detail(detail)
                .help("use the calibration of this sensor")
                .measured(measured),
        );
    }
}
