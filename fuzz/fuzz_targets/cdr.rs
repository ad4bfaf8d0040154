//! Any bytes as a CDR message: no panic, no work beyond the bytes that are there.
#![no_main]

use frames_lint::read::messages::header::{self, Header};
use frames_lint::read::messages::{Cdr, MAX_NAME, odometry, string, tf};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(header) = Header::of(bytes) {
        assert!(header.frame_id.len() <= MAX_NAME);
    }
    if let Ok((header, child)) = odometry::frames(bytes) {
        // Odometry begins with a header: both must read it alike.
        assert_eq!(Header::of(bytes), Ok(header));
        assert!(child.len() <= MAX_NAME);
    }
    if let Ok(text) = string::data(bytes) {
        assert!(text.len() <= bytes.len());
        header::comes_first(text);
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
