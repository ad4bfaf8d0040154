//! Any bytes as a message of each type that is read: no panic, no work beyond the bytes that are there.
#![no_main]

use frames_lint::read::messages::content::Body;
use frames_lint::read::messages::decoder::{Decoder, Format};
use frames_lint::read::messages::header::{self, Header};
use frames_lint::read::messages::{Cdr, MAX_NAME, tf};
use libfuzzer_sys::fuzz_target;

const TYPES: [(&str, &str); 3] = [
    ("/tf", "tf2_msgs/msg/TFMessage"),
    ("/odom", "nav_msgs/msg/Odometry"),
    ("/robot_description", "std_msgs/msg/String"),
];

fuzz_target!(|bytes: &[u8]| {
    if let Ok(header) = Header::of(bytes) {
        assert!(header.frame_id.len() <= MAX_NAME);
    }
    for (topic, message_type) in TYPES {
        let decoder = Decoder::of(&Format {
            topic,
            message_type,
            message_encoding: "cdr",
            schema: &[],
            schema_encoding: "",
        });
        match decoder.decode(bytes).map(|content| content.body) {
            Ok(Body::Odometry(odometry)) => assert!(odometry.child.len() <= MAX_NAME),
            Ok(Body::Description(text)) => {
                assert!(text.len() <= bytes.len());
                header::comes_first(&text);
            }
            _ => {}
        }
    }
    if let Ok(transforms) = tf::transforms(bytes) {
        // The shortest transform is 12 bytes of header, 4 of child and 56 of numbers: a lying count cannot give more.
        let all: Vec<_> = transforms.collect();
        assert!(all.len() <= bytes.len() / 72 + 1);
        let errors = all.iter().filter(|transform| transform.is_err()).count();
        assert!(errors == 0 || (errors == 1 && all.last().is_some_and(Result::is_err)));
    }
    if let Ok(mut cdr) = Cdr::new(bytes) {
        while cdr.i32().is_ok() && cdr.f64().is_ok() && cdr.str().is_ok() {
            assert!(cdr.position() <= bytes.len());
        }
    }
});
