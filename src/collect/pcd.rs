//! One whole cloud of a recording as a PCD file, so that it can be compared with what other programs decode.
//!
//! Owns which cloud that is: the first of its topic that has a point. Source of the format: pointclouds.org, "The PCD (Point Cloud Data) file format", 0.7.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::sync::Arc;

use crate::read::bag::{Channel, Message, Progress, Recording, Sampling, Selection, Visit};
use crate::read::messages::cloud::{Cloud, Column};
use crate::read::messages::content::Body;
use crate::read::messages::decoder::Decoder;
use crate::read::messages::decoders::Decoders;
use crate::read::messages::definition::Definitions;
use crate::read::scans;
use crate::source::{ReadStatus, Source, SourceId, SourceKind};
use crate::world::cloud::RING_FIELDS;

use super::content::cloud::is_return;
use super::content::times::time_of;
use super::format_of;

/// Bound on the topics whose clouds are looked at.
const MAX_TOPICS: usize = 1000;
/// Fields with the strength of a return, by the drivers of lidars.
const INTENSITIES: [&str; 3] = ["intensity", "reflectivity", "i"];

/// The file's bytes, and the topic of the cloud with the number of its points.
pub type PcdFile = (Vec<u8>, String, usize);

/// The first cloud of a topic, or of the only topic with clouds: points with a return, x, y and z in metres as published or as decoded from
/// packets, times in the unit of the cloud (decoded: seconds after the header's stamp); what it lacks is NaN, a ring 0. The error is a sentence
/// about the recording.
pub fn pcd(
    recording: &Recording<'_>,
    definitions: &Arc<Definitions>,
    topic: Option<&str>,
    progress: Progress<'_>,
) -> Result<PcdFile, String> {
    let few = Sampling {
        windows: 1,
        seconds: 0.0,
        bytes: 0,
        carried: None,
    };
    let mut seen = String::new();
    // Of every topic the first messages are read in any case.
    for sampling in [Some(few), None] {
        let mut first = FirstClouds {
            topic,
            decoders: Decoders::new(Arc::clone(definitions)),
            channels: Vec::new(),
            found: BTreeMap::new(),
        };
        let mut source = Source::new(SourceId(0), "", SourceKind::Unsupported);
        let wanted = Selection {
            sampling,
            ..Selection::ALL
        };
        scans::read(recording, &wanted, definitions, (&mut source, progress), &mut first);
        let mut found = first.found.into_iter();
        match (found.next(), found.next()) {
            (Some((topic, Some(Ok((bytes, count))))), None) => return Ok((bytes, topic, count)),
            (Some((topic, Some(Err(why)))), None) => return Err(format!("`{topic}`: {why}")),
            (Some((first, _)), Some((second, _))) => {
                let others = found.map(|(topic, _)| topic);
                let topics: Vec<String> = [first, second].into_iter().chain(others).collect();
                return Err(format!(
                    "clouds are on {} topics, choose one with --topic: `{}`",
                    topics.len(),
                    topics.join("`, `")
                ));
            }
            (Some((_, None)), None) | (None, _) => {
                let unreadable = source.detail.filter(|_| source.status == ReadStatus::Unreadable);
                seen = unreadable.unwrap_or_else(|| match topic {
                    Some(topic) => format!("no cloud with a point is on `{topic}`"),
                    None => "no topic has a cloud with a point".to_owned(),
                });
            }
        }
    }
    Err(seen)
}

/// A file's bytes with the number of its points, or why the cloud cannot be read; `None` if it has no point.
type FirstCloud = Option<Result<(Vec<u8>, usize), String>>;

/// Takes in the first cloud of each topic.
struct FirstClouds<'a> {
    topic: Option<&'a str>,
    decoders: Decoders,
    /// By the channel's number.
    channels: Vec<Option<Decoder>>,
    /// By topic, the first one with a point.
    found: BTreeMap<String, FirstCloud>,
}

impl Visit for FirstClouds<'_> {
    fn channel(&mut self, channel: &Channel) {
        let format = format_of(channel);
        let is_wanted = self.topic.is_none_or(|topic| topic == channel.topic);
        let decoder = is_wanted.then(|| self.decoders.of(&format, &channel.schema));
        self.channels.push(decoder);
    }

    fn message(&mut self, channel: &Channel, message: &Message<'_>) {
        let Some(slot) = self.channels.get_mut(channel.number) else {
            return;
        };
        let known = self.found.get(&channel.topic);
        if matches!(known, Some(Some(_))) || (known.is_none() && self.found.len() >= MAX_TOPICS) {
            return;
        }
        let Some(content) = slot.as_ref().map(|decoder| decoder.decode(message.data)) else {
            return;
        };
        let stamp_ns = content.as_ref().ok().and_then(|content| content.header.as_ref());
        let stamp_ns = stamp_ns.map_or(0, |header| header.stamp_ns);
        let made = match content.map(|content| content.body) {
            Ok(Body::Cloud(cloud)) => Ok(points(&cloud)),
            Ok(Body::Packets(scan)) if scan.packets() == 0 => Ok(None),
            Ok(Body::Packets(scan)) => scan.decode(stamp_ns).map(|decoded| points(&decoded.cloud)),
            // A topic without clouds is not looked at again; a message that is broken says nothing about its topic.
            Ok(_) => {
                *slot = None;
                return;
            }
            Err(_) => return,
        };
        let made = made.map_err(|error| error.0).transpose();
        self.found.insert(channel.topic.clone(), made);
    }

    fn seam(&mut self) {}
}

/// The points with a return as a file, with their number; `None` without any.
fn points(cloud: &Cloud<'_>) -> Option<(Vec<u8>, usize)> {
    let axes: [Column; 3] = [cloud.column("x")?, cloud.column("y")?, cloud.column("z")?];
    let one_of = |names: &[&str]| names.iter().find_map(|name| cloud.column(name));
    let (intensity, ring) = (one_of(&INTENSITIES), one_of(&RING_FIELDS));
    let time = time_of(cloud, &[]).map(|(_, column)| column);
    let (mut data, mut count) = (Vec::new(), 0);
    for row in 0..cloud.rows() {
        for column in 0..cloud.width {
            let Some(bytes) = cloud.point(row, column) else { break };
            let xyz = axes.map(|axis| axis.of(bytes).unwrap_or(f64::NAN));
            if !is_return(xyz) {
                continue;
            }
            let value = |column: Option<Column>| column.and_then(|column| column.of(bytes)).unwrap_or(f64::NAN);
            count += 1;
            for value in xyz.into_iter().chain([value(intensity)]) {
                data.extend(single(value).to_le_bytes());
            }
            data.extend(whole(value(ring)).to_le_bytes());
            data.extend(value(time).to_le_bytes());
        }
    }
    (count > 0).then(|| ([head(count).into_bytes(), data].concat(), count))
}

/// The file's text before its points. The second line lets a later run replace the file.
fn head(count: usize) -> String {
    let mut head = "# .PCD v0.7 - Point Cloud Data file format\n# written by: frames-lint\n".to_owned();
    let fields = "FIELDS x y z intensity ring time\nSIZE 4 4 4 4 2 8\nTYPE F F F F U F\nCOUNT 1 1 1 1 1 1";
    let _ = write!(
        head,
        "VERSION 0.7\n{fields}\nWIDTH {count}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {count}\nDATA binary\n"
    );
    head
}

#[allow(clippy::cast_possible_truncation)] // as most clouds publish them
fn single(value: f64) -> f32 {
    value as f32
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // cut to the range; NaN becomes 0
fn whole(value: f64) -> u16 {
    value as u16
}
