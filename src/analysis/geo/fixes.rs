//! What a stated position may be other than degrees, and what other receivers state.
//!
//! Must not report.

use serde::Deserialize;

use crate::math::stats::median;
use crate::world::content::{FixAt, FixEvidence};
use crate::world::{World, bag::TopicEvidence};

/// Latitude and longitude, degrees.
pub(crate) type Position = (f64, f64);

/// Median position of the fixes of a topic, as published.
pub(crate) fn middle(fixes: &FixEvidence) -> Option<Position> {
    let of = |coordinate: fn(&FixAt) -> f64| {
        let with_fix = fixes.samples.iter().filter(|fix| fix.status >= 0);
        median(&with_fix.map(coordinate).collect::<Vec<f64>>())
    };
    Some((of(|fix| fix.latitude_deg)?, of(|fix| fix.longitude_deg)?))
}

/// A median position, degrees, of some stream of fixes.
pub(crate) fn some_position(world: &World) -> Option<Position> {
    let topics = world.bags.iter().flat_map(|bag| bag.topics.values());
    let mut said = topics.flat_map(TopicEvidence::contents).filter(|said| !said.guessed);
    said.find_map(|said| middle(said.content.fixes.as_ref()?))
}

/// Whether two positions are within some degrees of each other.
fn near(a: Position, b: Position, degrees: f64) -> bool {
    (a.0 - b.0).abs() <= degrees && (a.1 - b.1).abs() <= degrees
}

/// Median positions of everything else with fixes, by topic. What is only guessed to be a fix confirms nothing.
pub(crate) fn others<'w>(world: &'w World, fixes: &FixEvidence) -> Vec<(&'w str, Position)> {
    let topics = world.bags.iter().flat_map(|bag| bag.topics.values());
    topics
        .flat_map(TopicEvidence::contents)
        .filter(|said| !said.guessed)
        .filter_map(|said| {
            let other = said.content.fixes.as_ref();
            let other = other.filter(|other| !std::ptr::eq(*other, fixes))?;
            Some((said.topic.topic.as_str(), middle(other)?))
        })
        .collect()
}

/// A way in which a position was published wrongly.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reading {
    /// What is wrong, for a sentence.
    pub(crate) words: &'static str,
    /// The word of the relation.
    pub(crate) relation: &'static str,
    /// The position that was intended.
    pub(crate) meant: Position,
    /// What corrects it.
    pub(crate) help: &'static str,
}

const E7: &str = "degrees-e7";
const RADIANS: &str = "radians";

fn is_in_range((latitude, longitude): Position) -> bool {
    latitude.abs() <= 90.0 && longitude.abs() <= 180.0
}

/// Ways in which a position may be published wrongly, with the intended position.
fn readings((latitude, longitude): Position) -> Vec<Reading> {
    let mut found = vec![Reading {
        words: "latitude and longitude are swapped",
        relation: "lat-lon-swapped",
        meant: (longitude, latitude),
        help: "swap the two numbers: the latitude belongs in `latitude`, the longitude in `longitude`",
    }];
    if latitude.abs() <= std::f64::consts::FRAC_PI_2 && longitude.abs() <= std::f64::consts::PI {
        found.push(Reading {
            words: "radians are published as degrees",
            relation: RADIANS,
            meant: (latitude.to_degrees(), longitude.to_degrees()),
            help: "multiply latitude and longitude by 180/pi before publishing",
        });
    }
    found.push(Reading {
        words: "1e-7 deg units are published as degrees",
        relation: E7,
        meant: (latitude / 1e7, longitude / 1e7),
        help: "divide latitude and longitude by 1e7 before publishing",
    });
    found.retain(|reading| is_in_range(reading.meant));
    found
}

/// What a position out of range probably is.
pub(crate) fn meant(fix: &FixAt, limits: &Limits) -> Option<Reading> {
    let (latitude, longitude) = (fix.latitude_deg, fix.longitude_deg);
    if is_in_range((latitude, longitude)) {
        return None;
    }
    let scaled = latitude.abs().max(longitude.abs()) > limits.scaled_deg;
    let mut all = readings((latitude, longitude)).into_iter();
    all.find(|reading| (reading.relation == E7) == scaled)
}

/// The way to read a position that makes it agree with another receiver's; or radians, where the position is near 0, 0 and no
/// other receiver confirms it.
pub(crate) fn misread<'o>(
    position: Position,
    others: &[(&'o str, Position)],
    limits: &Limits,
) -> Option<(Reading, Option<&'o str>)> {
    if others.iter().any(|(_, other)| near(position, *other, limits.agree_deg)) {
        return None;
    }
    let is_scaled = position.0.abs().max(position.1.abs()) > limits.scaled_deg;
    let mut ways = readings(position);
    ways.retain(|way| way.relation != E7 || is_scaled);
    let confirmed = ways.iter().find_map(|way| {
        let other = others
            .iter()
            .find(|(_, other)| near(way.meant, *other, limits.agree_deg))?;
        Some((*way, Some(other.0)))
    });
    // Simulators put their origin near 0, 0.
    let from_origin = position.0.abs().max(position.1.abs());
    let radians = ways.iter().find(|way| way.relation == RADIANS);
    let alone = radians
        .filter(|_| from_origin > limits.origin_deg)
        .map(|way| (*way, None));
    confirmed.or(alone)
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) max_wrong: f64,
    pub(crate) error_share: f64,
    pub(crate) agree_deg: f64,
    pub(crate) scaled_deg: f64,
    pub(crate) origin_deg: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_position_is_read_in_every_way_that_stays_on_earth() {
        let words = |position| {
            readings(position)
                .into_iter()
                .map(|reading| reading.words)
                .collect::<Vec<_>>()
        };
        assert!(words((0.84, 0.19)).contains(&"radians are published as degrees"));
        assert!(!words((48.0, 11.0)).contains(&"radians are published as degrees"));
        assert_eq!(
            words((481_234_567.0, 115_678_901.0)),
            ["1e-7 deg units are published as degrees"]
        );
        assert!(!words((48.0, 130.0)).contains(&"latitude and longitude are swapped"));
        assert!(near((48.0, 11.0), (48.5, 11.9), 1.0) && !near((48.0, 11.0), (11.0, 48.0), 1.0));
    }
}
