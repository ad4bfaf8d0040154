//! The metadata of sensors that a recording may hold packets of: from JSON files beside it, and from its own topics.

use std::fs;
use std::path::Path;

use super::{Imu, Layout, Metadata, imu};

/// Files of a folder that are looked at, and the most bytes of one.
const MAX_FILES: usize = 64;
const MAX_BYTES: u64 = 1 << 20;

/// Metadata of several sensors.
#[derive(Clone, Debug, Default)]
pub struct KnownSensors(Vec<Known>);

#[derive(Clone, Debug)]
struct Known {
    /// The name of the file, or the topic.
    name: String,
    is_recorded: bool,
    text: String,
    metadata: Metadata,
}

/// What is known of packets besides their bytes.
#[derive(Clone, Copy, Debug)]
pub struct Origin<'o> {
    /// The port that they were sent to.
    pub port: Option<u16>,
    /// The name of the recording's file, and the topic.
    pub names: [&'o str; 2],
}

impl KnownSensors {
    /// Those of the JSON files in a folder.
    pub fn in_folder(folder: &Path) -> Self {
        let mut known = Self::default();
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        let mut paths: Vec<_> = entries.map(|entry| entry.path()).collect();
        paths.retain(|path| {
            path.extension()
                .is_some_and(|extension| extension.eq_ignore_ascii_case("json"))
        });
        paths.sort();
        for path in paths.into_iter().take(MAX_FILES) {
            let is_small = path
                .metadata()
                .is_ok_and(|about| about.is_file() && about.len() <= MAX_BYTES);
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            if let Some(text) = is_small.then(|| fs::read_to_string(&path).ok()).flatten() {
                known.add(&name, &text, false);
            }
        }
        known
    }

    /// Adds a text, if it is metadata.
    pub fn add(&mut self, name: &str, text: &str, is_recorded: bool) {
        let is_known = self.0.iter().any(|known| known.text == text);
        if is_known || self.0.len() >= 2 * MAX_FILES || !text.trim_start().starts_with('{') {
            return;
        }
        if let Ok(metadata) = Metadata::parse(text) {
            self.0.push(Known {
                name: name.to_owned(),
                is_recorded,
                text: text.trim_start().to_owned(),
                metadata,
            });
        }
    }

    /// The text of the metadata by which a lidar packet decodes; `None` where there is none, or several fit alike and differ.
    pub fn of_lidar(&self, packet: &[u8], origin: &Origin<'_>) -> Option<&str> {
        let fits = |metadata: &Metadata| {
            let layout = Layout::of(metadata).ok()?;
            let size = layout.packet_bytes();
            let whole = packet.get(..size).filter(|_| packet.len() <= size + 1)?;
            layout.read(metadata, whole).ok().map(drop)
        };
        let known = self.best(origin, |metadata| metadata.lidar_port, fits)?;
        Some(&known.text)
    }

    /// The text of the metadata of the only sensor that is known, or recorded: why packets do not decode by it says more than that none fits.
    pub fn only(&self) -> Option<&str> {
        let has_recorded = self.0.iter().any(|known| known.is_recorded);
        let mut all = self.0.iter().filter(|known| known.is_recorded || !has_recorded);
        let only = all.next().filter(|_| all.next().is_none())?;
        Some(&only.text)
    }

    /// What an IMU packet says, by the metadata that it decodes by.
    pub fn of_imu(&self, packet: &[u8], origin: &Origin<'_>) -> Option<Vec<Imu>> {
        // The buffers of the driver of ROS 1 have a byte more.
        let shorter = packet.split_last().map_or(packet, |(_, rest)| rest);
        let read = |metadata: &Metadata| imu(metadata, packet).or_else(|_| imu(metadata, shorter)).ok();
        let known = self.best(
            origin,
            |metadata| metadata.imu_port,
            |metadata| read(metadata).map(drop),
        )?;
        read(&known.metadata)
    }

    fn best(
        &self,
        origin: &Origin<'_>,
        port: impl Fn(&Metadata) -> Option<u16>,
        fits: impl Fn(&Metadata) -> Option<()>,
    ) -> Option<&Known> {
        let rank = |known: &Known| {
            let is_port = origin.port.is_some() && port(&known.metadata) == origin.port;
            let alike = origin.names.map(|name| in_common(&known.name, name));
            (known.is_recorded, alike.into_iter().max(), is_port)
        };
        let fitting = self.0.iter().filter(|known| fits(&known.metadata).is_some());
        let mut ranked: Vec<(_, &Known)> = fitting.map(|known| (rank(known), known)).collect();
        ranked.sort_by_key(|(rank, _)| std::cmp::Reverse(*rank));
        match ranked.as_slice() {
            [(best, one), (second, other), ..] if best == second && !decodes_alike(one, other) => None,
            [(_, known), ..] => Some(known),
            [] => None,
        }
    }
}

/// Whether two are metadata of one sensor, sent to other ports.
fn decodes_alike(one: &Known, other: &Known) -> bool {
    let [one, other] = [one, other].map(|known| Metadata {
        lidar_port: None,
        imu_port: None,
        ..known.metadata.clone()
    });
    one == other
}

/// The letters that two names begin with.
fn in_common(a: &str, b: &str) -> usize {
    a.chars().zip(b.chars()).take_while(|(a, b)| a == b).count()
}
