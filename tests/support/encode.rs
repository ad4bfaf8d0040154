//! Messages as CDR bytes, written with the `re_cdr` crate: an independent truth for the reader, which is our own.

use re_cdr::{BigEndian, ByteOrder, CdrWriter, LittleEndian};

/// A header.
#[derive(Clone, Copy, Debug)]
pub struct Header<'a> {
    /// Stamp, nanoseconds.
    pub stamp_ns: i64,
    /// Frame.
    pub frame_id: &'a str,
}

/// A transform as published.
#[derive(Clone, Copy, Debug)]
pub struct Transform<'a> {
    /// Stamp and parent.
    pub header: Header<'a>,
    /// Child.
    pub child: &'a str,
    /// Metres.
    pub translation: [f64; 3],
    /// `x y z w`.
    pub rotation: [f64; 4],
}

/// Byte order of a message.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Endian {
    /// As nearly all robots write.
    #[default]
    Little,
    /// The other one.
    Big,
}

/// What a message holds.
#[derive(Clone, Debug)]
pub enum Body<'a> {
    /// `tf2_msgs/msg/TFMessage`.
    Tf(&'a [Transform<'a>]),
    /// `nav_msgs/msg/Odometry`: at the origin, at rest.
    Odometry(Header<'a>, &'a str),
    /// `sensor_msgs/msg/Imu`: level and at rest, gravity +9.81 m/s² along z.
    Imu(Header<'a>),
    /// `geometry_msgs/msg/PoseStamped`: the identity.
    Pose(Header<'a>),
    /// `std_msgs/msg/String`.
    Text(&'a str),
    /// `ouster_sensor_msgs/msg/PacketMsg`: these bytes.
    Packet(Vec<u8>),
    /// A header and these fields.
    Fields(Header<'a>, Vec<Field<'a>>),
    /// A header and 512 zero bytes: enough for every field of fixed size and empty sequences.
    Padded(Header<'a>),
}

/// One or several fields in a row.
#[derive(Clone, Debug)]
pub enum Field<'a> {
    /// Numbers in double precision.
    F64s(Vec<f64>),
    /// As many numbers in double precision as there are, behind their count.
    Numbers(Vec<f64>),
    /// A number of four bytes.
    U32(u32),
    /// A number of eight bytes.
    U64(u64),
    /// A number in single precision.
    F32(f32),
    /// The length of a sequence whose elements follow.
    Count(usize),
    /// A sequence of bytes.
    Bytes(Vec<u8>),
    /// Bytes without a length before them.
    Array(Vec<u8>),
    /// A text of its own.
    Owned(String),
    /// A small number.
    I8(i8),
    /// A small number.
    U8(u8),
    /// A number of two bytes.
    U16(u16),
    /// A number of two bytes with a sign.
    I16(i16),
    /// A text.
    Text(&'a str),
    /// A header within the message.
    Header(Header<'a>),
    /// As many empty sequences.
    Empty(usize),
}

impl Body<'_> {
    /// The message's bytes, encapsulation included.
    pub fn encode(&self, endian: Endian) -> Vec<u8> {
        let mut body = Vec::new();
        match endian {
            Endian::Little => self.write(&mut CdrWriter::<LittleEndian, _>::new(&mut body)),
            Endian::Big => self.write(&mut CdrWriter::<BigEndian, _>::new(&mut body)),
        }
        let mut message = vec![0, u8::from(endian == Endian::Little), 0, 0];
        message.append(&mut body);
        message
    }

    fn write<BO: ByteOrder>(&self, out: &mut CdrWriter<'_, BO, Vec<u8>>) {
        let zeros = |out: &mut CdrWriter<'_, BO, Vec<u8>>, n: usize| (0..n).for_each(|_| out.write_f64(0.0));
        let identity = |out: &mut CdrWriter<'_, BO, Vec<u8>>| {
            zeros(out, 3);
            out.write_f64(1.0);
        };
        match self {
            Self::Tf(transforms) => {
                out.write_sequence_length(transforms.len());
                for transform in *transforms {
                    header(out, &transform.header);
                    out.write_string(transform.child);
                    for value in transform.translation.iter().chain(&transform.rotation) {
                        out.write_f64(*value);
                    }
                }
            }
            Self::Odometry(head, child) => {
                header(out, head);
                out.write_string(child);
                zeros(out, 3);
                identity(out);
                zeros(out, 36 + 6 + 36);
            }
            Self::Imu(head) => {
                header(out, head);
                identity(out);
                zeros(out, 9 + 3 + 9 + 2);
                out.write_f64(9.81);
                zeros(out, 9);
            }
            Self::Pose(head) => {
                header(out, head);
                zeros(out, 3);
                identity(out);
            }
            Self::Text(text) => out.write_string(text),
            Self::Packet(bytes) => {
                out.write_sequence_length(bytes.len());
                for byte in bytes {
                    out.write_u8(*byte);
                }
            }
            Self::Fields(head, fields) => {
                header(out, head);
                for field in fields {
                    match field {
                        Field::F64s(values) => values.iter().for_each(|value| out.write_f64(*value)),
                        Field::Numbers(values) => {
                            out.write_sequence_length(values.len());
                            for value in values {
                                out.write_f64(*value);
                            }
                        }
                        Field::U32(value) => out.write_u32(*value),
                        Field::U64(value) => out.write_u64(*value),
                        Field::F32(value) => out.write_f32(*value),
                        Field::Count(count) => out.write_sequence_length(*count),
                        Field::Bytes(bytes) => {
                            out.write_sequence_length(bytes.len());
                            for byte in bytes {
                                out.write_u8(*byte);
                            }
                        }
                        Field::Array(bytes) => bytes.iter().for_each(|byte| out.write_u8(*byte)),
                        Field::Owned(text) => out.write_string(text),
                        Field::I8(value) => out.write_i8(*value),
                        Field::U8(value) => out.write_u8(*value),
                        Field::U16(value) => out.write_u16(*value),
                        Field::I16(value) => out.write_i16(*value),
                        Field::Text(text) => out.write_string(text),
                        Field::Header(inner) => header(out, inner),
                        Field::Empty(n) => (0..*n).for_each(|_| out.write_sequence_length(0)),
                    }
                }
            }
            Self::Padded(head) => {
                header(out, head);
                (0..512).for_each(|_| out.write_u8(0));
            }
        }
    }
}

fn header<BO: ByteOrder>(out: &mut CdrWriter<'_, BO, Vec<u8>>, header: &Header<'_>) {
    let seconds = header.stamp_ns.div_euclid(1_000_000_000);
    let nanoseconds = header.stamp_ns.rem_euclid(1_000_000_000);
    let Ok(seconds) = i32::try_from(seconds) else {
        panic!("a stamp of {seconds} s does not fit into a ROS stamp (int32 seconds)");
    };
    out.write_i32(seconds);
    out.write_u32(u32::try_from(nanoseconds).unwrap());
    out.write_string(header.frame_id);
}
