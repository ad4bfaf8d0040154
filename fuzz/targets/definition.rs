//! Any bytes as a definition in every encoding, and any bytes as a message of its type: no panic, bounded work.
//!
//! The input is a definition up to the first byte 0xff, which no text contains, then a message.
use frames_lint::read::messages::MAX_NAME;
use frames_lint::read::messages::content::Body;
use frames_lint::read::messages::decoder::Decoder;
use frames_lint::read::messages::definition::{Definitions, Schema, TypeDefinition};
use frames_lint::read::messages::format::Format;
use frames_lint::read::messages::radar::{Form, MAX_ECHOES};

const TYPES: [&str; 6] = [
    "acme_msgs/msg/Top",
    "radar_msgs/msg/RadarScan",
    "delphi_esr_msgs/msg/EsrTrack",
    "nav_msgs/Odometry",
    "tf2_msgs::msg::dds_::TFMessage_",
    "sensor_msgs/msg/NavSatFix",
];

/// Runs the target.
pub fn run(bytes: &[u8]) {
    let definitions = Definitions::builtin();
    let end = bytes.iter().position(|byte| *byte == 0xff).unwrap_or(bytes.len());
    let (schema, rest) = bytes.split_at(end);
    let message = rest.get(1..).unwrap_or_default();
    for schema_encoding in ["ros2msg", "ros1msg", "ros2idl"] {
        for message_type in TYPES {
            if let TypeDefinition::Types(types) = TypeDefinition::read(message_type, schema, schema_encoding)
                && let Some(linked) = Schema::link(message_type, Some(&types), &definitions)
            {
                // Every type is in the text or in the standard packages; none is parsed twice.
                let mut names: Vec<&str> = linked.types.iter().map(|one| one.name.as_str()).collect();
                names.sort_unstable();
                names.dedup();
                assert_eq!(names.len(), linked.types.len());
            }
            for message_encoding in ["cdr", "ros1"] {
                let format = Format {
                    topic: "/topic",
                    message_type,
                    message_encoding,
                    schema,
                    schema_encoding,
                };
                let Ok(content) = Decoder::of(&format, &definitions).decode(message) else {
                    continue;
                };
                if let Some(header) = &content.header {
                    assert!(header.frame_id.len() <= MAX_NAME);
                }
                if let Body::ChildFrame(child) = &content.body {
                    assert!(child.len() <= MAX_NAME);
                }
                // Members take bytes of the message, except for empty ones; each has at least the outer header.
                assert!(content.members.len() <= 32);
                for member in &content.members {
                    assert!(!member.field.is_empty() && !matches!(member.body, Body::Nothing));
                    assert!(member.header.is_some() || content.header.is_none());
                    if let Body::Radar(radar) = &member.body {
                        // The smallest detection is a range, an azimuth and a rate.
                        let single = matches!(radar.form, Form::Single(_));
                        assert!(single || radar.total as usize <= message.len() / 12);
                        assert!(radar.echoes.len() <= MAX_ECHOES as usize);
                    }
                }
            }
        }
    }
}
