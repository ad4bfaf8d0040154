//! Point clouds as they are published: fields of points, and their bytes.
//!
//! Owns the reading of numbers from those bytes, in any layout. Sources: sensor_msgs (PointCloud2, PointField; the order is
//! the same in ROS 1 and ROS 2), livox_ros_driver2 (CustomMsg, CustomPoint).

use std::borrow::Cow;

use super::{Cursor, DecodeError, Wire};

/// Most fields of a point that are read; drivers have a dozen.
pub const MAX_FIELDS: u32 = 64;

/// `sensor_msgs/msg/PointCloud2`, or a driver's own cloud with the same fields.
#[derive(Clone, Debug, PartialEq)]
pub struct Cloud<'m> {
    /// Rows: 1 if the cloud is not organised.
    pub height: u32,
    /// Columns; the number of points where the cloud is not organised.
    pub width: u32,
    /// The fields of a point.
    pub fields: Vec<Field<'m>>,
    /// Whether the numbers are big-endian.
    pub is_bigendian: bool,
    /// From one point to the next, bytes.
    pub point_step: u32,
    /// From one row to the next, bytes.
    pub row_step: u32,
    /// The points.
    pub data: Cow<'m, [u8]>,
    /// The time from which the points' own times count, nanoseconds, if the message has one besides its header's.
    pub timebase_ns: Option<u64>,
}

/// One number, or several, of each point.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field<'m> {
    /// `x`, `intensity`, `ring`, `t`.
    pub name: Cow<'m, str>,
    /// From the beginning of the point, bytes.
    pub offset: u32,
    /// As `sensor_msgs/msg/PointField` counts them.
    pub datatype: u8,
    /// How many of them.
    pub count: u32,
}

/// The type of a number of a point, `PointField.datatype`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Datatype {
    /// 1.
    I8,
    /// 2.
    U8,
    /// 3.
    I16,
    /// 4.
    U16,
    /// 5.
    I32,
    /// 6.
    U32,
    /// 7.
    F32,
    /// 8.
    F64,
}

impl Datatype {
    /// By its number.
    pub fn of(datatype: u8) -> Option<Self> {
        Some(match datatype {
            1 => Self::I8,
            2 => Self::U8,
            3 => Self::I16,
            4 => Self::U16,
            5 => Self::I32,
            6 => Self::U32,
            7 => Self::F32,
            8 => Self::F64,
            _ => return None,
        })
    }

    /// Its size.
    pub fn bytes(self) -> u32 {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// How it is written in reports.
    pub fn word(self) -> &'static str {
        match self {
            Self::I8 => "int8",
            Self::U8 => "uint8",
            Self::I16 => "int16",
            Self::U16 => "uint16",
            Self::I32 => "int32",
            Self::U32 => "uint32",
            Self::F32 => "float32",
            Self::F64 => "float64",
        }
    }
}

/// The place of one number in every point.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    offset: usize,
    datatype: Datatype,
    is_bigendian: bool,
}

impl Column {
    /// A number at this byte of a point.
    pub fn new(offset: usize, datatype: Datatype, is_bigendian: bool) -> Self {
        Self {
            offset,
            datatype,
            is_bigendian,
        }
    }

    /// The number in these bytes of a point; `None` where they end before it.
    pub fn of(self, point: &[u8]) -> Option<f64> {
        let bytes = point.get(self.offset..)?;
        Some(match self.datatype {
            Datatype::I8 => f64::from(self.take::<1>(bytes)?[0].cast_signed()),
            Datatype::U8 => f64::from(self.take::<1>(bytes)?[0]),
            Datatype::I16 => f64::from(i16::from_le_bytes(self.take(bytes)?)),
            Datatype::U16 => f64::from(u16::from_le_bytes(self.take(bytes)?)),
            Datatype::I32 => f64::from(i32::from_le_bytes(self.take(bytes)?)),
            Datatype::U32 => f64::from(u32::from_le_bytes(self.take(bytes)?)),
            Datatype::F32 => f64::from(f32::from_le_bytes(self.take(bytes)?)),
            Datatype::F64 => f64::from_le_bytes(self.take(bytes)?),
        })
    }

    /// Bytes in little-endian order.
    fn take<const N: usize>(self, bytes: &[u8]) -> Option<[u8; N]> {
        let mut taken = *bytes.first_chunk::<N>()?;
        if self.is_bigendian {
            taken.reverse();
        }
        Some(taken)
    }
}

impl Cloud<'_> {
    /// How many points it claims to have.
    pub fn points(&self) -> u64 {
        u64::from(self.height) * u64::from(self.width)
    }

    /// The field of this name.
    pub fn field(&self, name: &str) -> Option<&Field<'_>> {
        self.fields.iter().find(|field| field.name == name)
    }

    /// The place of the numbers of a field; `None` where there is no such field, or its type is unknown.
    pub fn column(&self, name: &str) -> Option<Column> {
        let field = self.field(name)?;
        Some(Column {
            offset: usize::try_from(field.offset).ok()?,
            datatype: Datatype::of(field.datatype)?,
            is_bigendian: self.is_bigendian,
        })
    }

    /// From one row to the next, bytes: rows do not overlap, even if the message states a smaller step.
    fn row_bytes(&self) -> u64 {
        u64::from(self.row_step).max(u64::from(self.width) * u64::from(self.point_step))
    }

    /// How many rows have a point in the data: the stated number may be wrong.
    pub fn rows(&self) -> u32 {
        if self.width == 0 || self.point_step == 0 {
            return 0;
        }
        let begun = (self.data.len() as u64).div_ceil(self.row_bytes());
        u32::try_from(begun).map_or(self.height, |begun| begun.min(self.height))
    }

    /// The bytes of the point in this row and column; `None` where the data end before it.
    pub fn point(&self, row: u32, column: u32) -> Option<&[u8]> {
        let in_row = u64::from(column) * u64::from(self.point_step);
        let place = u64::from(row).checked_mul(self.row_bytes())?.checked_add(in_row)?;
        let place = usize::try_from(place).ok()?;
        let rest = self.data.get(place..)?;
        let step = usize::try_from(self.point_step).ok()?;
        Some(rest.get(..step).unwrap_or(rest)).filter(|point| !point.is_empty())
    }
}

/// Reads the rest of a `sensor_msgs/PointCloud2` after its header.
pub(super) fn point_cloud<'m>(cursor: &mut Cursor<'m>) -> Result<Cloud<'m>, DecodeError> {
    let [height, width] = [cursor.u32()?, cursor.u32()?];
    let (start, count) = (cursor.position(), cursor.sequence()?);
    if count > MAX_FIELDS {
        return Err(DecodeError(format!(
            "{count} fields of a point at byte {start}; at most {MAX_FIELDS} are read"
        )));
    }
    let fields = (0..count).map(|_| {
        Ok(Field {
            name: cursor.name()?.into(),
            offset: cursor.u32()?,
            datatype: cursor.i8()?.cast_unsigned(),
            count: cursor.u32()?,
        })
    });
    let fields = fields.collect::<Result<_, DecodeError>>()?;
    Ok(Cloud {
        height,
        width,
        fields,
        is_bigendian: cursor.i8()? != 0,
        point_step: cursor.u32()?,
        row_step: cursor.u32()?,
        data: Cow::Borrowed(cursor.bytes()?),
        timebase_ns: None,
    })
}

/// The fields of a `livox_ros_driver2/CustomPoint`, in its order.
const LIVOX_FIELDS: [(&str, u32, u8); 7] = [
    ("offset_time", 0, 6),
    ("x", 4, 7),
    ("y", 8, 7),
    ("z", 12, 7),
    ("reflectivity", 16, 2),
    ("tag", 17, 2),
    ("line", 18, 2),
];

/// Reads the rest of a `livox_ros_driver2/CustomMsg`, or `livox_ros_driver/CustomMsg`, after its header.
pub(super) fn livox<'m>(cursor: &mut Cursor<'m>) -> Result<Cloud<'m>, DecodeError> {
    let timebase_ns = cursor.u64()?;
    let _said = cursor.u32()?;
    cursor.skip_numbers(1, 4)?;
    let count = cursor.sequence()?;
    // CDR aligns every point to its first number; ROS 1 packs them.
    let point_step: u32 = match cursor.wire() {
        Wire::Cdr => 20,
        Wire::Ros1 => 19,
    };
    let fields = LIVOX_FIELDS.map(|(name, offset, datatype)| Field {
        name: Cow::Borrowed(name),
        offset,
        datatype,
        count: 1,
    });
    Ok(Cloud {
        height: 1,
        width: count,
        fields: fields.into(),
        is_bigendian: !cursor.is_little(),
        point_step,
        row_step: count.saturating_mul(point_step),
        data: Cow::Borrowed(cursor.rest(4)),
        timebase_ns: Some(timebase_ns),
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic)]
    use super::super::content::Body;
    use super::super::decoder::Decoder;
    use super::super::definition::Definitions;
    use super::super::format::Format;

    /// Two points of a Livox, as `ros1` or `cdr` has them: offset_time, x, y, z, reflectivity, tag, line.
    fn custom_msg(encoding: &str) -> Vec<u8> {
        let is_cdr = encoding == "cdr";
        let mut bytes: Vec<u8> = Vec::new();
        let align = |bytes: &mut Vec<u8>, to: usize| {
            while is_cdr && !bytes.len().is_multiple_of(to) {
                bytes.push(0);
            }
        };
        if !is_cdr {
            bytes.extend(7_u32.to_le_bytes());
        }
        bytes.extend([5_u32, 6].map(u32::to_le_bytes).concat());
        let frame: &[u8] = if is_cdr { b"livox\0" } else { b"livox" };
        bytes.extend(u32::try_from(frame.len()).unwrap().to_le_bytes());
        bytes.extend(frame);
        align(&mut bytes, 8);
        bytes.extend(5_000_000_006_u64.to_le_bytes());
        bytes.extend(2_u32.to_le_bytes());
        bytes.extend([1, 0, 0, 0]);
        bytes.extend(2_u32.to_le_bytes());
        for point in 0_u8..2 {
            align(&mut bytes, 4);
            bytes.extend((u32::from(point) * 1000).to_le_bytes());
            bytes.extend([1.5_f32, -2.0, f32::from(point)].map(f32::to_le_bytes).concat());
            bytes.extend([9, 16, point]);
        }
        let head: &[u8] = if is_cdr { &[0, 1, 0, 0] } else { &[] };
        [head, &bytes].concat()
    }

    #[test]
    fn the_points_of_a_livox_have_their_own_times() {
        for (encoding, message_type) in [
            ("ros1", "livox_ros_driver/CustomMsg"),
            ("cdr", "livox_ros_driver2/msg/CustomMsg"),
        ] {
            let format = Format {
                topic: "/livox/lidar",
                message_type,
                message_encoding: encoding,
                schema: b"",
                schema_encoding: "",
            };
            let bytes = custom_msg(encoding);
            let content = Decoder::of(&format, &Definitions::default()).decode(&bytes).unwrap();
            assert_eq!(content.header.unwrap().frame_id, "livox");
            let Body::Cloud(cloud) = content.body else {
                panic!("{encoding}")
            };
            assert_eq!((cloud.points(), cloud.timebase_ns), (2, Some(5_000_000_006)));
            let of = |name: &str, column: u32| cloud.column(name).unwrap().of(cloud.point(0, column).unwrap());
            assert_eq!([of("offset_time", 0), of("offset_time", 1)], [Some(0.0), Some(1000.0)]);
            assert_eq!([of("x", 1), of("y", 1), of("z", 1)], [Some(1.5), Some(-2.0), Some(1.0)]);
            assert_eq!(
                [of("reflectivity", 1), of("tag", 1), of("line", 1)],
                [Some(9.0), Some(16.0), Some(1.0)]
            );
        }
    }
}
