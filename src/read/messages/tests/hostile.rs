//! Definitions and messages made to cost much: the steps follow the bytes that are there.

use std::fmt::Write;
use std::time::{Duration, Instant};

use super::{FORMS, Form, RULE, decoder, schema};

/// Decodes one message; the time allowed is some thousand times what the bytes need.
fn error(own: &str, form: Form, message: &[u8]) -> String {
    let started = Instant::now();
    let decoder = decoder("/t", "acme/Top", form, &schema(form, own));
    let error = decoder.decode(message).unwrap_err().0;
    assert!(started.elapsed() < Duration::from_secs(5), "{own}");
    error
}

fn doubling(levels: usize, leaf: &str) -> String {
    let mut text = "T0 a\nstd_msgs/Header h\n".to_owned();
    for level in 0..levels {
        let next = level + 1;
        write!(text, "{RULE}\nMSG: acme/T{level}\nT{next} a\nT{next} b\n").unwrap();
    }
    write!(text, "{RULE}\nMSG: acme/T{levels}\n{leaf}\n").unwrap();
    text
}

#[test]
fn types_of_nothing_doubled_forty_times_end_at_once() {
    let nothing = doubling(40, "# nothing");
    let message = [0, 1, 0, 0, 0, 0, 0, 0];
    assert!(error(&nothing, Form::Ros1, &message).contains("more at byte 0 than the message can contain"));
    assert!(error(&doubling(40, "uint8[0] a"), Form::Little, &message).contains("than the message can contain"));
    assert!(error(&nothing, Form::Little, &message).contains("run past the end"));
}

#[test]
fn counts_beyond_the_message_end_at_once() {
    for form in FORMS {
        let mut message = vec![0, u8::from(form != Form::Big), 0, 0];
        message.extend([0xff; 64]);
        for own in [
            "acme/Nothing[4294967295] a\nstd_msgs/Header h\n",
            "acme/Nothing[] a\nstd_msgs/Header h\n",
            "string[4294967295] a\nstd_msgs/Header h\n",
            "float64[4294967295] a\nstd_msgs/Header h\n",
            "float64[] a\nstd_msgs/Header h\n",
            "builtin_interfaces/Time[4294967295] a\nstd_msgs/Header h\n",
            "std_msgs/Header[4294967295] a\nstd_msgs/Header h\n",
        ] {
            let text = format!("{own}{RULE}\nMSG: acme/Nothing\n# nothing\n");
            let error = error(&text, form, &message);
            assert!(
                error.contains("run past the end") || error.contains("than the message can contain"),
                "{error}"
            );
        }
    }
}

#[test]
fn a_type_inside_itself_ends_at_once() {
    let itself = format!("Sub s\nstd_msgs/Header h\n{RULE}\nMSG: acme/Sub\nSub s\n");
    assert!(error(&itself, Form::Ros1, &[0; 999]).contains("types are nested more than 64 deep at byte 0"));
    let through_sequence = format!("Sub s\nstd_msgs/Header h\n{RULE}\nMSG: acme/Sub\nSub[] s\n");
    assert!(error(&through_sequence, Form::Ros1, &[1; 999]).contains("nested more than 64 deep at byte 256"));
    let own = "Top s\nstd_msgs/Header h\n";
    assert!(error(own, Form::Ros1, &[0; 999]).contains("types are nested more than 64 deep"));
}

#[test]
fn many_fields_of_nothing_are_not_walked_for_every_message() {
    let mut own = String::new();
    for index in 0..50_000 {
        writeln!(own, "uint8[0] a{index}").unwrap();
    }
    own.push_str("std_msgs/Header h\n");
    assert!(error(&own, Form::Ros1, &[0; 8]).contains("than the message can contain"));
}
