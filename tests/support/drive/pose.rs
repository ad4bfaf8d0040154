//! Poses of a drive in the map: what localisation publishes, as messages and as edges of TF, and where the map lies on the
//! Earth.

use nalgebra::{Isometry3, Rotation3, Translation3, UnitQuaternion, Vector3};

use super::covariance::{self, diagonal6, rotate6};
use super::description::Gnss;
use super::earth::Place;
use super::errors::{self, Error, OrientedRow, mirrored, ned_from_enu, rotation, slots, turn};
use super::random::Wander;
use super::rows::PoseRow;
use super::{Drive, Stream};

/// White noise of localisation: along and across the way and up, metres.
const POSITION: Vector3<f64> = Vector3::new(0.10, 0.03, 0.05);
/// White noise of localisation about the axes of the world, rad: 0.1, 0.1 and 0.3 degrees.
const ROTATION: Vector3<f64> = Vector3::new(1.745e-3, 1.745e-3, 5.236e-3);

/// Wandering errors of a filter: metres, and rad about the axes of the world.
const FILTERED: (Vector3<f64>, Vector3<f64>) = (Vector3::new(0.05, 0.05, 0.05), Vector3::new(0.0, 0.0, 1e-3));

impl Drive {
    /// What localisation publishes: `map_from_base`, the map being the ENU frame of the datum unless the stream says
    /// otherwise.
    pub fn pose_rows(&self, stream: &Stream) -> Vec<PoseRow> {
        let random = &mut self.random(&stream.name);
        let noise = if self.description.gnss == Gnss::Perfect {
            0.0
        } else {
            stream.noise
        };
        let datum = stream.datum.unwrap_or(self.description.place);
        let row = |t_s: &f64| {
            let state = self.at(t_s - stream.late_s);
            let ahead = turn(state.yaw);
            let base = Isometry3::from_parts(Translation3::from(state.position), state.orientation);
            let mut exact = base * stream.base_from_sensor;
            exact.translation.vector += ahead * random.normals().component_mul(&POSITION) * noise;
            let wrong = random.normals().component_mul(&ROTATION) * noise;
            exact.rotation = UnitQuaternion::from_scaled_axis(wrong) * exact.rotation;

            let mut covariance =
                diagonal6(POSITION * noise, ROTATION * noise).map(|value| value * stream.covariance_scale);
            if !stream.has(Error::CovarianceNotRotated) {
                rotate6(&mut covariance, &ahead, &Rotation3::identity());
            }
            let there = self.description.place.of_enu(exact.translation.vector);
            let datum_from_enu = datum.earth_from_enu().inverse() * self.description.place.earth_from_enu();
            let mut row = PoseRow::new(*t_s, exact, &covariance);
            row.change_world(&datum_from_enu);
            row.position = datum.enu(there).into();
            let of_enu = row.covariance;
            row.change_world(&stream.world_from_enu.rotation.to_rotation_matrix());
            row.shift(stream.world_from_enu.translation.vector);
            for error in &stream.errors {
                match error {
                    Error::CovarianceOfEnu => row.covariance = of_enu,
                    Error::CovarianceNotRotated => {}
                    _ => row.apply(*error, datum, there),
                }
            }
            row
        };
        stream.times_s.iter().map(row).collect()
    }

    /// `map_from_odom`: what carries odometry to where a filter believes the vehicle to be, whose errors wander. Where
    /// odometry knows no roll and pitch, the filter doesn't either.
    pub fn map_odom_rows(&self, stream: &Stream) -> Vec<PoseRow> {
        let noise = if self.description.gnss == Gnss::Perfect {
            0.0
        } else {
            stream.noise
        };
        let random = &mut self.random(&stream.name);
        let mut wander = |deviation| Wander::new(random, deviation * noise, 20.0, self.known_s());
        let (moved, turned) = (wander(FILTERED.0), wander(FILTERED.1));
        let exact = Stream {
            noise: 0.0,
            errors: Vec::new(),
            ..stream.clone()
        };
        let mut rows = self.pose_rows(&exact);
        for row in &mut rows {
            let then_s = row.t_s - stream.late_s;
            let (odom_from_base, ..) = self.odometry(then_s);
            let mut base = row.isometry();
            if self.planar() {
                let level = turn(self.moment(then_s).yaw);
                base.rotation = stream.world_from_enu.rotation * level;
            }
            base.rotation = UnitQuaternion::from_scaled_axis(turned.at(then_s)) * base.rotation;
            base.translation.vector += moved.at(then_s);
            *row = PoseRow::new(row.t_s, base * odom_from_base.inverse(), &row.covariance);
            for error in &stream.errors {
                if !apply_position(row, *error) && !errors::apply(row, *error) {
                    errors::refuse("map_odom", *error);
                }
            }
        }
        rows
    }

    /// `earth_from_map`.
    pub fn earth_rows(&self, stream: &Stream) -> Vec<PoseRow> {
        let datum = stream.datum.unwrap_or(self.description.place);
        let turned = earth_from_enu(datum, &stream.errors);
        let earth_from_enu = Isometry3::from_parts(Translation3::from(datum.ecef()), turned.into());
        let earth_from_map = earth_from_enu * stream.world_from_enu.inverse();
        let row = |t_s: &f64| PoseRow::new(*t_s, earth_from_map, &[0.0; 36]);
        stream.times_s.iter().map(row).collect()
    }
}

/// `earth_from_enu` at a place, with errors.
pub fn earth_from_enu(datum: Place, errors: &[Error]) -> Rotation3<f64> {
    let (latitude, longitude) = (datum.latitude.to_radians(), datum.longitude.to_radians());
    let mut turned = datum.earth_from_enu();
    for error in errors {
        turned = match error {
            Error::Transposed => turned.inverse(),
            Error::NedRows => turned * ned_from_enu(),
            Error::SphericalLatitude => {
                let across = datum.ecef().xy().norm();
                let latitude = (datum.ecef().z / across).atan().to_degrees();
                Place { latitude, ..datum }.earth_from_enu()
            }
            Error::ActiveRotations => {
                let about = |axis, angle| Rotation3::from_axis_angle(&axis, angle);
                let quarter = std::f64::consts::FRAC_PI_2;
                let tilt = about(Vector3::x_axis(), quarter - latitude);
                (tilt * about(Vector3::z_axis(), quarter + longitude)).inverse()
            }
            Error::LatLonSwapped => Place {
                latitude: datum.longitude,
                longitude: datum.latitude,
                ..datum
            }
            .earth_from_enu(),
            _ => errors::refuse("earth", *error),
        };
    }
    turned
}

/// Applies an error of positions, or of whole poses; false where it is none.
pub fn apply_position(row: &mut PoseRow, error: Error) -> bool {
    if error == Error::Inverse {
        let inverse = row.isometry().inverse();
        (row.position, row.orientation) = (inverse.translation.vector.into(), slots(inverse.rotation));
        return true;
    }
    let [x, y, z] = row.position;
    row.position = match error {
        Error::XNegated => [-x, y, z],
        Error::YNegated => [x, -y, z],
        Error::ZNegated => [x, y, -z],
        Error::SwapXy => [y, x, z],
        Error::Scaled => row.position.map(|at| 1.25 * at),
        _ => return false,
    };
    true
}

impl PoseRow {
    /// A pose.
    pub fn new(t_s: f64, pose: Isometry3<f64>, covariance: &[f64; 36]) -> Self {
        Self {
            t_s,
            position: pose.translation.vector.into(),
            orientation: slots(pose.rotation),
            covariance: *covariance,
        }
    }

    /// `world_from_body`, as published.
    pub fn isometry(&self) -> Isometry3<f64> {
        Isometry3::from_parts(Translation3::from(self.position), rotation(self.orientation))
    }

    /// Moves it.
    pub fn shift(&mut self, by: Vector3<f64>) {
        self.position = (Vector3::from(self.position) + by).into();
    }

    fn apply(&mut self, error: Error, datum: Place, there: Place) {
        let grid = |place: Place| place.utm(datum.utm_meridian());
        match error {
            Error::Utm | Error::UtmGrid => {
                let (east, north) = grid(there);
                let (origin_east, origin_north) = if error == Error::Utm { (0.0, 0.0) } else { grid(datum) };
                let up = if error == Error::Utm {
                    there.altitude
                } else {
                    there.altitude - datum.altitude
                };
                self.position = [east - origin_east, north - origin_north, up];
                // Where the east of ENU points in the grid.
                let aside = |metres: f64| grid(datum.of_enu(datum.enu(there) + Vector3::x() * metres));
                let ((e0, n0), (e1, n1)) = (aside(-50.0), aside(50.0));
                self.orientation = slots(turn((n1 - n0).atan2(e1 - e0)) * rotation(self.orientation));
            }
            Error::LatLonDegrees => self.position = [there.latitude, there.longitude, there.altitude],
            Error::AltitudeAsZ => self.position[2] = there.altitude - datum.altitude,
            Error::Ecef => {
                self.change_world(&datum.earth_from_enu());
                self.position = there.ecef().into();
            }
            _ if apply_position(self, error) || errors::apply(self, error) => {}
            _ if covariance::apply6(&mut self.covariance, error) => {}
            _ => errors::refuse("pose", error),
        }
    }
}

impl OrientedRow for PoseRow {
    fn orientation(&mut self) -> &mut [f64; 4] {
        &mut self.orientation
    }

    fn change_world(&mut self, new_from_old: &Rotation3<f64>) {
        self.position = (new_from_old * Vector3::from(self.position)).into();
        self.orientation = slots(new_from_old * rotation(self.orientation));
        rotate6(&mut self.covariance, new_from_old, new_from_old);
    }

    fn change_body(&mut self, old_from_new: &Rotation3<f64>) {
        self.orientation = slots(rotation(self.orientation) * old_from_new);
    }

    fn mirror(&mut self) {
        self.position[1] = -self.position[1];
        self.orientation = mirrored(self.orientation);
    }
}
