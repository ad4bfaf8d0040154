//! Reports of recordings that hold packets of lidars: without clouds, or with clouds of the same lidar.

use crate::analysis::lidar::Clouds;
use crate::tables::Lidar;
use crate::verdict::{Finding, Judge};
use crate::world::{World, bag::TopicEvidence};

impl Clouds<'_> {
    /// Reports for recordings that hold packets of lidars, but no clouds, not even decoded ones, that these packets are not read.
    pub(crate) fn say_packets(world: &World, of: &str, out: &mut Judge) {
        Self::say_packets_of(world, of, |_| true, out);
    }

    /// A finding on these clouds, hidden if they were decoded from packets and the same is found on what the driver published of this lidar.
    pub(crate) fn once_per_lidar(&self, world: &World, finding: Finding) -> Finding {
        if self.evidence.packets.is_none() {
            return finding;
        }
        let (frame, named) = (self.frame(), |topic: &str| format!("`{topic}`"));
        let mut published = Clouds::published(world).filter(|other| other.index == self.index && other.is_of_a_lidar());
        match published.find(|other| frame.is_some() && other.frame() == frame) {
            Some(other) => {
                let subject = finding
                    .subject
                    .replace(&named(&self.topic.topic), &named(&other.topic.topic));
                finding.same_cause_as(subject)
            }
            None => finding,
        }
    }

    /// [`Clouds::say_packets`] of certain lidars only.
    pub(crate) fn say_packets_of(world: &World, of: &str, is_wanted: impl Fn(&Lidar) -> bool, out: &mut Judge) {
        for (index, bag) in world.bags.iter().enumerate() {
            if Clouds::all(world).any(|clouds| clouds.index == index) {
                continue;
            }
            // One type may carry packets of the beams and of the IMU.
            let may_be = |topic: &&TopicEvidence| topic.count > 0 && !topic.words().iter().any(|word| word == "imu");
            for topic in bag.topics.values().filter(may_be) {
                let plain = topic.message_type.replace("/msg/", "/");
                let is_it = |lidar: &&Lidar| lidar.packets.contains(&plain) && is_wanted(lidar);
                let Some(lidar) = world.tables.lidars().find(is_it) else {
                    continue;
                };
                let why = format!(
                    "`{}` holds packets of {}, which are not read: record the clouds of the driver as well",
                    topic.topic, lidar.name
                );
                out.missing(format!("{of} of topic `{}`", topic.topic), why);
            }
        }
    }
}
