//! Any bytes as a message of each supported type, as CDR and as ROS 1: no panic, no work beyond the bytes.
use frames_lint::read::messages::content::{Body, MAX_PATH};
use frames_lint::read::messages::decoder::Decoder;
use frames_lint::read::messages::definition::Definitions;
use frames_lint::read::messages::format::Format;
use frames_lint::read::messages::header::Header;
use frames_lint::read::messages::radar::{Columns, MAX_ECHOES};
use frames_lint::read::messages::{MAX_NAME, Wire, tf};

const TYPES: [(&str, &str); 28] = [
    ("/tf", "tf2_msgs/msg/TFMessage"),
    ("/pose/tf", "geometry_msgs/msg/TransformStamped"),
    ("/odom", "nav_msgs/msg/Odometry"),
    ("/imu", "sensor_msgs/msg/Imu"),
    ("/fix", "sensor_msgs/NavSatFix"),
    ("/pose", "geometry_msgs/msg/PoseStamped"),
    ("/pose_cov", "geometry_msgs/PoseWithCovarianceStamped"),
    ("/twist", "geometry_msgs/TwistStamped"),
    ("/twist_cov", "geometry_msgs/TwistWithCovarianceStamped"),
    ("/clock", "rosgraph_msgs/Clock"),
    ("/robot_description", "std_msgs/msg/String"),
    ("/nmea", "std_msgs/msg/String"),
    ("/nmea_sentence", "nmea_msgs/msg/Sentence"),
    ("/gps", "gps_msgs/msg/GPSFix"),
    ("/heading", "geometry_msgs/msg/QuaternionStamped"),
    ("/fix_velocity", "geometry_msgs/msg/Vector3Stamped"),
    ("/geopose", "geographic_msgs/msg/GeoPoseStamped"),
    ("/plan", "nav_msgs/msg/Path"),
    ("/points", "sensor_msgs/msg/PointCloud2"),
    ("/livox", "livox_ros_driver2/msg/CustomMsg"),
    ("/velodyne_packets", "velodyne_msgs/msg/VelodyneScan"),
    ("/pandar_packets", "pandar_msgs/msg/PandarScan"),
    ("/packets", "nebula_msgs/msg/NebulaPackets"),
    ("/camera_info", "sensor_msgs/msg/CameraInfo"),
    ("/image", "sensor_msgs/msg/Image"),
    ("/scan", "sensor_msgs/msg/LaserScan"),
    ("/radar", "radar_msgs/msg/RadarScan"),
    ("/tracks", "radar_msgs/msg/RadarTracks"),
];

/// Runs the target.
pub fn run(bytes: &[u8]) {
    let definitions = Definitions::builtin();
    for (wire, message_encoding) in [(Wire::Cdr, "cdr"), (Wire::Ros1, "ros1")] {
        for (topic, message_type) in TYPES {
            let format = Format {
                topic,
                message_type,
                message_encoding,
                schema: &[],
                schema_encoding: "",
            };
            let decoder = Decoder::of(&format, &definitions);
            let Ok(content) = decoder.decode(bytes) else { continue };
            if let Some(header) = content.header {
                assert!(header.frame_id.len() <= MAX_NAME);
            }
            match content.body {
                Body::Odometry(odometry) => assert!(odometry.child.len() <= MAX_NAME),
                Body::Description(text) => assert!(text.len() <= bytes.len()),
                // The shortest pose is 12 bytes of header and 56 of numbers.
                Body::Path(poses) => assert!(poses.len() <= (bytes.len() / 68).min(MAX_PATH as usize)),
                // A range has four bytes; a return has 20, a track has more.
                Body::LaserScan(scan) => assert!(scan.ranges.len() <= bytes.len() / 4),
                Body::Radar(radar) => {
                    assert!(radar.total as usize <= bytes.len() / 20);
                    assert!(radar.echoes.len() <= (radar.total as usize).min(MAX_ECHOES as usize));
                }
                Body::Cloud(cloud) => {
                    let last = cloud.point(cloud.height.wrapping_sub(1), cloud.width.wrapping_sub(1));
                    assert!(last.is_none_or(|point| point.len() <= bytes.len()));
                    if let Some(columns) = Columns::of(&cloud) {
                        let _ = last.map(|point| columns.echo(point));
                    }
                }
                // A packet has a stamp of eight bytes and a length, or more.
                Body::Packets(scan) => {
                    assert!(scan.packets() <= bytes.len() / 12);
                    let _ = scan.decode(0);
                }
                Body::Fix(fix) => assert!(
                    fix.velocity
                        .is_none_or(|velocity| velocity.iter().all(|part| part.is_finite()))
                ),
                _ => {}
            }
        }
        let Ok(mut cursor) = wire.open(bytes) else { continue };
        if let Ok(transforms) = tf::transforms(cursor.clone()) {
            // The shortest transform is 12 bytes of header, 4 of child and 56 of numbers: a wrong count cannot give more.
            let all: Vec<_> = transforms.collect();
            assert!(all.len() <= bytes.len() / 72 + 1);
            let errors = all.iter().filter(|transform| transform.is_err()).count();
            assert!(errors == 0 || (errors == 1 && all.last().is_some_and(Result::is_err)));
        }
        if let Ok(header) = Header::read(&mut cursor.clone()) {
            assert!(header.frame_id.len() <= MAX_NAME);
        }
        while cursor.i32().is_ok() && cursor.f64().is_ok() && cursor.str().is_ok() {
            assert!(cursor.position() <= bytes.len());
        }
    }
}
