//! Frames that packets of lidars do not state.

use super::bag::{HeaderFrame, TopicEvidence};
use super::{BagEvidence, FrameId, World};
use crate::source::MessageRef;

impl World {
    /// Gives topics of packets without a frame the one that the driver of their lidar uses, where the platform has exactly one frame of that
    /// name, and the recording one such topic.
    pub(crate) fn name_frames_of_packets(&mut self) {
        let mut topics = self.bags.iter().flat_map(|bag| bag.topics.values());
        if topics.all(|topic| maker(topic).is_none()) {
            return;
        }
        let mut named = Vec::new();
        for lidar in self.tables.lidars() {
            let called = |name: &Option<String>| self.frame_called(name.as_deref()?);
            let (lidar_frame, imu_frame) = (called(&lidar.frame), called(&lidar.imu_frame));
            for (index, bag) in self.bags.iter().enumerate() {
                let clouds = only(bag, |topic| maker(topic) == Some(&lidar.name));
                let imu = only(bag, TopicEvidence::is_frameless).filter(|_| clouds.is_some());
                let found = [(clouds, &lidar_frame), (imu, &imu_frame)];
                named.extend(found.into_iter().filter_map(|(topic, frame)| {
                    let topic = topic?;
                    Some((index, topic.topic.clone(), frame.clone()?, first(topic)?))
                }));
            }
        }
        for (index, topic, frame, first) in named {
            let topic = self.bags.get_mut(index).and_then(|bag| bag.topics.get_mut(&topic));
            if let Some(topic) = topic {
                let count = topic.count;
                topic.header_frames.insert(frame, HeaderFrame { count, first });
            }
        }
        self.forget();
    }

    /// The only frame of the platform whose name ends in this one.
    fn frame_called(&self, name: &str) -> Option<FrameId> {
        let is_it = |frame: &&FrameId| frame.as_str().rsplit('/').next() == Some(name);
        let mut called = self.graph().frames.iter().filter(is_it);
        called.next().filter(|_| called.next().is_none()).cloned()
    }
}

/// The maker of the lidar whose packets a topic has.
fn maker(topic: &TopicEvidence) -> Option<&str> {
    Some(&topic.content.clouds.as_ref()?.packets.as_ref()?.maker)
}

/// The only topic of this kind that states no frame.
fn only(bag: &BagEvidence, is_wanted: impl Fn(&TopicEvidence) -> bool) -> Option<&TopicEvidence> {
    let frameless = bag.topics.values().filter(|topic| topic.header_frames.is_empty());
    let mut wanted = frameless.filter(|topic| is_wanted(topic));
    wanted.next().filter(|_| wanted.next().is_none())
}

/// The first message of a topic.
fn first(topic: &TopicEvidence) -> Option<MessageRef> {
    let clouds = topic.content.clouds.as_ref().and_then(|clouds| clouds.layouts.first());
    let imu = topic.content.imu.as_ref().and_then(|imu| imu.first.as_ref());
    clouds.map(|layout| &layout.at).or(imu).cloned()
}
