//! Convention errors, as wrong drivers make them, and what they do to whatever has an orientation.
//!
//! Errors that only one kind of stream can have are applied in that stream's file; a stream refuses an error that it can't
//! have.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};
use serde::Deserialize;

/// A convention error. In recipes the names are written like `ned_frd`.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum Error {
    // Anything with an orientation.
    /// All of it in north, east, down of a body forward, right, down.
    NedFrd,
    /// The quaternion alone in north, east, down of a body forward, right, down.
    NedOrientation,
    /// The world north, east, down; the body as it should be.
    NedWorld,
    /// The inverse quaternion.
    Conjugate,
    /// The inverse pose.
    Inverse,
    /// `w x y z` in the slots of `x y z w`.
    Wxyz,
    /// Heading, clockwise from north, as the yaw.
    CompassYaw,
    /// Yaw zero in the north, towards the west.
    ZeroNorth,
    /// A body right, forward, up.
    YForward,
    /// A body backward, right, up.
    Backward,
    /// A body forward, right, down (a sensor: mounted upside down) that nobody knows of.
    Inverted,
    /// A body left, backward, up (a sensor: turned by 90 degrees) that nobody knows of.
    #[serde(rename = "yaw_90")]
    Yaw90,
    /// Roll, pitch and yaw put together in the other order.
    EulerXyz,
    /// Degrees taken for radians where roll, pitch and yaw become a quaternion.
    AnglesInDegrees,
    /// The orientation leans by 20 degrees; what the sensor measures does not.
    OrientationLeans,
    /// A yaw that stays zero, beside right roll and pitch.
    YawFrozen,
    /// A left-handed world and body: y to the right.
    LeftHanded,

    // IMU.
    /// Gyro and accelerometer forward, right, down beside a correct quaternion.
    Frd,
    /// Turn rates in degrees a second.
    DegS,
    /// Turn rates with the other sign.
    #[serde(alias = "negated")]
    GyroNegated,
    /// No orientation: the identity, and -1 as its first covariance.
    NoOrientation,
    /// Turn rates that are not filled in.
    GyroMissing,
    /// Accelerations in units of gravity.
    G,
    /// Accelerations in cm/s².
    #[serde(rename = "cm_s2")]
    CmS2,
    /// Accelerations with the other sign.
    GravitySign,
    /// Accelerations along y with the other sign.
    AccelYNegated,
    /// Accelerations along x and y swapped.
    AccelSwapped,
    /// Accelerations without gravity.
    GravityRemoved,

    // Positions of poses and odometry.
    /// x with the other sign; position alone, as the two below.
    XNegated,
    /// y with the other sign.
    YNegated,
    /// z with the other sign.
    ZNegated,
    /// Positions 1.25 times as far from the start.
    Scaled,
    /// x and y swapped: north and east taken for x and y.
    SwapXy,
    /// Eastings and northings of the UTM grid from the origin's, and a yaw from grid east: a grid taken for ENU.
    UtmGrid,
    /// Whole eastings and northings of the UTM grid, and a yaw from grid east.
    Utm,
    /// Positions in the Earth's frame.
    Ecef,
    /// Latitude, longitude in degrees as x and y, and the altitude as z.
    LatLonDegrees,
    /// The altitude over that of the origin as z: the Earth taken for flat in height alone.
    AltitudeAsZ,

    // Twists.
    /// Linear velocity in the axes of the world.
    TwistInWorld,
    /// Linear velocity with the other sign.
    TwistReversed,
    /// Linear velocity to the right.
    TwistYNegated,
    /// Linear velocity downwards.
    TwistZNegated,
    /// Linear velocity's x and y swapped.
    TwistSwapped,
    /// Yaw rate with the other sign.
    TwistYawNegated,
    /// GNSS velocity in the body's axes.
    TwistInBody,

    /// The twist's covariance in the axes of the world.
    TwistCovarianceInWorld,

    // Fixes.
    /// Latitude and longitude swapped.
    Swapped,
    /// Altitude above the geoid.
    Msl,
    /// Latitude and longitude in radians.
    Radians,
    /// Latitude and longitude as integers of 1e-7 degrees.
    E7,
    /// Latitude and longitude in single precision on their way.
    Float32,

    // Covariances.
    /// Rotations before positions.
    CovarianceRotationFirst,
    /// Rotations in degrees squared.
    CovarianceDegrees,
    /// Positions in square centimetres.
    CovarianceCentimetres,
    /// Positions in square millimetres.
    CovarianceMillimetres,
    /// Left in the body's axes.
    CovarianceNotRotated,
    /// Left in ENU, though the pose is given in another frame.
    CovarianceOfEnu,
    /// Standard deviations in place of variances.
    CovarianceStd,
    /// Up, north, east.
    CovarianceUpFirst,

    // `earth_from_map`.
    /// The rotation the other way round.
    Transposed,
    /// North, east and down in place of east, north and up.
    NedRows,
    /// The latitude of a sphere.
    SphericalLatitude,
    /// Rotations about axes, put together as rotations of vectors.
    ActiveRotations,
    /// Latitude and longitude swapped.
    LatLonSwapped,
}

/// `ned_from_enu`, and back.
pub fn ned_from_enu() -> Rotation3<f64> {
    Rotation3::from_matrix_unchecked(Matrix3::new(0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0))
}

/// `frd_from_flu`, and back.
pub fn frd_from_flu() -> Rotation3<f64> {
    Rotation3::from_matrix_unchecked(Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0)))
}

/// A turn to the left about the vertical axis.
pub fn turn(angle: f64) -> Rotation3<f64> {
    Rotation3::from_axis_angle(&Vector3::z_axis(), angle)
}

/// The quaternion in four slots.
pub fn rotation([x, y, z, w]: [f64; 4]) -> UnitQuaternion<f64> {
    UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z))
}

/// The slots of a rotation.
pub fn slots(rotation: UnitQuaternion<f64>) -> [f64; 4] {
    rotation.coords.into()
}

/// A row with an orientation.
pub trait OrientedRow {
    /// The slots of its orientation `world_from_body`.
    fn orientation(&mut self) -> &mut [f64; 4];
    /// Gives it in another world.
    fn change_world(&mut self, new_from_old: &Rotation3<f64>);
    /// Gives it for another body.
    fn change_body(&mut self, old_from_new: &Rotation3<f64>);
    /// Negates y of world and body: what lies left lies right.
    fn mirror(&mut self);
}

/// Applies an error of orientations; false where it is none.
pub fn apply(row: &mut impl OrientedRow, error: Error) -> bool {
    let published = rotation(*row.orientation());
    let (roll, pitch, yaw) = published.euler_angles();
    let body = match error {
        Error::NedFrd | Error::NedWorld => {
            row.change_world(&ned_from_enu());
            if error == Error::NedWorld {
                return true;
            }
            frd_from_flu()
        }
        Error::YForward => turn(-FRAC_PI_2),
        Error::Yaw90 => turn(FRAC_PI_2),
        Error::Backward => turn(2.0 * FRAC_PI_2),
        Error::Inverted => frd_from_flu(),
        Error::LeftHanded => {
            row.mirror();
            return true;
        }
        _ => {
            *row.orientation() = match error {
                Error::NedOrientation => slots(ned_from_enu() * published * frd_from_flu()),
                Error::Conjugate => slots(published.inverse()),
                Error::Wxyz => {
                    let [x, y, z, w] = *row.orientation();
                    [w, x, y, z]
                }
                Error::CompassYaw => slots(UnitQuaternion::from_euler_angles(roll, pitch, FRAC_PI_2 - yaw)),
                Error::ZeroNorth => slots(turn(-FRAC_PI_2) * published),
                Error::EulerXyz => {
                    let about = |axis: Vector3<f64>, angle: f64| UnitQuaternion::from_scaled_axis(axis * angle);
                    slots(about(Vector3::x(), roll) * about(Vector3::y(), pitch) * about(Vector3::z(), yaw))
                }
                Error::AnglesInDegrees => {
                    let [roll, pitch, yaw] = [roll, pitch, yaw].map(f64::to_degrees);
                    slots(UnitQuaternion::from_euler_angles(roll, pitch, yaw))
                }
                Error::OrientationLeans => {
                    slots(published * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 20f64.to_radians()))
                }
                Error::YawFrozen => slots(UnitQuaternion::from_euler_angles(roll, pitch, 0.0)),
                _ => return false,
            };
            return true;
        }
    };
    row.change_body(&body);
    true
}

/// The slots of an orientation seen in a mirror that negates y.
pub fn mirrored([x, y, z, w]: [f64; 4]) -> [f64; 4] {
    [-x, y, -z, w]
}

/// A stream that was asked for an error it can't have.
pub fn refuse(stream: &str, error: Error) -> ! {
    panic!("a stream of {stream} cannot have the error {error:?}")
}
