//! The drives of the tests are what they claim to be: their motion fits together, their noise has its size, and the same
//! seed gives the same recording.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::indexing_slicing,
    clippy::panic,
    clippy::float_cmp
)]

use crate::support;
use crate::support::drive::description::{Gnss, Grade, Motion, Vehicle, Wheels};
use crate::support::drive::errors::{frd_from_flu, ned_from_enu, rotation, turn};
use crate::support::drive::lidar::{Beams, Ray, Scanner};
use crate::support::drive::nmea::Kind;
use crate::support::drive::scene::Surroundings;
use crate::support::drive::{Description, Drive, Error, Place, Stream};
use nalgebra::{Isometry3, Matrix6, Rotation3, Translation3, UnitQuaternion, Vector3};

const VEHICLES: [Vehicle; 4] = [Vehicle::Car, Vehicle::Walker, Vehicle::Drone, Vehicle::Robot];
const MOTIONS: [Motion; 5] = [
    Motion::Turning,
    Motion::Straight,
    Motion::Still,
    Motion::Circles,
    Motion::OutAndBack,
];

fn perfect(vehicle: Vehicle, motion: Motion, seed: u64) -> Drive {
    Drive::new(Description {
        vehicle,
        motion,
        seed,
        imu: Grade::Perfect,
        gnss: Gnss::Perfect,
        odometry: Wheels::Perfect,
        ..Description::default()
    })
}

/// Every vehicle in every motion.
fn everything() -> impl Iterator<Item = Drive> {
    VEHICLES.into_iter().flat_map(|vehicle| {
        MOTIONS.map(|motion| {
            let long = perfect(vehicle, motion, 3).description;
            Drive::new(Description {
                duration_s: 15.0,
                ..long
            })
        })
    })
}

fn deviation(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
}

#[test]
fn velocity_is_the_derivative_of_position_and_acceleration_that_of_velocity() {
    let h = 1e-3;
    for drive in everything() {
        for t_s in [-20.03, 0.01, 0.72, 7.31, 9.99, 14.97, 31.2] {
            let (before, now, after) = (drive.at(t_s - h), drive.at(t_s), drive.at(t_s + h));
            let velocity = (after.position - before.position) / (2.0 * h);
            let acceleration = (after.velocity - before.velocity) / (2.0 * h);
            let wrong = (velocity - now.velocity).norm();
            assert!(wrong < 1e-4, "{:?} at {t_s}: {wrong} m/s", drive.description);
            let wrong = (acceleration - now.acceleration).norm();
            assert!(wrong < 1e-3, "{:?} at {t_s}: {wrong} m/s²", drive.description);
        }
    }
}

#[test]
fn the_gyro_integrates_to_the_attitude() {
    for drive in everything() {
        let rows = drive.imu_rows(&Stream::new("/imu", drive.times(200.0)));
        let mut attitude = rotation(rows[0].orientation);
        for pair in rows.windows(2) {
            let half = (Vector3::from(pair[0].gyro) + Vector3::from(pair[1].gyro)) * 0.5;
            attitude *= UnitQuaternion::from_scaled_axis(half * (pair[1].t_s - pair[0].t_s));
        }
        let wrong = attitude.angle_to(&rotation(rows.last().unwrap().orientation));
        assert!(wrong < 1e-3, "{:?}: {wrong} rad in the end", drive.description);
    }
}

#[test]
fn specific_force_integrates_to_the_velocity_and_is_up_at_rest() {
    for drive in everything() {
        let gravity = drive.description.place.gravity();
        let rows = drive.imu_rows(&Stream::new("/imu", drive.times(200.0)));
        let mut velocity = drive.at(0.0).velocity;
        let up = Vector3::z() * gravity;
        let felt =
            |row: &support::drive::rows::ImuRow| rotation(row.orientation) * Vector3::from(row.acceleration) - up;
        for pair in rows.windows(2) {
            velocity += (felt(&pair[0]) + felt(&pair[1])) * (0.5 * (pair[1].t_s - pair[0].t_s));
        }
        let wrong = (velocity - drive.at(rows.last().unwrap().t_s).velocity).norm();
        assert!(wrong < 1e-2, "{:?}: {wrong} m/s in the end", drive.description);
        if drive.description.motion == Motion::Still {
            let force = rotation(rows[0].orientation) * Vector3::from(rows[0].acceleration);
            assert!((force - up).norm() < 1e-9 && (9.80..9.82).contains(&gravity), "{force}");
        }
    }
}

#[test]
fn a_lever_arm_feels_what_its_own_path_says() {
    let drive = perfect(Vehicle::Drone, Motion::Turning, 5);
    let (arm, h, t_s) = (Vector3::new(1.0, -0.5, 2.0), 1e-3, 12.34);
    let place = |t_s: f64| {
        let state = drive.at(t_s);
        state.position + state.orientation * arm
    };
    let acceleration = (place(t_s + h) - place(t_s) * 2.0 + place(t_s - h)) / (h * h);
    let state = drive.at(t_s);
    let up = Vector3::z() * drive.description.place.gravity();
    let wanted = state.orientation.inverse() * (acceleration + up);
    let wrong = (drive.specific_force(&state, arm) - wanted).norm();
    assert!(wrong < 1e-3, "{wrong} m/s²");
}

#[test]
fn vehicles_move_as_they_can() {
    for seed in 0..20 {
        let car = perfect(Vehicle::Car, Motion::Turning, seed);
        for t_s in car.times(2.0) {
            let state = car.at(t_s);
            let body = state.orientation.inverse() * state.velocity;
            assert!(
                (-1e-9..8.0 + 1e-9).contains(&body.x) && body.yz().norm() < 1e-9,
                "{body}"
            );
            assert!(state.yaw_rate.abs() <= 8.0 / 5.0, "{}", state.yaw_rate);
        }
        let drone = perfect(Vehicle::Drone, Motion::Turning, seed);
        let leans = drone.times(2.0).into_iter().map(|t_s| {
            let state = drone.at(t_s);
            let force = drone.specific_force(&state, Vector3::zeros());
            // Only drag pushes a drone sideways in its own axes.
            force.xy().norm() / state.velocity.norm().max(1.0)
        });
        assert!(leans.fold(0.0, f64::max) < 0.11, "seed {seed}");
        let there = perfect(Vehicle::Robot, Motion::OutAndBack, seed);
        let turned = (there.at(59.0).yaw - there.at(1.0).yaw).to_degrees();
        assert!((turned - 180.0).abs() < 25.0, "{turned}");
        let still = perfect(Vehicle::Walker, Motion::Still, seed);
        assert!(still.at(1.0).orientation.angle_to(&still.at(50.0).orientation) < 1e-12);
    }
}

#[test]
fn a_car_turns_and_hurries_as_much_as_it_is_said_to() {
    let (mut rates, mut speeds, mut tilts, mut straight) = (vec![], vec![], vec![], vec![]);
    for seed in 0..40 {
        let drive = perfect(Vehicle::Car, Motion::Turning, seed);
        let ahead = perfect(Vehicle::Car, Motion::Straight, seed);
        for t_s in drive.times(2.0) {
            let state = drive.at(t_s);
            rates.push(state.yaw_rate);
            speeds.push(state.velocity.norm());
            tilts.push(state.orientation.euler_angles().0.to_degrees());
            straight.push(ahead.at(t_s).yaw_rate);
        }
    }
    // Standing cars don't turn, and the curves are smoother than the noise that they follow: a little below 0.12.
    assert!((0.10..0.13).contains(&deviation(&rates)), "{}", deviation(&rates));
    assert!((1.6..2.1).contains(&deviation(&speeds)), "{}", deviation(&speeds));
    assert!((1.7..2.1).contains(&deviation(&tilts)), "{}", deviation(&tilts));
    assert!(
        (0.008..0.011).contains(&deviation(&straight)),
        "{}",
        deviation(&straight)
    );
}

#[test]
fn fixes_return_to_enu() {
    for (latitude, longitude) in [(48.0, 11.0), (-33.9, 151.2), (69.6, 18.9), (0.0, -179.999)] {
        let place = Place {
            latitude,
            longitude,
            altitude: 120.0,
        };
        let drive = Drive::new(Description {
            gnss: Gnss::Perfect,
            place,
            ..Description::default()
        });
        let arm = Vector3::new(-0.4, 0.1, 1.5);
        let stream = Stream::new("/fix", drive.times(5.0)).mounted(Translation3::from(arm).into());
        for row in drive.fix_rows(&stream) {
            let there = Place {
                latitude: row.latitude,
                longitude: row.longitude,
                altitude: row.altitude,
            };
            let state = drive.at(row.t_s);
            let wrong = (place.enu(there) - state.position - state.orientation * arm).norm();
            assert!(wrong < 1e-6, "{wrong} m at {place:?}");
        }
    }
}

#[test]
fn the_earth_is_that_of_textbooks() {
    // EPSG guidance note 7-2, geographic to geocentric conversion: 53°48'33.820"N 2°07'46.380"E, 73 m.
    let epsg = Place {
        latitude: 53.0 + 48.0 / 60.0 + 33.820 / 3600.0,
        longitude: 2.0 + 7.0 / 60.0 + 46.380 / 3600.0,
        altitude: 73.0,
    };
    let wanted = Vector3::new(3_771_793.968, 140_253.342, 5_124_304.349);
    assert!((epsg.ecef() - wanted).norm() < 2e-3, "{}", epsg.ecef());
    // Munich's Frauenkirche lies in zone 32; convergence and scale agree with their closed forms.
    let place = Place {
        latitude: 48.138_6,
        longitude: 11.573_3,
        altitude: 0.0,
    };
    assert_eq!(place.utm_meridian(), 9.0);
    let (east, north) = place.utm(9.0);
    // Numbers of PROJ, EPSG:32632 and, in the south, EPSG:32756.
    assert!((east - 691_434.912_2).hypot(north - 5_334_907.914_4) < 1e-3);
    let sydney = Place {
        latitude: -33.9,
        longitude: 151.2,
        altitude: 0.0,
    };
    let (south_east, south_north) = sydney.utm(sydney.utm_meridian());
    assert!((south_east - 333_568.941_1).hypot(south_north - 6_247_473.336_8) < 1e-3);
    let (further, higher) = place.of_enu(Vector3::new(0.0, 100.0, 0.0)).utm(9.0);
    let convergence = -(further - east).atan2(higher - north);
    let wanted = (2.573_3_f64.to_radians().tan() * place.latitude.to_radians().sin()).atan();
    assert!((convergence - wanted).abs() < 1e-6, "{convergence} {wanted}");
    let scale = (further - east).hypot(higher - north) / 100.0;
    let aside = (east - 500_000.0) / 0.9996;
    let wanted = 0.9996 * (1.0 + aside * aside / (2.0 * 6_379_000.0_f64.powi(2)));
    assert!((scale - wanted).abs() < 2e-6, "{scale} {wanted}");
    // On the middle meridian the northing is the meridian's length: a quarter of it is 10 001 965.729 m.
    let pole = Place {
        latitude: 90.0 - 1e-9,
        longitude: 9.0,
        altitude: 0.0,
    };
    assert!((pole.utm(9.0).1 / 0.9996 - 10_001_965.729).abs() < 1e-2);
}

#[test]
fn odometry_fits_its_twist_and_drifts() {
    for vehicle in VEHICLES {
        let mut drive = perfect(vehicle, Motion::Turning, 2);
        for row in drive.odometry_rows(&Stream::new("/odom", drive.times(5.0))) {
            let (start, state) = (drive.at(0.0), drive.at(row.pose.t_s));
            let odom_from_enu = turn(-start.yaw);
            let mut wanted = odom_from_enu * state.position;
            if matches!(vehicle, Vehicle::Car | Vehicle::Robot) {
                wanted.z = 0.0;
            }
            let wrong = (Vector3::from(row.pose.position) - wanted).norm();
            assert!(wrong < 1e-6, "{vehicle:?}: {wrong} m");
        }
        drive = Drive::new(Description {
            odometry: Wheels::Real,
            ..drive.description
        });
        let h = 1e-3;
        let stream = Stream {
            noise: 0.0,
            ..Stream::new("/odom", vec![20.0 - h, 20.0, 20.0 + h])
        };
        let rows = drive.odometry_rows(&stream);
        let velocity = (Vector3::from(rows[2].pose.position) - Vector3::from(rows[0].pose.position)) / (2.0 * h);
        let [before, now, after] = [0, 1, 2].map(|k: usize| rotation(rows[k].pose.orientation));
        assert!((now.inverse() * velocity - Vector3::from(rows[1].linear)).norm() < 1e-4);
        let turned = (before.inverse() * after).scaled_axis() / (2.0 * h);
        assert!((turned - Vector3::from(rows[1].angular)).norm() < 1e-3, "{vehicle:?}");
    }
    let mut share = Vec::new();
    for seed in 0..40 {
        let drive = Drive::new(Description {
            seed,
            ..Description::default()
        });
        let rows = drive.odometry_rows(&Stream::new("/odom", vec![59.5]));
        let wanted = turn(-drive.at(0.0).yaw) * drive.at(59.5).position;
        let path: f64 = drive
            .times(2.0)
            .iter()
            .map(|t_s| drive.at(*t_s).velocity.norm() / 2.0)
            .sum();
        share.push((Vector3::from(rows[0].pose.position) - wanted).xy().norm() / path);
    }
    share.sort_by(f64::total_cmp);
    assert!((0.01..0.06).contains(&share[20]), "drift {} of the path", share[20]);
}

#[test]
fn noise_has_the_stated_size() {
    let described = |seed| Description {
        seed,
        imu: Grade::Mems,
        gnss: Gnss::Single,
        motion: Motion::Still,
        duration_s: 20.0,
        ..Description::default()
    };
    let (mut gyro, mut bias, mut tilt, mut east, mut up, mut speed, mut ahead) =
        (vec![], vec![], vec![], vec![], vec![], vec![], vec![]);
    for seed in 0..120 {
        let drive = Drive::new(described(seed));
        let imu = drive.imu_rows(&Stream::new("/imu", drive.times(20.0)));
        let rates: Vec<f64> = imu.iter().map(|row| row.gyro[0]).collect();
        let state = drive.at(0.0);
        gyro.push(deviation(&rates));
        bias.push(rates.iter().sum::<f64>() / rates.len() as f64);
        for row in imu.iter().step_by(20) {
            let wrong = (rotation(row.orientation) * state.orientation.inverse()).scaled_axis();
            tilt.push(wrong.x.to_degrees());
        }
        for row in drive.fix_rows(&Stream::new("/fix", vec![0.0, 19.0])) {
            let there = Place {
                latitude: row.latitude,
                longitude: row.longitude,
                altitude: row.altitude,
            };
            let enu = drive.description.place.enu(there);
            east.push(enu.x);
            up.push(enu.z);
            assert!((row.covariance[0].sqrt() - 1.5075).abs() < 1e-3);
        }
        for row in drive.velocity_rows(&Stream::new("/fix", vec![0.0, 10.0])) {
            speed.push(row.linear[0]);
        }
        for row in drive.pose_rows(&Stream::new("/pose", vec![0.0, 10.0])) {
            let wrong = turn(-state.yaw) * Vector3::from(row.position);
            ahead.push(wrong.x);
        }
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    assert!((0.0195..0.0205).contains(&mean(&gyro)), "{}", mean(&gyro));
    assert!((0.017..0.023).contains(&deviation(&bias)), "{}", deviation(&bias));
    assert!((0.95..1.05).contains(&deviation(&tilt)), "{}", deviation(&tilt));
    assert!((1.35..1.65).contains(&deviation(&east)), "{}", deviation(&east));
    assert!((2.7..3.3).contains(&deviation(&up)), "{}", deviation(&up));
    assert!((0.135..0.165).contains(&deviation(&speed)), "{}", deviation(&speed));
    assert!((0.09..0.11).contains(&deviation(&ahead)), "{}", deviation(&ahead));
}

#[test]
fn errors_of_an_imu_are_those_of_wrong_drivers() {
    let drive = perfect(Vehicle::Walker, Motion::Turning, 9);
    let one = |errors: &[Error]| {
        let row = drive.imu_rows(&Stream::new("/imu", vec![4.2]).errors(errors)).remove(0);
        (
            rotation(row.orientation),
            Vector3::from(row.gyro),
            Vector3::from(row.acceleration),
            row,
        )
    };
    let (q, gyro, force, right) = one(&[]);
    let (roll, pitch, yaw) = q.euler_angles();
    // Aviation's Euler angles: yaw clockwise from north, pitch up.
    let (ned, ned_gyro, ned_force, _) = one(&[Error::NedFrd]);
    let (ned_roll, ned_pitch, ned_yaw) = ned.euler_angles();
    let turned = ned_yaw + yaw - std::f64::consts::FRAC_PI_2;
    assert!((ned_roll - roll).abs() < 1e-12 && (ned_pitch + pitch).abs() < 1e-12);
    assert!((turned.cos() - 1.0).abs() < 1e-12);
    assert!(ned_force.z < -8.0 && ned_gyro == frd_from_flu() * gyro);
    // What is level and up stays so: the force is up in the world of each.
    let up = |rotation: UnitQuaternion<f64>, force: Vector3<f64>| (rotation * force).normalize();
    assert!((up(ned, ned_force) - ned_from_enu() * up(q, force)).norm() < 1e-12);
    for body in [Error::Inverted, Error::Yaw90, Error::YForward, Error::Backward] {
        let (q2, gyro2, force2, _) = one(&[body]);
        assert!((q2 * force2 - q * force).norm() < 1e-12 && (q2 * gyro2 - q * gyro).norm() < 1e-12);
        assert!(q2.angle_to(&q) > 1.5);
    }
    let (_, _, force2, _) = one(&[Error::YForward]);
    assert!((force2 - Vector3::new(-force.y, force.x, force.z)).norm() < 1e-12);
    assert_eq!(one(&[Error::Conjugate]).0, q.inverse());
    let [x, y, z, w] = right.orientation;
    assert_eq!(one(&[Error::Wxyz]).3.orientation, [w, x, y, z]);
    let heading = one(&[Error::CompassYaw]).0.euler_angles().2;
    let north = one(&[Error::ZeroNorth]).0.euler_angles().2;
    let same = |a: f64, b: f64| ((a - b).cos() - 1.0).abs() < 1e-12;
    assert!(same(heading, std::f64::consts::FRAC_PI_2 - yaw));
    assert!(same(north, yaw - std::f64::consts::FRAC_PI_2));
    let other = Rotation3::from_axis_angle(&Vector3::x_axis(), roll)
        * Rotation3::from_axis_angle(&Vector3::y_axis(), pitch)
        * Rotation3::from_axis_angle(&Vector3::z_axis(), yaw);
    assert!(one(&[Error::EulerXyz]).0.angle_to(&other.into()) < 1e-12);
    assert!((one(&[Error::DegS]).1 - gyro * 57.295_779_513).norm() < 1e-6);
    assert!((one(&[Error::G]).2 * 9.806_65 - force).norm() < 1e-12);
    assert_eq!(one(&[Error::GravitySign]).2, -force);
    let free = one(&[Error::GravityRemoved]).2;
    assert!((q * free - drive.at(4.2).acceleration).norm() < 1e-9);
    // A mirror: yaw and roll change their sign, and so do the rates.
    let (mirrored, mirrored_gyro, ..) = one(&[Error::LeftHanded]);
    let (roll2, pitch2, yaw2) = mirrored.euler_angles();
    assert!(same(roll2, -roll) && same(pitch2, pitch) && same(yaw2, -yaw));
    assert_eq!(mirrored_gyro, Vector3::new(-gyro.x, gyro.y, -gyro.z));
}

#[test]
fn errors_of_odometry_and_fixes_are_those_of_wrong_drivers() {
    let drive = perfect(Vehicle::Walker, Motion::Turning, 11);
    let odometry = |errors: &[Error]| {
        drive
            .odometry_rows(&Stream::new("/odom", vec![31.0]).errors(errors))
            .remove(0)
    };
    let right = odometry(&[]);
    let [x, y, z] = right.pose.position;
    assert_eq!(odometry(&[Error::SwapXy]).pose.position, [y, x, z]);
    assert_eq!(odometry(&[Error::YNegated]).pose.position, [x, -y, z]);
    let ned = odometry(&[Error::NedFrd]);
    assert!((Vector3::from(ned.pose.position) - Vector3::new(y, x, -z)).norm() < 1e-12);
    let world = rotation(right.pose.orientation) * Vector3::from(right.linear);
    assert_eq!(Vector3::from(odometry(&[Error::TwistInWorld]).linear), world);
    let backward = odometry(&[Error::Backward]);
    assert!((backward.linear[0] + right.linear[0]).abs() < 1e-12);
    assert!((backward.linear[2] - right.linear[2]).abs() < 1e-12);

    let fix = |errors: &[Error]| drive.fix_rows(&Stream::new("/fix", vec![5.0]).errors(errors)).remove(0);
    let there = fix(&[]);
    assert_eq!(fix(&[Error::Swapped]).latitude, there.longitude);
    assert_eq!(fix(&[Error::Msl]).altitude, there.altitude - 46.0);
    let late = drive.fix_rows(&Stream::new("/fix", vec![7.0]).late(2.0)).remove(0);
    assert_eq!((late.t_s, late.latitude), (7.0, there.latitude));
}

#[test]
fn covariances_fit_the_noise_they_stand_for() {
    let drive = Drive::new(Description::default());
    let cov = |errors: &[Error]| {
        let row = drive
            .pose_rows(&Stream::new("/pose", vec![8.0]).errors(errors))
            .remove(0);
        Matrix6::from_row_slice(&row.covariance)
    };
    let (right, body) = (cov(&[]), cov(&[Error::CovarianceNotRotated]));
    let ahead = drive.at(8.0).orientation * Vector3::x();
    let ahead = Vector3::new(ahead.x, ahead.y, 0.0).normalize();
    let linear = right.fixed_view::<3, 3>(0, 0).into_owned();
    assert!((linear * ahead - ahead * 0.01).norm() < 1e-12, "{linear}");
    assert!((body[(0, 0)] - 0.01).abs() < 1e-12 && (body[(1, 1)] - 9e-4).abs() < 1e-12);
    let swapped = cov(&[Error::CovarianceRotationFirst]);
    assert_eq!(swapped[(3, 3)], right[(0, 0)]);
    assert_eq!(swapped[(0, 0)], right[(3, 3)]);
    let degrees = cov(&[Error::CovarianceDegrees]);
    assert!((degrees[(5, 5)] / right[(5, 5)] - 3282.8).abs() < 0.1);
    assert!((cov(&[Error::CovarianceNotRotated, Error::CovarianceStd])[(0, 0)] - 0.1).abs() < 1e-12);
    let mut stream = Stream::new("/pose", vec![8.0]);
    stream.world_from_enu = Isometry3::new(Vector3::new(5.0, 0.0, 0.0), Vector3::z() * 0.7);
    let turned = Matrix6::from_row_slice(&drive.pose_rows(&stream)[0].covariance);
    let wanted = turn(0.7).matrix() * linear * turn(0.7).matrix().transpose();
    assert!((turned.fixed_view::<3, 3>(0, 0) - wanted).norm() < 1e-12);
    let kept = drive.pose_rows(&stream.errors(&[Error::CovarianceOfEnu]))[0].covariance;
    assert!((Matrix6::from_row_slice(&kept) - right).norm() < 1e-12);
}

#[test]
fn maps_lie_on_the_earth() {
    let drive = perfect(Vehicle::Car, Motion::Turning, 4);
    let place = drive.description.place;
    let at = |errors: &[Error]| {
        drive
            .pose_rows(&Stream::new("/pose", vec![50.0]).errors(errors))
            .remove(0)
    };
    let right = at(&[]);
    let state = drive.at(50.0);
    assert!((Vector3::from(right.position) - state.position).norm() < 1e-6);
    // In the grid: turned by the convergence, and shrunk by the scale.
    let grid = at(&[Error::UtmGrid]);
    let convergence = (2.0_f64.to_radians().tan() * 48.0_f64.to_radians().sin()).atan();
    let turned = turn(convergence) * state.position.xy().push(0.0);
    let scale = Vector3::from(grid.position).xy().norm() / state.position.xy().norm();
    assert!((Vector3::from(grid.position).xy() - turned.xy() * scale).norm() < 0.01);
    assert!((0.9996..1.0).contains(&scale), "{scale}");
    let about = (rotation(grid.orientation) * rotation(right.orientation).inverse()).scaled_axis();
    assert!((about - Vector3::z() * convergence).norm() < 1e-4, "{about}");
    // The earth edge carries poses to the Earth.
    let earth = drive.earth_rows(&Stream::new("map", vec![0.0])).remove(0);
    let carried = earth.isometry() * nalgebra::Point3::from(state.position);
    assert!((carried.coords - place.of_enu(state.position).ecef()).norm() < 1e-6);
    assert!((carried.coords - Vector3::from(at(&[Error::Ecef]).position)).norm() < 1e-6);
    for (error, least, most) in [
        (Error::Transposed, 30.0, 180.1),
        (Error::NedRows, 179.9, 180.1),
        (Error::SphericalLatitude, 0.18, 0.2),
        (Error::ActiveRotations, 5.0, 180.1),
        (Error::LatLonSwapped, 5.0, 180.1),
    ] {
        let wrong = drive
            .earth_rows(&Stream::new("map", vec![0.0]).errors(&[error]))
            .remove(0);
        let angle = wrong
            .isometry()
            .rotation
            .angle_to(&earth.isometry().rotation)
            .to_degrees();
        assert!((least..most).contains(&angle), "{error:?}: {angle}");
        assert_eq!(wrong.position, earth.position);
    }
    // Another datum: the same place on the Earth.
    let mut stream = Stream::new("/pose", vec![50.0]);
    stream.datum = Some(Place {
        latitude: 48.05,
        ..place
    });
    let far = drive.pose_rows(&stream).remove(0);
    let carried = drive.earth_rows(&stream).remove(0).isometry() * nalgebra::Point3::from(far.position);
    assert!((carried.coords - place.of_enu(state.position).ecef()).norm() < 1e-6);
}

#[test]
fn map_from_odom_closes_the_chain() {
    let drive = Drive::new(Description {
        vehicle: Vehicle::Walker,
        ..Description::default()
    });
    let stream = Stream {
        noise: 0.0,
        ..Stream::new("odom", drive.times(10.0))
    };
    let odometry = drive.odometry_rows(&stream);
    let poses = drive.pose_rows(&stream);
    for ((edge, odometry), pose) in drive.map_odom_rows(&stream).iter().zip(&odometry).zip(&poses) {
        let chain = edge.isometry() * odometry.pose.isometry();
        assert!((chain.translation.vector - pose.isometry().translation.vector).norm() < 1e-9);
        assert!(chain.rotation.angle_to(&pose.isometry().rotation) < 1e-9);
    }
}

#[test]
fn a_filter_holds_the_map_still() {
    for vehicle in VEHICLES {
        let drive = Drive::new(Description {
            vehicle,
            duration_s: 120.0,
            ..Description::default()
        });
        let stream = Stream::new("odom", drive.times(20.0));
        let rows = drive.map_odom_rows(&stream);
        for pair in rows.windows(2) {
            let step = Vector3::from(pair[1].position) - Vector3::from(pair[0].position);
            assert!(step.norm() < 0.3, "{vehicle:?} at {}: {step}", pair[1].t_s);
        }
        for (edge, row) in rows.iter().zip(&drive.odometry_rows(&stream)) {
            let there = (edge.isometry() * row.pose.isometry()).translation.vector;
            assert!((there - drive.at(row.pose.t_s).position).norm() < 0.5, "{vehicle:?}");
        }
    }
}

#[test]
fn one_receiver_has_one_noise() {
    let drive = Drive::new(Description {
        gnss: Gnss::Single,
        ..Description::default()
    });
    let slow = drive.fix_rows(&Stream::new("receiver", vec![3.0, 7.0]));
    let fast = drive.fix_rows(&Stream::new("receiver", drive.times(10.0)));
    let late = drive.fix_rows(&Stream::new("receiver", vec![7.5]).late(0.5));
    assert_eq!(slow[1], fast[70]);
    assert_eq!(slow[1].altitude, late[0].altitude);
    let other = drive.fix_rows(&Stream::new("another", vec![7.0]));
    assert_ne!(slow[1].altitude, other[0].altitude);
}

#[test]
fn sentences_say_the_same_as_fixes() {
    let drive = perfect(Vehicle::Car, Motion::Turning, 1);
    let stream = Stream::new("/nmea", vec![3.0]);
    let lines = drive.sentences(&stream, &[Kind::Gga, Kind::Rmc, Kind::Hdt], 1_700_000_000.0);
    let [gga, rmc, hdt] = &lines[0][..] else {
        panic!("{lines:?}")
    };
    for line in [gga, rmc, hdt] {
        let (text, sum) = line[1..].split_once('*').unwrap();
        let wanted = text.bytes().fold(0, |sum, byte| sum ^ byte);
        assert_eq!(u8::from_str_radix(sum, 16).unwrap(), wanted);
    }
    let fields: Vec<&str> = gga.split(',').collect();
    // 1700000003 s is 2023-11-14 22:13:23 UTC.
    assert_eq!(
        (fields[0], fields[1], fields[3], fields[5]),
        ("$GPGGA", "221323.00", "N", "E")
    );
    let fix = drive.fix_rows(&stream).remove(0);
    let degrees = fields[2][..2].parse::<f64>().unwrap() + fields[2][2..].parse::<f64>().unwrap() / 60.0;
    assert!((degrees - fix.latitude).abs() < 1e-8);
    let height = fields[9].parse::<f64>().unwrap() + fields[11].parse::<f64>().unwrap();
    assert!((height - fix.altitude).abs() < 2e-3);
    let fields: Vec<&str> = rmc.split(',').collect();
    assert_eq!(fields[9], "141123");
    let heading = hdt.split(',').nth(1).unwrap().parse::<f64>().unwrap().to_radians();
    let yaw = drive.at(3.0).yaw;
    assert!(((heading + yaw).sin() - 1.0).abs() < 1e-6);
}

const RECIPE: &str = "
    duration_s: 5
    drive: {vehicle: robot, motion: turning, seed: 12, imu: mems, gnss: single}
    topics:
      - topic: /tf
        rate_hz: 20
        transforms:
          - {parent: odom, child: base_link, from_drive: odometry}
          - {parent: map, child: odom, from_drive: map_odom}
      - topic: /tf_static
        transforms:
          - {parent: base_link, child: imu_link, xyz: [0.2, 0, 0.4], rpy_deg: [0, 0, 90]}
          - {parent: earth, child: map, from_drive: earth, errors: [ned_rows]}
      - {topic: /imu, from_drive: imu, rate_hz: 100, frame_id: imu_link, xyz: [0.2, 0, 0.4], rpy_deg: [0, 0, 90]}
      - {topic: /ned, from_drive: imu, rate_hz: 100, frame_id: imu_link, errors: [ned_frd, g], noise: 0}
      - {topic: /fix, from_drive: fix, rate_hz: 5, frame_id: gps, late_s: 0.2, stamp_offset_s: -0.2}
      - {topic: /vel, from_drive: gnss_velocity, rate_hz: 5, frame_id: gps}
      - {topic: /odom, from_drive: odometry, rate_hz: 20, frame_id: odom, child_frame_id: base_link, errors: [twist_in_world]}
      - {topic: /pose, from_drive: pose, rate_hz: 10, frame_id: map, type: geometry_msgs/msg/PoseWithCovarianceStamped}
      - {topic: /heading, from_drive: heading, rate_hz: 5, frame_id: gps, errors: [compass_yaw]}
      - {topic: /nmea, from_drive: nmea, rate_hz: 1, frame_id: gps, sentences: [GGA, HDT]}
      - {topic: /gps, from_drive: gps_fix, rate_hz: 1, frame_id: gps}
      - {topic: /vectornav, from_drive: ins, rate_hz: 40, frame_id: imu_link}
      - {topic: /gnss, from_drive: custom_gps, rate_hz: 1, frame_id: gps, type: acme_msgs/msg/Gps}
";

#[test]
fn recipes_speak_of_drives() {
    let bytes = support::build(RECIPE);
    assert_eq!(bytes, support::build(RECIPE));
    assert_ne!(bytes, support::build(&RECIPE.replace("seed: 12", "seed: 13")));
    let bag = support::evidence(RECIPE);
    let edge = support::edge(&bag, "odom", "base_link");
    assert_eq!(edge.samples.len(), 100);
    assert!(edge.samples.iter().any(|sample| sample.pose.translation_m[0] != 0.0));
    for (topic, kind, count) in [
        ("/imu", "sensor_msgs/msg/Imu", 500),
        ("/fix", "sensor_msgs/msg/NavSatFix", 25),
        ("/nmea", "nmea_msgs/msg/Sentence", 10),
        ("/vectornav", "vn_driver/msg/Vectornav", 200),
        ("/gnss", "acme_msgs/msg/Gps", 5),
    ] {
        assert_eq!(bag.topics[topic].message_type.as_str(), kind);
        assert_eq!(bag.topics[topic].count, count, "{topic}");
        assert_eq!((bag.topics[topic].malformed, &bag.topics[topic].unread), (0, &None));
    }
}

#[test]
fn streams_refuse_errors_that_they_cannot_have() {
    for wrong in [
        "{topic: /fix, from_drive: fix, errors: [conjugate]}",
        "{topic: /imu, from_drive: imu, errors: [swapped]}",
        "{topic: /imu, from_drive: imu, errors: [no_such_error]}",
        "{topic: /map, from_drive: earth}",
        "{topic: /imu, from_drive: gyroscope}",
    ] {
        let text = format!("drive: {{}}\ntopics: [{wrong}]");
        assert!(std::panic::catch_unwind(|| support::build(&text)).is_err(), "{wrong}");
    }
}

/// A lidar on a drive that stands, and where its sensor is over the ground.
fn scan_of(scanner: &Scanner, surroundings: Surroundings, mount: &Isometry3<f64>) -> Vec<Ray> {
    let drive = Drive::new(Description {
        motion: Motion::Still,
        duration_s: 2.0,
        seed: 4,
        ..Description::default()
    });
    drive.scan(&drive.scene(surroundings), scanner, mount, 0.5)
}

fn exact(scanner: Scanner) -> Scanner {
    Scanner {
        noise_m: 0.0,
        lost: 0.0,
        ..scanner
    }
}

#[test]
fn rays_of_a_lidar_end_on_the_ground_and_sweep_clockwise() {
    let mount = Isometry3::translation(0.4, 0.0, 1.8);
    let rays = scan_of(&exact(Scanner::of(Beams::Vlp16, 16, 360)), Surroundings::Street, &mount);
    assert_eq!(rays.len(), 16 * 360);
    let lowest = |ray: &&Ray| ray.ring == 15;
    let heights = rays.iter().filter(lowest).filter_map(|ray| ray.place);
    let on_ground = heights.filter(|place| (place.z + 1.8).abs() < 1e-9).count();
    assert!(
        on_ground > 180,
        "{on_ground} of 360 rays at -15 degrees end on the ground"
    );
    // Nothing is beneath it.
    assert!(
        rays.iter()
            .filter_map(|ray| ray.place)
            .all(|place| place.z > -1.8 - 1e-9)
    );
    for ray in rays.iter().filter(|ray| ray.place.is_some()) {
        let place = ray.place.unwrap();
        let azimuth = std::f64::consts::PI - std::f64::consts::TAU * f64::from(ray.column) / 360.0;
        let off = (place.y.atan2(place.x) - azimuth).rem_euclid(std::f64::consts::TAU);
        assert!(off.min(std::f64::consts::TAU - off) < 1e-9, "column {}", ray.column);
        assert!((ray.after_s - 0.1 * f64::from(ray.column) / 360.0).abs() < 1e-12);
    }
}

#[test]
fn a_garage_has_its_ceiling_where_it_is() {
    let mount = Isometry3::translation(0.0, 0.0, 1.0);
    let rays = scan_of(&exact(Scanner::spinning(16, 180)), Surroundings::Garage, &mount);
    let highest = rays
        .iter()
        .filter_map(|ray| ray.place)
        .map(|place| place.z)
        .fold(f64::MIN, f64::max);
    assert!((highest - 1.4).abs() < 1e-9, "{highest}");
}

#[test]
fn columns_of_a_destaggered_cloud_are_of_one_direction() {
    let scanner = Scanner::of(Beams::Os1, 16, 512);
    assert_eq!([0, 1, 2, 3].map(|ring| scanner.pixel_shift(ring)), [9, 6, 3, 0]);
    for ring in 0..4 {
        // What is measured in column m looks where column m + shift looks by the encoder, but for half a column and the last beam's.
        let shifted_deg = 360.0 * scanner.pixel_shift(ring) as f64 / 512.0;
        let aside_deg = scanner.aside_deg(ring) - scanner.aside_deg(3);
        assert!((shifted_deg - aside_deg).abs() <= 360.0 / 512.0 / 2.0 + 1e-9);
    }
}

#[test]
fn a_sensor_that_moves_smears_its_scan_as_it_moves() {
    let drive = Drive::new(Description {
        motion: Motion::Straight,
        duration_s: 20.0,
        seed: 4,
        ..Description::default()
    });
    let scene = drive.scene(Surroundings::Street);
    let mount = Isometry3::translation(0.0, 0.0, 1.8);
    let scanner = exact(Scanner::spinning(16, 360));
    // Each point, with the sensor where it was then, is where the scene has it: a ray from there ends there.
    for ray in drive.scan(&scene, &scanner, &mount, 10.0).iter().step_by(37) {
        let Some(place) = ray.place else { continue };
        let at = 10.0 + ray.after_s;
        let state = drive.at(at);
        let turn = state.orientation;
        let from = state.position + turn * mount.translation.vector;
        let normal = turn * Vector3::z();
        let direction = turn * place.normalize();
        let range = scene.range(&from, &direction, (&state.position, &normal), scanner.reach_m);
        assert!((range.unwrap() - place.norm()).abs() < 1e-6);
    }
}
