//! What sensors see: calibrations, images and clouds, whole, cut and made up.

use std::borrow::Cow;

use super::{FORMS, KnownMessage, Piece, RULE, decoder, floats, header, row, schema, with};
use crate::read::messages::cloud::{Cloud, Datatype, Field};
use crate::read::messages::content::{Body, CameraInfo, Image, Roi};

/// Two points of a float32 and a uint16.
const TWO: [u8; 12] = [0, 0, 0x20, 0x41, 5, 0, 0, 0, 0xa0, 0xbf, 6, 1];

fn whole(value: u32) -> Piece {
    Piece::Bits(4, u64::from(value))
}

fn single(value: f32) -> Piece {
    whole(value.to_bits())
}

fn byte(value: u8) -> Piece {
    Piece::Bits(1, u64::from(value))
}

fn text(text: &str) -> Piece {
    Piece::Text(text.to_owned())
}

fn field(name: &'static str, offset: u32, datatype: u8) -> Field<'static> {
    Field {
        name: name.into(),
        offset,
        datatype,
        count: 1,
    }
}

/// A cloud of two points behind its header.
fn two_points(size: [u32; 2]) -> Vec<Piece> {
    let mut pieces = vec![header("map"), whole(size[0]), whole(size[1]), Piece::Len(2)];
    pieces.extend([text("x"), whole(0), byte(7), whole(1)]);
    pieces.extend([text("ring"), whole(4), byte(4), whole(1)]);
    pieces.extend([byte(0), whole(6), whole(12), Piece::Len(12)]);
    pieces.extend(TWO.map(byte));
    pieces.push(byte(1));
    pieces
}

pub(super) fn all() -> Vec<KnownMessage> {
    let mut info = vec![header("map"), whole(480), whole(640), text("plumb_bob"), Piece::Len(5)];
    info.extend(floats(0, 5 + 9 + 9 + 12));
    info.extend([2, 3, 10, 20, 30, 40].map(whole));
    info.push(byte(1));
    let mut image = vec![
        header("map"),
        whole(2),
        whole(1),
        text("rgb8"),
        byte(0),
        whole(3),
        Piece::Len(6),
    ];
    image.extend((0..6).map(byte));
    vec![
        (
            "/camera_info",
            "sensor_msgs/CameraInfo",
            info,
            Body::CameraInfo(Box::new(CameraInfo {
                height: 480,
                width: 640,
                model: "plumb_bob".into(),
                d: row::<5>(0).into(),
                k: row(5),
                r: row(14),
                p: row(23),
                binning: [2, 3],
                roi: Roi {
                    x: 10,
                    y: 20,
                    height: 30,
                    width: 40,
                    do_rectify: true,
                },
            })),
        ),
        (
            "/image",
            "sensor_msgs/Image",
            image,
            Body::Image(Image {
                height: 2,
                width: 1,
                encoding: "rgb8".into(),
            }),
        ),
        (
            "/points",
            "sensor_msgs/PointCloud2",
            two_points([1, 2]),
            Body::Cloud(Box::new(Cloud {
                height: 1,
                width: 2,
                fields: vec![field("x", 0, 7), field("ring", 4, 4)],
                is_bigendian: false,
                point_step: 6,
                row_step: 12,
                data: Cow::Borrowed(&TWO),
                timebase_ns: None,
            })),
        ),
    ]
}

fn numbers(cloud: &Cloud<'_>, name: &str) -> Vec<f64> {
    let column = cloud.column(name).unwrap();
    let of = |place| column.of(cloud.point(0, place)?);
    (0..cloud.width).map(|place| of(place).unwrap()).collect()
}

#[test]
fn the_numbers_of_points_are_read_where_the_fields_say() {
    let pieces = two_points([1, 2]);
    for form in FORMS {
        let message = form.write(&pieces);
        let content = decoder("/points", "sensor_msgs/msg/PointCloud2", form, "");
        let Body::Cloud(cloud) = content.decode(&message).unwrap().body else {
            panic!("{form:?}")
        };
        assert_eq!(numbers(&cloud, "x"), [10.0, -1.25], "{form:?}");
        assert_eq!(numbers(&cloud, "ring"), [5.0, 262.0], "{form:?}");
        assert!(cloud.column("y").is_none() && cloud.point(0, 2).is_none(), "{form:?}");
    }
}

/// As livox_ros_driver2 defines it.
const LIVOX: &str =
    "std_msgs/Header header\nuint64 timebase\nuint32 point_num\nuint8 lidar_id\nuint8[3] rsvd\nCustomPoint[] points\n";
const LIVOX_POINT: &str = "MSG: livox_ros_driver2/CustomPoint\nuint32 offset_time\nfloat32 x\nfloat32 y\nfloat32 z\nuint8 reflectivity\nuint8 tag\nuint8 line\n";

#[test]
fn points_of_livox_are_read_on_every_wire_with_and_without_their_definition() {
    let mut pieces = vec![header("livox"), Piece::Bits(8, 1_700_000_000_000_000_007), whole(3)];
    pieces.extend([1, 0, 0, 0].map(byte));
    pieces.push(Piece::Len(3));
    for point in [1_u8, 2, 3] {
        let at = f32::from(point);
        pieces.extend([whole(100 * u32::from(point)), single(at), single(-at), single(at / 4.0)]);
        pieces.extend([point + 10, point + 20, point + 30].map(byte));
    }
    let own = format!("{LIVOX}{RULE}\n{LIVOX_POINT}");
    for form in FORMS {
        for schema in [String::new(), schema(form, &own)] {
            let decoder = decoder("/livox/lidar", "livox_ros_driver2/msg/CustomMsg", form, &schema);
            assert_eq!((decoder.unread(), decoder.note()), (None, None), "{form:?}");
            let message = form.write(&pieces);
            let content = decoder.decode(&message).unwrap();
            let Body::Cloud(cloud) = content.body else {
                panic!("{form:?}")
            };
            assert_eq!(cloud.timebase_ns, Some(1_700_000_000_000_000_007), "{form:?}");
            assert_eq!((cloud.points(), cloud.rows()), (3, 1), "{form:?}");
            assert_eq!(numbers(&cloud, "offset_time"), [100.0, 200.0, 300.0], "{form:?}");
            assert_eq!(numbers(&cloud, "y"), [-1.0, -2.0, -3.0], "{form:?}");
            assert_eq!(numbers(&cloud, "z"), [0.25, 0.5, 0.75], "{form:?}");
            assert_eq!(numbers(&cloud, "line"), [31.0, 32.0, 33.0], "{form:?}");
        }
    }
}

fn cloud(size: [u32; 2], steps: [u32; 2], data: &[u8]) -> Cloud<'_> {
    Cloud {
        height: size[0],
        width: size[1],
        fields: vec![
            field("x", 0, 7),
            field("odd", 0, 9),
            field("far", u32::MAX, 7),
            field("edge", 3, 8),
        ],
        is_bigendian: false,
        point_step: steps[0],
        row_step: steps[1],
        data: Cow::Borrowed(data),
        timebase_ns: None,
    }
}

#[test]
fn every_type_of_number_is_read_in_both_orders() {
    let cases: [(u8, &str, &[u8], f64); 9] = [
        (1, "int8", &[0xfe], -2.0),
        (2, "uint8", &[0xfe], 254.0),
        (3, "int16", &[0xfe, 0xff], -2.0),
        (4, "uint16", &[0x01, 0x02], 513.0),
        (5, "int32", &[0, 0, 0, 0x80], -2_147_483_648.0),
        (6, "uint32", &[0, 0, 0, 0x80], 2_147_483_648.0),
        (7, "float32", &[0, 0, 0x20, 0xc1], -10.0),
        (8, "float64", &[0, 0, 0, 0, 0, 0, 0xe0, 0x3f], 0.5),
        (7, "float32", &[0, 0, 0x80, 0x7f], f64::INFINITY),
    ];
    for (datatype, word, bytes, value) in cases {
        assert_eq!(Datatype::of(datatype).unwrap().word(), word);
        for is_bigendian in [false, true] {
            let mut data = vec![7];
            data.extend(bytes);
            if is_bigendian {
                data[1..].reverse();
            }
            let one = Cloud {
                fields: vec![field("n", 1, datatype)],
                is_bigendian,
                ..cloud([1, 1], [u32::try_from(data.len()).unwrap(), 0], &data)
            };
            let column = one.column("n").unwrap();
            assert_eq!(column.of(one.point(0, 0).unwrap()), Some(value), "{word}");
            assert_eq!(column.of(&data[..bytes.len()]), None, "{word}: one byte too few");
        }
    }
    assert!([0, 9, 255].into_iter().all(|datatype| Datatype::of(datatype).is_none()));
}

#[test]
fn sizes_that_lie_give_the_points_that_are_there() {
    let data = [0; 40];
    let rows = |size, steps| cloud(size, steps, &data).rows();
    assert_eq!(rows([2, 2], [10, 20]), 2);
    // Cut in the third row; padded rows; a row step of nothing, and one that would make rows overlap.
    assert_eq!(rows([9, 2], [10, 20]), 2);
    assert_eq!(rows([9, 2], [9, 18]), 3);
    assert_eq!(rows([9, 1], [10, 30]), 2);
    assert_eq!(rows([9, 2], [10, 0]), 2);
    assert_eq!(rows([u32::MAX, 1], [1, 1]), 40);
    for (size, steps) in [
        ([u32::MAX, u32::MAX], [u32::MAX, u32::MAX]),
        ([u32::MAX, u32::MAX], [u32::MAX, 0]),
        ([u32::MAX, u32::MAX], [1, 0]),
    ] {
        assert_eq!(rows(size, steps), 1);
        assert!(cloud(size, steps, &data).point(u32::MAX, u32::MAX).is_none());
    }
    for (size, steps) in [([0, 0], [1, 1]), ([5, 0], [4, 0]), ([0, 5], [4, 20]), ([5, 5], [0, 0])] {
        assert_eq!(rows(size, steps), 0, "{size:?} {steps:?}");
    }
    assert_eq!(cloud([5, 5], [4, 20], &[]).rows(), 0);

    let plain = cloud([1, 4], [10, 40], &data);
    assert!(plain.column("odd").is_none(), "a type that nobody knows");
    let [far, edge] = ["far", "edge"].map(|name| plain.column(name).unwrap());
    assert_eq!(far.of(plain.point(0, 0).unwrap()), None);
    assert_eq!(edge.of(plain.point(0, 3).unwrap()), None, "seven of its eight bytes");
}

#[test]
fn too_many_of_anything_is_an_error() {
    for form in FORMS {
        let mut pieces = vec![header("map"), whole(1), whole(1), Piece::Len(65)];
        pieces.extend(std::iter::repeat_n(Piece::Float(0.0), 1000));
        let read = |message_type, pieces: &[Piece]| {
            let message = form.write(pieces);
            decoder("/t", message_type, form, "").decode(&message).unwrap_err().0
        };
        let error = read("sensor_msgs/msg/PointCloud2", &pieces);
        assert!(error.contains("65 fields of a point"), "{error}");
        let mut info = vec![header("map"), whole(1), whole(1), text("x"), Piece::Len(u32::MAX)];
        info.extend(with(header("map"), 50));
        let error = read("sensor_msgs/msg/CameraInfo", &info);
        assert!(error.contains("distortion coefficients"), "{error}");
    }
}

#[test]
fn a_cloud_cut_anywhere_is_an_error_or_a_cloud_without_panic() {
    for form in FORMS {
        for pieces in [two_points([1, 2]), two_points([u32::MAX, u32::MAX])] {
            let message = form.write(&pieces);
            let decoder = decoder("/points", "sensor_msgs/msg/PointCloud2", form, "");
            // The last byte states whether all points are finite, and is not read.
            for end in 0..message.len() {
                let read = decoder.decode(&message[..end]);
                assert_eq!(read.is_ok(), end == message.len() - 1, "{form:?} {end}");
            }
        }
    }
}
