//! CAMERA09: declarations of bird's-eye grids and panoramas, checked for consistency and compared with their messages.

use crate::analysis::camera::declared::{is_about, name};
use crate::analysis::{camera::fault::Fault, camera::grids, camera::grids::Limits};
use crate::rules::prelude::*;
use crate::world::projection::{Form, Grid, GridAt, Panorama, Projection, Sense};
use crate::world::{BagEvidence, World, bag::TopicEvidence};

pub(crate) struct BevPanoramaMetadata;

impl Rule for BevPanoramaMetadata {
    const NEEDS: &'static [Need] = &[];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for bag in &world.bags {
            for topic in bag.topics.values() {
                for grid in topic.content.grids.iter().flat_map(|grids| &grids.grids) {
                    judge_message(bag, topic, grid, limits, out);
                }
            }
        }
        for projection in world.projections() {
            match &projection.form {
                Form::Grid(grid) => judge_grid(world, projection, grid, limits, out),
                Form::Panorama(panorama) => judge_panorama(world, projection, panorama, limits, out),
                Form::RangeImage(_) => {}
            }
        }
    }
}

/// The metadata of a grid message.
fn judge_message(bag: &BagEvidence, topic: &TopicEvidence, grid: &GridAt, limits: &Limits, out: &mut Judge) {
    let subject = format!("grid on topic `{}`, message {}", topic.topic, grid.at.index);
    let (faults, tilt_deg) = grids::of_message(grid, limits);
    let place = Place::message(bag.source, grid.at.clone());
    if faults.is_empty() {
        let measured = [
            Measured::new("resolution", grid.resolution_m, "m")
                .limit(limits.max_resolution_m)
                .samples(grid.count),
            Measured::new("tilt of the grid", tilt_deg, "deg").limit(limits.max_tilt_deg),
        ];
        return out.pass(subject, measured);
    }
    for mut fault in faults {
        fault.message = format!("`{}`: {}", topic.topic, fault.message);
        out.fail(fault.finding(&subject, place.clone()));
    }
}

fn judge_grid(world: &World, projection: &Projection, grid: &Grid, limits: &Limits, out: &mut Judge) {
    let subject = format!("grid {}", name(world, projection));
    let mut faults = grids::of_declaration(projection, grid, limits);
    let beside = grids::against_messages(world, projection, grid, limits);
    let mut related = None;
    if let Some((place, fault)) = beside {
        related = Some(place);
        faults.extend(fault);
    }
    if faults.is_empty() {
        let resolution_m = grid.resolution_m.unwrap_or(f64::NAN);
        let declared = Measured::new("resolution", resolution_m, "m").limit(limits.max_resolution_m);
        let compared = Measured::count("messages compared", usize::from(related.is_some()));
        return out.pass(subject, [declared, compared]);
    }
    for fault in faults {
        let finding = fault.finding(&subject, projection.place.clone());
        out.fail(match &related {
            Some(place) => finding.related(place.clone(), "the grid message"),
            None => finding,
        });
    }
}

fn judge_panorama(world: &World, projection: &Projection, panorama: &Panorama, limits: &Limits, out: &mut Judge) {
    let subject = format!("panorama {}", name(world, projection));
    let topics = world
        .bags
        .iter()
        .flat_map(|bag| bag.topics.values().map(move |topic| (bag, topic)));
    let images = topics
        .filter(|(_, topic)| projection.topic.is_some() && is_about(projection, topic))
        .flat_map(|(bag, topic)| {
            let forms = topic.content.images.iter().flat_map(|images| &images.forms);
            forms.map(move |form| (Place::message(bag.source, form.at.clone()), form.size))
        });
    let images: Vec<(Place, [u32; 2])> = images.collect();
    let declared = panorama
        .width
        .zip(panorama.height)
        .map(|(width, height)| [width, height]);
    let sizes: Vec<[u32; 2]> = declared
        .into_iter()
        .chain(images.iter().map(|(_, size)| *size))
        .collect();
    let mut faults = Vec::new();
    if let Some([width, height]) = sizes
        .iter()
        .find(|[width, height]| width.abs_diff(2 * height) > limits.max_pixels)
    {
        faults.push(Fault::new(
            "size",
            format!("the panorama has {width} x {height} pixels, but 360 x 180 deg require a ratio of 2:1"),
            "declare the field of view of the images, or publish images that were not cropped or stretched",
            Measured::new("width / height", f64::from(*width) / f64::from((*height).max(1)), "1").limit(2.0),
        ));
    }
    let other = declared.and_then(|declared| {
        images
            .iter()
            .find(|(_, size)| *size != declared)
            .map(|(_, size)| (declared, *size))
    });
    if let Some(([width, height], [seen_width, seen_height])) = other {
        faults.push(Fault::new(
            "resized",
            format!("the panorama is declared with {width} x {height} pixels, but its images have {seen_width} x {seen_height}"),
            "declare the size of the images, or scale columns and rows before converting them to angles",
            Measured::new("declared width", f64::from(width), "count").expected(f64::from(seen_width)),
        ));
    }
    if panorama.azimuth == Some(Sense::CounterClockwise) {
        faults.push(Fault::new(
            "mirrored",
            "the panorama is declared as mirrored: its columns run counter-clockwise".to_owned(),
            "look at an image:\n(1) if it is mirrored, compute the column as u = W (pi - azimuth) / 2 pi, with the azimuth of REP-103, and declare `azimuth: clockwise`\n(2) if it is not mirrored, declare `azimuth: clockwise`: the word is of the columns, not of the angle",
            Measured::new("sense of the columns, clockwise positive", -1.0, "1").expected(1.0),
        ));
    }
    if faults.is_empty() {
        let Some([width, height]) = sizes.first() else {
            return out.missing(
                subject,
                "neither its size nor the topic of its images is declared: declare one of them",
            );
        };
        let ratio = Measured::new("width / height", f64::from(*width) / f64::from((*height).max(1)), "1").limit(2.0);
        return out.pass(
            subject,
            [ratio, Measured::count("kinds of images compared", images.len())],
        );
    }
    for fault in faults {
        let finding = fault.finding(&subject, projection.place.clone());
        out.fail(match images.first() {
            Some((place, _)) => finding.related(place.clone(), "the first image"),
            None => finding,
        });
    }
}
