//! The fields of the messages that recipes know the numbers of, behind the header.

use super::encode::Field;
use super::motion::PublishedPose;
use super::topic::{Topic, Twist};

impl Topic {
    /// The fields of the `number`-th message of a type; `None` for types of which only the header is written.
    pub(super) fn fields(&self, message_type: &str, at_s: f64, number: u64) -> Option<Vec<Field<'_>>> {
        let pose = self.motion.at(at_s, number, &self.name);
        let twist = self.twist.unwrap_or(Twist {
            linear: self.motion.velocity,
            angular: [0.0, 0.0, self.motion.yaw_rate_deg_s.to_radians()],
        });
        Some(match message_type {
            "nav_msgs/msg/Odometry" => {
                let mut fields = vec![Field::Text(&self.child_frame_id)];
                fields.extend(pose_fields(pose));
                fields.push(matrix::<36>(self.pose_covariance.as_deref()));
                fields.extend(twist_fields(twist));
                fields.push(matrix::<36>(self.twist_covariance.as_deref()));
                fields
            }
            "geometry_msgs/msg/PoseStamped" => pose_fields(pose).into(),
            "geometry_msgs/msg/PoseWithCovarianceStamped" => {
                let mut fields = Vec::from(pose_fields(pose));
                fields.push(matrix::<36>(self.covariance.as_deref()));
                fields
            }
            "geometry_msgs/msg/TwistStamped" => twist_fields(twist).into(),
            "geometry_msgs/msg/TwistWithCovarianceStamped" => {
                let mut fields = Vec::from(twist_fields(twist));
                fields.push(matrix::<36>(self.covariance.as_deref()));
                fields
            }
            "sensor_msgs/msg/Imu" => vec![
                Field::F64s(self.orientation.unwrap_or([0.0, 0.0, 0.0, 1.0]).into()),
                matrix::<9>(self.orientation_covariance.as_deref()),
                Field::F64s(self.angular_velocity.into()),
                matrix::<9>(self.angular_velocity_covariance.as_deref()),
                Field::F64s(self.linear_acceleration.unwrap_or([0.0, 0.0, 9.81]).into()),
                matrix::<9>(self.acceleration_covariance.as_deref()),
            ],
            "sensor_msgs/msg/NavSatFix" => self.fix(at_s),
            "nav_msgs/msg/OccupancyGrid" => self.grid.as_ref()?.occupancy(),
            "grid_map_msgs/msg/GridMap" => self.grid.as_ref()?.layers(),
            "sensor_msgs/msg/Image" => self.camera.as_ref()?.image(),
            "sensor_msgs/msg/CameraInfo" => self.camera.as_ref()?.info(),
            _ => return None,
        })
    }

    fn fix(&self, at_s: f64) -> Vec<Field<'_>> {
        let [latitude, longitude, altitude] = if self.nan_from_s.is_some_and(|from| at_s >= from) {
            [f64::NAN; 3]
        } else {
            // Radii of curvature of the WGS 84 ellipsoid at the start: good for the few kilometres of a drive.
            let (a, e2) = (6_378_137.0, 6.694_379_990_14e-3);
            let (sin, cos) = self.latitude.to_radians().sin_cos();
            let w = (1.0_f64 - e2 * sin * sin).sqrt();
            let (meridian, normal) = (a * (1.0 - e2) / w.powi(3), a / w);
            [
                self.latitude + (self.north_velocity * at_s / meridian).to_degrees(),
                self.longitude + (self.east_velocity * at_s / (normal * cos)).to_degrees(),
                self.altitude,
            ]
        };
        let kind = if self.covariance.is_some() { 3 } else { 0 };
        vec![
            Field::I8(self.status),
            Field::U16(1),
            Field::F64s(vec![latitude, longitude, altitude]),
            matrix::<9>(self.covariance.as_deref()),
            Field::U8(kind),
        ]
    }
}

pub(super) fn pose_fields<'a>(pose: PublishedPose) -> [Field<'a>; 2] {
    [Field::F64s(pose.position.into()), Field::F64s(pose.orientation.into())]
}

pub(super) fn twist_fields<'a>(twist: Twist) -> [Field<'a>; 2] {
    [Field::F64s(twist.linear.into()), Field::F64s(twist.angular.into())]
}

/// A matrix of `N` numbers; zeros where it was left out.
fn matrix<'a, const N: usize>(given: Option<&[f64]>) -> Field<'a> {
    let values = given.map_or_else(|| vec![0.0; N], Vec::from);
    assert_eq!(values.len(), N, "a covariance of {} numbers, {N} needed", values.len());
    Field::F64s(values)
}
