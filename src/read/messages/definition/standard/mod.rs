//! The fields of the types of the standard packages, a file each: for recordings that carry no definitions.
//!
//! Lists of fields only; each file names where the package is published. Where ROS 1 and ROS 2 differ, the field list is
//! that of ROS 2: headers stand at the same place in both.

/// The packages' texts, in the form of `ros2msg` with every type in a section of its own.
pub(super) const PACKAGES: &[&str] = &[
    include_str!("ackermann_msgs.msgs"),
    include_str!("action_msgs.msgs"),
    include_str!("actionlib_msgs.msgs"),
    include_str!("builtin_interfaces.msgs"),
    include_str!("can_msgs.msgs"),
    include_str!("control_msgs.msgs"),
    include_str!("diagnostic_msgs.msgs"),
    include_str!("geographic_msgs.msgs"),
    include_str!("geometry_msgs.msgs"),
    include_str!("gps_common.msgs"),
    include_str!("gps_msgs.msgs"),
    include_str!("lifecycle_msgs.msgs"),
    include_str!("map_msgs.msgs"),
    include_str!("mavros_msgs.msgs"),
    include_str!("move_base_msgs.msgs"),
    include_str!("nav2_msgs.msgs"),
    include_str!("nav_msgs.msgs"),
    include_str!("nmea_msgs.msgs"),
    include_str!("pcl_msgs.msgs"),
    include_str!("radar_msgs.msgs"),
    include_str!("rcl_interfaces.msgs"),
    include_str!("rosgraph_msgs.msgs"),
    include_str!("sensor_msgs.msgs"),
    include_str!("service_msgs.msgs"),
    include_str!("shape_msgs.msgs"),
    include_str!("statistics_msgs.msgs"),
    include_str!("std_msgs.msgs"),
    include_str!("stereo_msgs.msgs"),
    include_str!("tf.msgs"),
    include_str!("tf2_msgs.msgs"),
    include_str!("trajectory_msgs.msgs"),
    include_str!("ublox_msgs.msgs"),
    include_str!("unique_identifier_msgs.msgs"),
    include_str!("velodyne_msgs.msgs"),
    include_str!("vision_msgs.msgs"),
    include_str!("visualization_msgs.msgs"),
];
