//! Messages written by an independent writer (`re_cdr`) or byte by byte, and read back.

mod hostile;
mod known;
mod members;
mod nmea;
mod places;
mod plain;
mod radar;
mod sensing;
mod unknown;

use re_cdr::{BigEndian, ByteOrder, CdrWriter, LittleEndian};

use super::content::Body;
use super::decoder::Decoder;
use super::definition::Definitions;
use super::format::Format;

/// A piece of a message.
#[derive(Clone, Debug)]
enum Piece {
    /// A number of 1, 2, 4 or 8 bytes by its bits.
    Bits(usize, u64),
    Float(f64),
    Text(String),
    Len(u32),
    /// Seconds and nanoseconds.
    Time(u32, u32),
    Header(u32, u32, String),
}

fn floats(from: u32, count: u32) -> impl Iterator<Item = Piece> {
    (from..from + count).map(|value| Piece::Float(f64::from(value) + 0.5))
}

fn row<const N: usize>(from: u32) -> [f64; N] {
    std::array::from_fn(|index| f64::from(from) + index as f64 + 0.5)
}

fn with(head: Piece, numbers: u32) -> Vec<Piece> {
    std::iter::once(head).chain(floats(0, numbers)).collect()
}

/// A type with its topic, a message and what that says.
type KnownMessage = (&'static str, &'static str, Vec<Piece>, Body<'static>);

fn header(frame: &str) -> Piece {
    Piece::Header(7, 8, frame.to_owned())
}

const STAMP_NS: i64 = 7_000_000_008;

/// How a message is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    Little,
    Big,
    Ros1,
}

const FORMS: [Form; 3] = [Form::Little, Form::Big, Form::Ros1];

impl Form {
    fn encoding(self) -> &'static str {
        if self == Self::Ros1 { "ros1" } else { "cdr" }
    }

    fn write(self, pieces: &[Piece]) -> Vec<u8> {
        let mut body = Vec::new();
        match self {
            Self::Little => cdr(&mut CdrWriter::<LittleEndian, _>::new(&mut body), pieces),
            Self::Big => cdr(&mut CdrWriter::<BigEndian, _>::new(&mut body), pieces),
            Self::Ros1 => {
                ros1(&mut body, pieces);
                return body;
            }
        }
        let mut message = vec![0, u8::from(self == Self::Little), 0, 0];
        message.append(&mut body);
        message
    }
}

fn cdr<BO: ByteOrder>(out: &mut CdrWriter<'_, BO, Vec<u8>>, pieces: &[Piece]) {
    let low = |bits: u64| u32::try_from(bits & 0xffff_ffff).unwrap();
    for piece in pieces {
        match piece {
            Piece::Bits(1, bits) => out.write_u8(bits.to_le_bytes()[0]),
            Piece::Bits(2, bits) => out.write_u16(u16::try_from(bits & 0xffff).unwrap()),
            Piece::Bits(4, bits) => out.write_u32(low(*bits)),
            Piece::Bits(_, bits) => out.write_u64(*bits),
            Piece::Float(value) => out.write_f64(*value),
            Piece::Text(text) => out.write_string(text),
            Piece::Len(len) => out.write_u32(*len),
            Piece::Time(seconds, nanoseconds) => {
                out.write_u32(*seconds);
                out.write_u32(*nanoseconds);
            }
            Piece::Header(seconds, nanoseconds, frame) => {
                out.write_u32(*seconds);
                out.write_u32(*nanoseconds);
                out.write_string(frame);
            }
        }
    }
}

fn ros1(out: &mut Vec<u8>, pieces: &[Piece]) {
    let text = |out: &mut Vec<u8>, text: &str| {
        out.extend(u32::try_from(text.len()).unwrap().to_le_bytes());
        out.extend(text.as_bytes());
    };
    for piece in pieces {
        match piece {
            Piece::Bits(size, bits) => out.extend(&bits.to_le_bytes()[..*size]),
            Piece::Float(value) => out.extend(value.to_le_bytes()),
            Piece::Text(words) => text(out, words),
            Piece::Len(len) => out.extend(len.to_le_bytes()),
            Piece::Time(seconds, nanoseconds) => {
                out.extend(seconds.to_le_bytes());
                out.extend(nanoseconds.to_le_bytes());
            }
            Piece::Header(seconds, nanoseconds, frame) => {
                for number in [4_711, *seconds, *nanoseconds] {
                    out.extend(number.to_le_bytes());
                }
                text(out, frame);
            }
        }
    }
}

/// The decoder of a type on a topic, by a definition in the form of `.msg` files; none where it is empty.
fn decoder(topic: &str, message_type: &str, form: Form, schema: &str) -> Decoder {
    let format = Format {
        topic,
        message_type,
        message_encoding: form.encoding(),
        schema: schema.as_bytes(),
        schema_encoding: if form == Form::Ros1 { "ros1msg" } else { "ros2msg" },
    };
    Decoder::of(&format, &Definitions::builtin())
}

const RULE: &str = "================================================================================";
const ROS1_HEADER: &str = "MSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n";

/// A definition with the header of ROS 1 where the form is that.
fn schema(form: Form, text: &str) -> String {
    match form {
        Form::Ros1 => format!("{text}\n{RULE}\n{ROS1_HEADER}"),
        Form::Little | Form::Big => text.to_owned(),
    }
}
