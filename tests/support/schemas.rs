//! Definitions of the message types that recipes use, as `rosbag2` writes them into an MCAP: the type's own text, then
//! for every type it uses, depth first, a line of 80 `=`, a line `MSG: package/Type` and that type's text.
//!
//! The fields are those of `common_interfaces`, `geometry2` and `rcl_interfaces` (ROS 2 Jazzy); most comments are left
//! out.

use std::fmt::Write as _;

/// The full definition of a type (`sensor_msgs/msg/Imu`). Types that are not known here get a header and bytes.
pub fn definition(message_type: &str) -> String {
    let package = message_type.split('/').next().unwrap_or_default();
    let own = own_text(message_type).unwrap_or("std_msgs/Header header\nuint8[] data\n");
    let mut text = own.to_owned();
    let mut seen = Vec::new();
    append_used(package, own, &mut seen, &mut text);
    text
}

fn append_used(package: &str, own: &str, seen: &mut Vec<String>, text: &mut String) {
    for line in own.lines() {
        let field = line.split('#').next().unwrap_or_default().trim();
        let Some((field_type, rest)) = field.split_once(' ') else {
            continue;
        };
        let base = field_type.split(['[', '<']).next().unwrap_or_default();
        if rest.contains('=') || base.chars().next().is_none_or(char::is_lowercase) && !base.contains('/') {
            continue;
        }
        let (package, name) = base.split_once('/').unwrap_or((package, base));
        let short = format!("{package}/{name}");
        if seen.contains(&short) {
            continue;
        }
        seen.push(short.clone());
        let used = own_text(&format!("{package}/msg/{name}")).unwrap_or_else(|| panic!("no definition of {short}"));
        write!(text, "\n{}\nMSG: {short}\n{used}", "=".repeat(80)).unwrap();
        append_used(package, used, seen, text);
    }
}

fn own_text(message_type: &str) -> Option<&'static str> {
    TYPES
        .iter()
        .find(|(name, _)| *name == message_type)
        .map(|(_, text)| text.trim_start_matches('\n'))
}

const TYPES: &[(&str, &str)] = &[
    (
        "builtin_interfaces/msg/Time",
        "
# The seconds component, valid over all int32 values.
int32 sec

# The nanoseconds component, valid in the range [0, 1e9).
uint32 nanosec
",
    ),
    (
        "std_msgs/msg/Header",
        "
# Two-integer timestamp that is expressed as seconds and nanoseconds.
builtin_interfaces/Time stamp

# Transform frame with which this data is associated.
string frame_id
",
    ),
    (
        "std_msgs/msg/String",
        "
# This was originally provided as an example message.
string data
",
    ),
    (
        "geometry_msgs/msg/Vector3",
        "
float64 x
float64 y
float64 z
",
    ),
    (
        "geometry_msgs/msg/Point",
        "
# This contains the position of a point in free space
float64 x
float64 y
float64 z
",
    ),
    (
        "geometry_msgs/msg/Quaternion",
        "
# This represents an orientation in free space in quaternion form.
float64 x 0
float64 y 0
float64 z 0
float64 w 1
",
    ),
    (
        "geometry_msgs/msg/Transform",
        "
# This represents the transform between two coordinate frames in free space.
Vector3 translation
Quaternion rotation
",
    ),
    (
        "geometry_msgs/msg/TransformStamped",
        "
# This expresses a transform from coordinate frame header.frame_id
# to the coordinate frame child_frame_id at the time of header.stamp
std_msgs/Header header

# The frame id of the child frame to which this transform points.
string child_frame_id

# Translation and rotation in 3-dimensions of child_frame_id from header.frame_id.
Transform transform
",
    ),
    (
        "tf2_msgs/msg/TFMessage",
        "
geometry_msgs/TransformStamped[] transforms
",
    ),
    (
        "geometry_msgs/msg/Pose",
        "
# A representation of pose in free space, composed of position and orientation.
Point position
Quaternion orientation
",
    ),
    (
        "geometry_msgs/msg/PoseStamped",
        "
# A Pose with reference coordinate frame and timestamp
std_msgs/Header header
Pose pose
",
    ),
    (
        "geometry_msgs/msg/PoseWithCovariance",
        "
# This represents a pose in free space with uncertainty.
Pose pose
float64[36] covariance
",
    ),
    (
        "geometry_msgs/msg/PoseWithCovarianceStamped",
        "
# This expresses an estimated pose with a reference coordinate frame and timestamp
std_msgs/Header header
PoseWithCovariance pose
",
    ),
    (
        "geometry_msgs/msg/Twist",
        "
# This expresses velocity in free space broken into its linear and angular parts.
Vector3  linear
Vector3  angular
",
    ),
    (
        "geometry_msgs/msg/TwistStamped",
        "
# A twist with reference coordinate frame and timestamp
std_msgs/Header header
Twist twist
",
    ),
    (
        "geometry_msgs/msg/TwistWithCovariance",
        "
# This expresses velocity in free space with uncertainty.
Twist twist
float64[36] covariance
",
    ),
    (
        "geometry_msgs/msg/TwistWithCovarianceStamped",
        "
# This represents an estimated twist with reference coordinate frame and timestamp.
std_msgs/Header header
TwistWithCovariance twist
",
    ),
    (
        "nav_msgs/msg/Path",
        "
# An array of poses that represents a Path for a robot to follow.

# Indicates the frame_id of the path.
std_msgs/Header header

# Array of poses to follow.
geometry_msgs/PoseStamped[] poses
",
    ),
    (
        "nav_msgs/msg/Odometry",
        "
# This represents an estimate of a position and velocity in free space.

# Includes the frame id of the pose parent.
std_msgs/Header header

# Frame id the pose points to. The twist is in this coordinate frame.
string child_frame_id

# Estimated pose that is typically relative to a fixed world frame.
geometry_msgs/PoseWithCovariance pose

# Estimated linear and angular velocity relative to child_frame_id.
geometry_msgs/TwistWithCovariance twist
",
    ),
    (
        "sensor_msgs/msg/Imu",
        "
# This is a message to hold data from an IMU (Inertial Measurement Unit)
#
# Accelerations should be in m/s^2 (not in g's), and rotational velocity should be in rad/sec
std_msgs/Header header

geometry_msgs/Quaternion orientation
float64[9] orientation_covariance # Row major about x, y, z axes

geometry_msgs/Vector3 angular_velocity
float64[9] angular_velocity_covariance # Row major about x, y, z axes

geometry_msgs/Vector3 linear_acceleration
float64[9] linear_acceleration_covariance # Row major x, y z
",
    ),
    (
        "sensor_msgs/msg/NavSatStatus",
        "
int8 STATUS_UNKNOWN = -2        # status is not yet set
int8 STATUS_NO_FIX =  -1        # unable to fix position
int8 STATUS_FIX =      0        # unaugmented fix
int8 STATUS_SBAS_FIX = 1        # with satellite-based augmentation
int8 STATUS_GBAS_FIX = 2        # with ground-based augmentation

int8 status -2 # STATUS_UNKNOWN

uint16 SERVICE_UNKNOWN = 0
uint16 SERVICE_GPS =     1
uint16 SERVICE_GLONASS = 2
uint16 SERVICE_COMPASS = 4      # includes BeiDou.
uint16 SERVICE_GALILEO = 8

uint16 service
",
    ),
    (
        "sensor_msgs/msg/NavSatFix",
        "
# Navigation Satellite fix for any Global Navigation Satellite System
std_msgs/Header header

NavSatStatus status

float64 latitude
float64 longitude
float64 altitude
float64[9] position_covariance

uint8 COVARIANCE_TYPE_UNKNOWN = 0
uint8 COVARIANCE_TYPE_APPROXIMATED = 1
uint8 COVARIANCE_TYPE_DIAGONAL_KNOWN = 2
uint8 COVARIANCE_TYPE_KNOWN = 3

uint8 position_covariance_type
",
    ),
    (
        "sensor_msgs/msg/PointField",
        "
uint8 INT8    = 1
uint8 UINT8   = 2
uint8 INT16   = 3
uint8 UINT16  = 4
uint8 INT32   = 5
uint8 UINT32  = 6
uint8 FLOAT32 = 7
uint8 FLOAT64 = 8

string name
uint32 offset
uint8  datatype
uint32 count
",
    ),
    (
        "sensor_msgs/msg/PointCloud2",
        "
# This message holds a collection of N-dimensional points
std_msgs/Header header

uint32 height
uint32 width

PointField[] fields

bool    is_bigendian
uint32  point_step
uint32  row_step
uint8[] data

bool is_dense
",
    ),
    (
        "velodyne_msgs/msg/VelodyneScan",
        "
std_msgs/Header header
VelodynePacket[] packets
",
    ),
    (
        "ouster_sensor_msgs/msg/PacketMsg",
        "
uint8[] buf
",
    ),
    (
        "velodyne_msgs/msg/VelodynePacket",
        "
builtin_interfaces/Time stamp
uint8[1206] data
",
    ),
    (
        "livox_ros_driver2/msg/CustomMsg",
        "
std_msgs/Header header
uint64 timebase
uint32 point_num
uint8 lidar_id
uint8[3] rsvd
CustomPoint[] points
",
    ),
    (
        "livox_ros_driver2/msg/CustomPoint",
        "
uint32 offset_time
float32 x
float32 y
float32 z
uint8 reflectivity
uint8 tag
uint8 line
",
    ),
    (
        "sensor_msgs/msg/LaserScan",
        "
# Single scan from a planar laser range-finder
std_msgs/Header header

float32 angle_min
float32 angle_max
float32 angle_increment

float32 time_increment

float32 scan_time

float32 range_min
float32 range_max

float32[] ranges
float32[] intensities
",
    ),
    (
        "nav_msgs/msg/MapMetaData",
        "
builtin_interfaces/Time map_load_time
float32 resolution
uint32 width
uint32 height
geometry_msgs/Pose origin
",
    ),
    (
        "nav_msgs/msg/OccupancyGrid",
        "
std_msgs/Header header
MapMetaData info
int8[] data
",
    ),
    (
        "grid_map_msgs/msg/GridMapInfo",
        "
float64 resolution
float64 length_x
float64 length_y
geometry_msgs/Pose pose
",
    ),
    (
        "grid_map_msgs/msg/GridMap",
        "
std_msgs/Header header
GridMapInfo info
string[] layers
string[] basic_layers
std_msgs/Float32MultiArray[] data
uint16 outer_start_index
uint16 inner_start_index
",
    ),
    (
        "std_msgs/msg/Float32MultiArray",
        "
MultiArrayLayout layout
float32[] data
",
    ),
    (
        "std_msgs/msg/MultiArrayLayout",
        "
MultiArrayDimension[] dim
uint32 data_offset
",
    ),
    (
        "std_msgs/msg/MultiArrayDimension",
        "
string label
uint32 size
uint32 stride
",
    ),
    (
        "sensor_msgs/msg/Image",
        "
# This message contains an uncompressed image
std_msgs/Header header

uint32 height
uint32 width

string encoding

uint8 is_bigendian
uint32 step
uint8[] data
",
    ),
    (
        "sensor_msgs/msg/RegionOfInterest",
        "
uint32 x_offset
uint32 y_offset
uint32 height
uint32 width

bool do_rectify
",
    ),
    (
        "sensor_msgs/msg/CameraInfo",
        "
# This message defines meta information for a camera.
std_msgs/Header header

uint32 height
uint32 width

string distortion_model

float64[] d
float64[9]  k # 3x3 row-major matrix
float64[9]  r # 3x3 row-major matrix
float64[12] p # 3x4 row-major matrix

uint32 binning_x
uint32 binning_y

RegionOfInterest roi
",
    ),
    (
        "geometry_msgs/msg/QuaternionStamped",
        "
# This represents an orientation with reference coordinate frame and timestamp.
std_msgs/Header header
Quaternion quaternion
",
    ),
    (
        "sensor_msgs/msg/MagneticField",
        "
# Measurement of the Magnetic Field vector at a specific location.
std_msgs/Header header

geometry_msgs/Vector3 magnetic_field
float64[9] magnetic_field_covariance
",
    ),
    (
        "nmea_msgs/msg/Sentence",
        "
# A message representing a single NMEA0183 sentence.

# header.stamp is the ROS Time when the sentence was read.
# header.frame_id is the frame_id reported by the satellite receiver
std_msgs/Header header

# This should only contain ASCII characters in order to be a valid NMEA0183 sentence.
string sentence
",
    ),
    (
        "gps_msgs/msg/GPSStatus",
        "
std_msgs/Header header

uint16 satellites_used
int32[] satellite_used_prn

uint16 satellites_visible
int32[] satellite_visible_prn
int32[] satellite_visible_z
int32[] satellite_visible_azimuth
int32[] satellite_visible_snr

int16 STATUS_NO_FIX=-1
int16 STATUS_FIX=0
int16 STATUS_SBAS_FIX=1
int16 STATUS_GBAS_FIX=2
int16 status

uint16 motion_source
uint16 orientation_source
uint16 position_source
",
    ),
    (
        "gps_msgs/msg/GPSFix",
        "
# A more complete GPS fix to supplement sensor_msgs/NavSatFix.
std_msgs/Header header

GPSStatus status

float64 latitude
float64 longitude
float64 altitude

float64 track
float64 speed
float64 climb

float64 pitch
float64 roll
float64 dip

float64 time

float64 gdop
float64 pdop
float64 hdop
float64 vdop
float64 tdop

float64 err
float64 err_horz
float64 err_vert
float64 err_track
float64 err_speed
float64 err_climb
float64 err_time
float64 err_pitch
float64 err_roll
float64 err_dip

float64[9] position_covariance

uint8 COVARIANCE_TYPE_UNKNOWN = 0
uint8 COVARIANCE_TYPE_APPROXIMATED = 1
uint8 COVARIANCE_TYPE_DIAGONAL_KNOWN = 2
uint8 COVARIANCE_TYPE_KNOWN = 3
uint8 position_covariance_type
",
    ),
    (
        "sensor_msgs/msg/LaserScan",
        "
std_msgs/Header header
float32 angle_min
float32 angle_max
float32 angle_increment
float32 time_increment
float32 scan_time
float32 range_min
float32 range_max
float32[] ranges
float32[] intensities
",
    ),
    (
        "radar_msgs/msg/RadarReturn",
        "
float32 range
float32 azimuth
float32 elevation
float32 doppler_velocity
float32 amplitude
",
    ),
    (
        "radar_msgs/msg/RadarScan",
        "
std_msgs/Header header
radar_msgs/RadarReturn[] returns
",
    ),
    (
        "ti_mmwave_rospkg/msg/RadarScan",
        "
std_msgs/Header header
uint16 point_id
float32 x
float32 y
float32 z
float32 range
float32 velocity
uint16 doppler_bin
float32 bearing
float32 intensity
",
    ),
    (
        "continental_msgs/msg/ContinentalSrr520Detection",
        "
float32 range
float32 azimuth_angle
float32 range_rate
float32 rcs
uint8 pdh00
uint8 pdh01
uint8 pdh02
uint8 pdh03
uint8 pdh04
uint8 pdh05
float32 snr
",
    ),
    (
        "continental_msgs/msg/ContinentalSrr520DetectionList",
        "
std_msgs/Header header
uint32 internal_time_stamp_usec
uint8 global_time_stamp_sync_status
uint8 signal_status
uint8 sequence_counter
uint32 cycle_counter
float32 vambig
float32 max_range
continental_msgs/ContinentalSrr520Detection[] detections
",
    ),
    (
        "delphi_esr_msgs/msg/EsrTrack",
        "
std_msgs/Header header
string canmsg
uint8 id
float32 lat_rate
bool grouping_changed
bool oncoming
uint8 status
float32 angle
float32 range
bool bridge_object
bool rolling_count
float32 width
float32 range_accel
uint8 med_range_mode
float32 range_rate
",
    ),
    (
        "vn_driver/msg/Vectornav",
        "
std_msgs/Header header
sensor_msgs/Imu imu
sensor_msgs/MagneticField mag_field
string vnymr_read
",
    ),
    (
        "gps_driver/msg/Customgps",
        "
std_msgs/Header header
float64 latitude
float64 longitude
float64 altitude
",
    ),
];
