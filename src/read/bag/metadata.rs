//! `metadata.yaml` of a rosbag2 folder.

use std::collections::BTreeMap;

/// What the file says of a recording.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Metadata {
    /// Topics, by name.
    pub(super) topics: BTreeMap<String, TopicSaid>,
}

/// What the file says of a topic.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct TopicSaid {
    /// Offered QoS profiles, as YAML text.
    pub(super) offered_qos_profiles: String,
}
