//! Types that are known only by their definition: the header is found after any other fields.

use std::fmt::Write;

use proptest::prelude::*;

use super::{FORMS, Form, Piece, RULE, STAMP_NS, decoder, header, schema};
use crate::read::messages::content::Body;

/// What a field may be.
#[derive(Clone, Debug)]
enum Shape {
    Number(&'static str, usize),
    Text,
    Time,
    Header,
    Type(Vec<(Shape, Times)>),
}

/// How often.
#[derive(Clone, Copy, Debug)]
enum Times {
    One,
    Fixed(u32),
    /// A sequence that holds so many.
    Sequence(u32),
}

fn shapes() -> impl Strategy<Value = Shape> {
    let numbers = [
        ("bool", 1),
        ("byte", 1),
        ("char", 1),
        ("int8", 1),
        ("uint16", 2),
        ("int32", 4),
        ("float32", 4),
        ("uint64", 8),
        ("float64", 8),
    ];
    let simple = prop_oneof![
        4 => prop::sample::select(numbers.to_vec()).prop_map(|(name, size)| Shape::Number(name, size)),
        1 => Just(Shape::Text),
        1 => Just(Shape::Time),
        1 => Just(Shape::Header),
    ];
    simple.prop_recursive(3, 12, 4, |inner| {
        prop::collection::vec((inner, times()), 0..4).prop_map(Shape::Type)
    })
}

fn times() -> impl Strategy<Value = Times> {
    prop_oneof![
        3 => Just(Times::One),
        1 => (1_u32..4).prop_map(Times::Fixed),
        2 => (0_u32..4).prop_map(Times::Sequence),
    ]
}

/// The definition of a message and its bytes, made side by side.
struct MessageSample {
    form: Form,
    sections: String,
    types: usize,
    pieces: Vec<Piece>,
}

impl MessageSample {
    /// The type's name, and its definition put with the others.
    fn define(&mut self, shape: &Shape) -> String {
        match shape {
            Shape::Number(name, _) => (*name).to_owned(),
            Shape::Text => "string".to_owned(),
            Shape::Time if self.form == Form::Ros1 => "time".to_owned(),
            Shape::Time => "builtin_interfaces/Time".to_owned(),
            Shape::Header => "std_msgs/Header".to_owned(),
            Shape::Type(fields) => {
                let mut section = String::new();
                for (index, (shape, times)) in fields.iter().enumerate() {
                    let name = self.define(shape);
                    writeln!(section, "{name}{} field{index}", brackets(*times)).unwrap();
                }
                self.types += 1;
                let name = format!("Sub{}", self.types);
                // A comment keeps a type without fields from looking like nothing at all.
                write!(self.sections, "{RULE}\nMSG: acme/{name}\n# of its own\n{section}").unwrap();
                name
            }
        }
    }

    fn fill(&mut self, shape: &Shape, times: Times) {
        let count = match times {
            Times::One => 1,
            Times::Fixed(count) => count,
            Times::Sequence(count) => {
                self.pieces.push(Piece::Len(count));
                count
            }
        };
        for index in 0..count {
            match shape {
                Shape::Number(_, size) => self.pieces.push(Piece::Bits(*size, 0xf1f2_f3f4_f5f6_f7f8)),
                Shape::Text => self
                    .pieces
                    .push(Piece::Text("ab".repeat(usize::try_from(index).unwrap()))),
                Shape::Time => self.pieces.push(Piece::Time(1, 2)),
                Shape::Header => self.pieces.push(Piece::Header(3, 4, "other".to_owned())),
                Shape::Type(fields) if fields.is_empty() => {
                    if self.form != Form::Ros1 {
                        self.pieces.push(Piece::Bits(1, 0));
                    }
                }
                Shape::Type(fields) => {
                    for (shape, times) in fields {
                        self.fill(shape, *times);
                    }
                }
            }
        }
    }
}

fn brackets(times: Times) -> String {
    match times {
        Times::One => String::new(),
        Times::Fixed(count) => format!("[{count}]"),
        Times::Sequence(_) => "[<=9]".to_owned(),
    }
}

proptest! {
    #[test]
    fn a_header_is_found_behind_anything(
        before in prop::collection::vec((shapes(), times()), 0..5),
        between in prop::collection::vec((shapes(), times()), 0..3),
    ) {
        for form in FORMS {
            let mut made = MessageSample { form, sections: String::new(), types: 0, pieces: Vec::new() };
            let mut own = String::new();
            let is_header = |(shape, times): &&(Shape, Times)| {
                matches!((shape, times), (Shape::Header, Times::One))
            };
            for (index, (shape, times)) in before.iter().filter(|field| !is_header(field)).enumerate() {
                let name = made.define(shape);
                writeln!(own, "{name}{} before{index}", brackets(*times)).unwrap();
                made.fill(shape, *times);
            }
            own.push_str("std_msgs/Header head\n");
            made.pieces.push(header("found"));
            for (index, (shape, times)) in between.iter().enumerate() {
                let name = made.define(shape);
                writeln!(own, "{name}{} between{index}", brackets(*times)).unwrap();
                made.fill(shape, *times);
            }
            own.push_str("string child_frame_id\n");
            made.pieces.push(Piece::Text("child".to_owned()));
            let text = schema(form, &format!("{own}{}", made.sections));
            let decoder = decoder("/t", "acme/msg/Top", form, &text);
            prop_assert_eq!(decoder.unread(), None);
            let message = form.write(&made.pieces);
            let content = decoder.decode(&message).unwrap();
            let head = content.header.unwrap();
            prop_assert_eq!((head.stamp_ns, head.frame_id.as_ref()), (STAMP_NS, "found"));
            prop_assert_eq!(content.body, Body::ChildFrame("child".into()));
            prop_assert!(decoder.decode(&message[..message.len() - 1]).is_err());
        }
    }
}

#[test]
fn only_a_header_of_the_message_itself_counts() {
    for own in [
        "std_msgs/Header[] headers\n",
        "std_msgs/Header[2] headers\n",
        "geometry_msgs/PointStamped point\n",
        "# std_msgs/Header header\nuint8 x\n",
        "uint8 A=1\n",
    ] {
        let decoder = decoder("/t", "acme/Top", Form::Little, own);
        assert_eq!(decoder.unread(), None, "{own}");
        assert_eq!(decoder.decode(&[]).unwrap().header, None, "{own}");
    }
}

#[test]
fn a_header_that_cannot_be_reached_is_said() {
    let cases = [
        (
            "wstring name\nstd_msgs/Header h\n",
            "its header cannot be read: the size of a `wstring` differs between writers",
        ),
        (
            "acme/Missing m\nstd_msgs/Header h\n",
            "its header cannot be read: there is no definition of acme/Missing",
        ),
        (
            "uint8 x\n???\nstd_msgs/Header h\n",
            "its definition is not understood: line 2: `???` is not a field",
        ),
    ];
    for (own, why) in cases {
        assert_eq!(decoder("/t", "acme/Top", Form::Little, own).unread(), Some(why));
    }
    let broken = format!("Sub s\nstd_msgs/Header h\n{RULE}\nMSG: acme/Sub\nint8\n");
    let why = "its header cannot be read: acme/Sub is not understood: line 5: `int8` is not a field";
    assert_eq!(decoder("/t", "acme/Top", Form::Little, &broken).unread(), Some(why));
    let other = format!("std_msgs/Header h\n{RULE}\nMSG: std_msgs/Header\nint64 t\n");
    let why = "its definition of std_msgs/Header differs from the published one";
    assert_eq!(decoder("/t", "acme/Top", Form::Little, &other).unread(), Some(why));
    // Fields after the header do no harm.
    let behind = "std_msgs/Header h\nwstring name\nstring child_frame_id\n???\n";
    assert_eq!(decoder("/t", "acme/Top", Form::Little, behind).unread(), None);
}
