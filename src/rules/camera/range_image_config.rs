//! CAMERA08: declared range images, compared with the clouds that they are made of.

use crate::analysis::camera::declared::name;
use crate::analysis::camera::range_images::{Limits, against, alone, beams, clouds};
use crate::rules::prelude::*;
use crate::world::projection::{Form, Projection, RangeImage};

pub(crate) struct RangeImageConfig;

impl Rule for RangeImageConfig {
    const NEEDS: &'static [Need] = &[];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        let declared: Vec<(&Projection, &RangeImage)> = world
            .projections()
            .filter_map(|projection| match &projection.form {
                Form::RangeImage(image) => Some((projection, image)),
                _ => None,
            })
            .collect();
        for (projection, image) in &declared {
            let subject = format!("range image {}", name(world, projection));
            let mut faults = alone(image);
            let clouds = match clouds(world, projection, &declared) {
                Ok(clouds) => clouds,
                Err(why) if faults.is_empty() => {
                    out.missing(subject, why);
                    continue;
                }
                Err(_) => Vec::new(),
            };
            let mut measured = Vec::new();
            let mut seen = Ok(());
            for clouds in &clouds {
                match against(clouds, image, limits) {
                    Ok((more, numbers)) => {
                        faults.extend(more);
                        measured.extend(numbers);
                    }
                    Err(why) => seen = Err(why),
                }
                faults.extend(beams(clouds, projection, image, &declared, limits));
            }
            if faults.is_empty() {
                match seen {
                    Err(why) => out.too_little(subject, why),
                    Ok(()) => out.pass(subject, measured),
                }
                continue;
            }
            for fault in faults {
                let finding = Finding::warning(&subject, fault.message, projection.place.clone())
                    .relation(fault.relation)
                    .detail(fault.detail)
                    .help(fault.help)
                    .measured(fault.measured);
                let finding = if fault.is_certain { finding } else { finding.likely() };
                out.fail(match clouds.first() {
                    Some(clouds) => finding.related(clouds.place(), "the first of the clouds"),
                    None => finding,
                });
            }
        }
    }
}
