//! Ouster's OSF files: the scans of their sensors, each as one message that is decoded where it is kept.
//!
//! Owns the names of topics: `/osf/` with the serial number of the sensor, then `points` or `imu`.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::BufReader;

use crate::read::messages::assembled::{AssembledScan, MadeMessage};
use crate::read::messages::packets::ASSEMBLED;
use crate::read::ouster::Metadata;
use crate::read::ouster::osf::{Indexed, LidarScan, Message as Stored, Osf};
use crate::read::packets::{Packet, STORED};
use crate::source::{Place, ReadStatus};

use super::chunks::{self, ChunkInfo, MarkedChannels};
use super::losses::{Loss, Losses};
use super::{Channel, Extent, Message, Task};

/// What the header's block has behind its size and the place of its root.
pub(super) const MAGIC: &[u8] = b"OSF$";
/// Bound on one scan, bytes.
const MAX_SCAN: usize = 64 << 20;

/// The scans of one sensor.
struct Stream {
    points: Channel,
    imu: Option<Channel>,
    text: String,
    metadata: Option<Metadata>,
}

/// Reads a file; see [`super::read`].
pub(super) fn read(file: File, total: u64, mut task: Task<'_>) -> Extent {
    let place = Place::whole(task.source.id);
    let mut osf = match Osf::new(BufReader::new(file)) {
        Ok(osf) => osf,
        Err(error) => {
            task.source.problem(ReadStatus::Unreadable, place, error.to_string());
            return super::NOTHING;
        }
    };
    if let Some(why) = &osf.rebuilt {
        let message = format!("{why}; the chunks before the first damaged one were read without it");
        task.source.problem(ReadStatus::Partial, place.clone(), message);
    }
    let mut streams = announced(&osf, &mut task);
    let all = osf.index.chunks.clone();
    let chosen = chosen(&all, &streams, &task);
    let is_whole = chosen.len() == all.len();
    let (mut losses, mut read, mut bytes) = (Losses::default(), 0, 0);
    let mut next = 0;
    for number in chosen {
        let Some(chunk) = all.get(number) else { continue };
        if number != next {
            task.visit.seam();
        }
        next = number + 1;
        bytes += chunk.end.saturating_sub(chunk.offset);
        let mut lost = |why: String| {
            losses.add(Loss {
                from: chunk.offset,
                to: Some(chunk.end),
                why,
            });
        };
        match osf.read(chunk) {
            Ok(chunk) => {
                for message in chunk.messages() {
                    match message {
                        Ok(message) => {
                            let Some(stream) = streams.get_mut(&message.stream) else {
                                continue;
                            };
                            read += stream.pass(&message, &mut task);
                        }
                        Err(error) => lost(error.to_string()),
                    }
                }
            }
            Err(error) => {
                lost(error.to_string());
                task.visit.seam();
            }
        }
        (task.progress)(chunk.end.min(total), total);
    }
    for line in losses.lines(total) {
        task.source.problem(ReadStatus::Partial, place.clone(), line);
    }
    task.source.examined.messages = Some(read);
    task.source.examined.bytes = if is_whole { losses.read_of(total) } else { bytes };
    let time = |ns: u64| i64::try_from(ns).unwrap_or(i64::MAX);
    Extent {
        truncated: osf.rebuilt.is_some() || !losses.is_empty(),
        whole: is_whole,
        indexed: osf.rebuilt.is_none(),
        messages_total: None,
        span_ns: (!all.is_empty()).then(|| (time(osf.index.start_ns), time(osf.index.end_ns))),
    }
}

/// The streams with scans, by their numbers, whose channels were announced.
fn announced(osf: &Osf<BufReader<File>>, task: &mut Task<'_>) -> BTreeMap<u32, Stream> {
    let mut streams = BTreeMap::new();
    for stream in &osf.index.streams {
        let Some(sensor) = osf.sensor(stream.id) else { continue };
        let metadata = Metadata::parse(&sensor.json).ok();
        let serial = metadata.as_ref().map_or(0, |metadata| metadata.serial);
        let name = if serial == 0 { sensor.id.into() } else { serial };
        let number = streams.len() * 2;
        let points = Channel::made(number, format!("/osf/{name}/points"), "ouster_osf/LidarScan", ASSEMBLED);
        let imu = metadata
            .as_ref()
            .filter(|metadata| metadata.imu_measurements_per_packet > 0);
        let imu = imu.map(|_| Channel::made(number + 1, format!("/osf/{name}/imu"), "sensor_msgs/msg/Imu", ASSEMBLED));
        for channel in std::iter::once(&points).chain(&imu) {
            task.visit.channel(channel);
        }
        streams.insert(
            stream.id,
            Stream {
                points,
                imu,
                text: sensor.json.trim_start().to_owned(),
                metadata,
            },
        );
    }
    streams
}

/// The chunks that are read.
fn chosen(all: &[Indexed], streams: &BTreeMap<u32, Stream>, task: &Task<'_>) -> Vec<usize> {
    let Some(sampling) = &task.wanted.sampling else {
        return (0..all.len()).collect();
    };
    let time = |ns: u64| i64::try_from(ns).unwrap_or(i64::MAX);
    let infos = all.iter().map(|chunk| ChunkInfo {
        start_ns: time(chunk.start_ns),
        end_ns: time(chunk.end_ns),
        bytes: chunk.end.saturating_sub(chunk.offset),
        // Older files do not say which streams a chunk has.
        channels: chunk
            .messages
            .map_or_else(|| streams.keys().copied().collect(), |(stream, _)| vec![stream]),
    });
    let marked = MarkedChannels::of(&task.wanted, |is_wanted| -> BTreeSet<u32> {
        let wanted = streams.iter().filter(|(_, stream)| is_wanted(&stream.points));
        wanted.map(|(number, _)| *number).collect()
    });
    chunks::choose(&infos.collect::<Vec<_>>(), sampling, &marked)
}

impl Stream {
    /// Passes on a scan with what the IMU measured during it; gives the number of messages.
    fn pass(&mut self, stored: &Stored<'_>, task: &mut Task<'_>) -> u64 {
        let log_ns = i64::try_from(stored.time_ns).unwrap_or(i64::MAX);
        let mut count = 0;
        let measured = self
            .imu
            .as_ref()
            .zip(self.metadata.as_ref())
            .and_then(|(channel, metadata)| {
                let scan = LidarScan::read(stored, metadata, Some(&[])).ok()?;
                Some((channel, scan.imu))
            });
        if let Some((channel, measured)) = measured {
            let mut made = MadeMessage::default();
            for imu in measured {
                let at_ns = i64::try_from(imu.timestamp_ns).unwrap_or(i64::MAX);
                let data = made.imu(at_ns, "", &imu);
                task.visit.message(channel, &Message { log_ns, data });
                count += 1;
            }
        }
        if stored.bytes.len() > MAX_SCAN {
            return count;
        }
        let mut scan = AssembledScan::default();
        scan.begin(log_ns, "");
        scan.describe(&self.text);
        let bytes = [STORED, stored.bytes].concat();
        scan.push(&Packet {
            received_ns: log_ns,
            bytes: &bytes,
        });
        if let Some(data) = scan.message() {
            task.visit.message(&self.points, &Message { log_ns, data });
            count += 1;
        }
        count
    }
}
