//! What an error is: what it does to evidence, what names it, and the rules that see it wherever they judge.

use frames_lint::verdict::{Finding, Row};
use frames_lint::world::World;
use frames_lint::world::content::{ContentEvidence, CovarianceAt};
use frames_lint::world::motion::{FixRow, InertialRow, PoseRow, Series, Twist};
use nalgebra::Vector3;

use crate::cameras;
use crate::places;
use crate::stages::Stage;
use crate::streams::{Kind, Stream, StreamPlace};
use crate::support::drive::rows::{FixRow as Fix, ImuRow, OdometryRow, PoseRow as Pose};
pub use crate::table::all;

/// Standard gravity, m/s².
pub const GRAVITY: f64 = 9.806_65;

/// What an error changes.
#[derive(Clone, Copy)]
pub enum Change {
    /// Inertial rows, where the messages have what it changes.
    Imu(Requirement, fn(&mut ImuRow)),
    /// Poses and their twists.
    Poses(Requirement, fn(&mut OdometryRow)),
    /// Poses that are known from the fixes of the recording.
    Places(fn(places::Place, &places::Place) -> [f64; 3]),
    /// Fixes.
    Fixes(fn(&mut Fix)),
    /// Where an optical frame sits in its parent.
    Frames(fn(nalgebra::Isometry3<f64>) -> nalgebra::Isometry3<f64>),
    /// Stamps of inertial messages, seconds.
    Stamps(f64),
    /// What is staged beside the evidence.
    Staged(&'static Stage, fn(&mut World, &Stream)),
}

/// What a stream must have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Requirement {
    Nothing,
    Orientation,
    Gyro,
    /// Gravity in the acceleration.
    Gravity,
    /// A frame that moves, of which the pose is.
    Child,
    Twist,
    /// A velocity to the side.
    Aside,
    Covariance,
    TwistCovariance,
}

/// An error.
pub struct Error {
    pub name: &'static str,
    pub change: Change,
    /// Words of relations that name it.
    pub words: &'static [&'static str],
    /// Texts of messages that name it.
    pub texts: &'static [&'static str],
    /// The rules that must see it where they judge the stream.
    pub seen_by: &'static [&'static str],
}

impl Error {
    /// Whether a finding names it, alone or among those that it says fit as well.
    pub fn is_named_by(&self, finding: &Finding) -> bool {
        let relation = finding.relation.as_deref();
        relation.is_some_and(|word| self.words.contains(&word))
            || self.texts.iter().any(|text| finding.text().contains(text))
    }

    /// Whether a finding shows it and names nothing else.
    pub fn is_shown_by(&self, finding: &Finding) -> bool {
        let names = finding.relation.as_deref().is_some_and(|word| word != "clockwise-yaw");
        let is_seen = self.seen_by.iter().any(|seen| seen.starts_with(finding.rule.as_str()));
        // A base that is tilted shows in the tree, too.
        (is_seen || finding.rule == "TREE13") && !names && !finding.text().contains("Causes that fit all")
    }

    /// Whether a row is of a rule that must see it.
    pub fn is_seen_in(&self, row: &Row) -> bool {
        self.seen_by.iter().any(|seen| {
            let (code, subject) = seen.split_once(' ').unwrap_or((seen, ""));
            row.rule == code && (row.subject == "platform" || row.subject.starts_with(subject))
        })
    }

    /// The kind of stream that it is put into.
    pub fn kind(&self) -> Kind {
        match self.change {
            Change::Imu(..) | Change::Stamps(_) => Kind::Imu,
            Change::Poses(..) | Change::Places(_) => Kind::Poses,
            Change::Fixes(_) => Kind::Fixes,
            Change::Frames(_) => Kind::Camera,
            Change::Staged(stage, _) => stage.kind,
        }
    }

    /// What has to be staged for it.
    pub fn stage(&self) -> Option<&'static Stage> {
        match self.change {
            Change::Staged(stage, _) => Some(stage),
            _ => None,
        }
    }

    /// Puts the error into a stream, after its stage; false where it cannot have it.
    pub fn inject(&self, world: &mut World, stream: &Stream) -> bool {
        match (self.change, stream.kind) {
            (Change::Imu(needs, change), Kind::Imu) => {
                has(world, stream, needs) && {
                    as_imu_rows(world, Some(stream), change);
                    true
                }
            }
            (Change::Staged(stage, change), kind) => {
                stage.kind == kind && {
                    change(world, stream);
                    true
                }
            }
            (Change::Frames(change), Kind::Camera) => {
                cameras::turn(world, stream, change);
                true
            }
            (Change::Stamps(seconds), Kind::Imu) => places::restamp(world, stream, seconds),
            (Change::Poses(needs, change), Kind::Poses) => {
                has(world, stream, needs) && {
                    as_odometry_rows(world, stream, change);
                    true
                }
            }
            (Change::Places(change), Kind::Poses) => places::put(world, stream, change),
            // Above the ellipsoid by definition is the altitude of NavSatFix alone.
            (Change::Fixes(_), Kind::Fixes) if self.name == "MSL altitude" && !stream.is_standard => false,
            (Change::Fixes(change), Kind::Fixes) => {
                stream.contents(world, |content| change_fixes(content, change));
                true
            }
            _ => false,
        }
    }
}

/// Whether a stream has what an error changes.
pub fn has(world: &World, stream: &Stream, needs: Requirement) -> bool {
    let mut found = needs == Requirement::Nothing;
    let differ = |mut values: Box<dyn Iterator<Item = [f64; 4]> + '_>| {
        let Some(first) = values.next() else { return false };
        values.any(|value| value != first)
    };
    let moves = |value: [f64; 3]| value.iter().any(|value| value.is_finite() && *value != 0.0);
    let mut world = world.clone();
    let edges = edges(&mut world, stream).into_iter().any(|_| true);
    found |= edges && needs == Requirement::Orientation;
    found |= needs == Requirement::Child && stream.is_of_base;
    stream.contents(&mut world, |content| {
        let inertial = || content.motion.inertial.iter().flat_map(Series::rows);
        let poses = || content.motion.poses.iter().flat_map(Series::rows);
        let covers = |field: &str| {
            content
                .covariances
                .get(field)
                .is_some_and(|one| one.all_zero < one.count && one.minus_one < one.count)
        };
        found |= match needs {
            Requirement::Nothing => true,
            Requirement::Orientation => differ(Box::new(
                inertial()
                    .map(|row| row.orientation)
                    .chain(poses().map(|row| row.orientation)),
            )),
            Requirement::Gyro => inertial().any(|row| moves(row.angular_velocity)),
            Requirement::Gravity => {
                let mut lengths: Vec<f64> = inertial()
                    .map(|row| Vector3::from(row.linear_acceleration).norm())
                    .collect();
                lengths.sort_by(f64::total_cmp);
                lengths
                    .get(lengths.len() / 2)
                    .is_some_and(|length| (length / GRAVITY - 1.0).abs() < 0.12)
            }
            Requirement::Child => false,
            Requirement::Aside => {
                let sum = |axis: usize| {
                    poses()
                        .filter_map(|row| Some(row.twist?.linear[axis].powi(2)))
                        .sum::<f64>()
                };
                sum(1) > 0.0 && sum(1) >= 0.03_f64.powi(2) * (sum(0) + sum(1))
            }
            Requirement::Twist => poses().any(|row| {
                row.twist
                    .is_some_and(|twist| moves(twist.linear) || moves(twist.angular))
            }),
            Requirement::Covariance => covers("orientation_covariance") || covers("pose.covariance"),
            Requirement::TwistCovariance => covers("twist.covariance"),
        };
    });
    found
}

/// Changes inertial rows, and what else says the same: of one stream, or of all.
pub fn as_imu_rows(world: &mut World, stream: Option<&Stream>, change: impl Fn(&mut ImuRow)) {
    let all: Vec<Stream> = match stream {
        Some(stream) => vec![stream.clone()],
        None => Stream::all(world)
            .into_iter()
            .filter(|stream| stream.kind == Kind::Imu)
            .collect(),
    };
    for stream in all {
        stream.contents(world, |content| {
            let mut scale = 1.0;
            for row in content
                .motion
                .inertial
                .iter_mut()
                .flat_map(|series| series.stretches.iter_mut().flatten())
            {
                let mut told = imu_row(row);
                let length = |gyro: [f64; 3]| Vector3::from(gyro).norm();
                let before = length(told.gyro);
                change(&mut told);
                if before > 0.0 {
                    scale = length(told.gyro) / before;
                }
                // Where there is no orientation, none appears.
                if row.orientation.iter().any(|value| *value != 0.0) {
                    row.orientation = told.orientation;
                }
                (row.angular_velocity, row.linear_acceleration) = (told.gyro, told.acceleration);
            }
            if let Some(imu) = &mut content.imu {
                imu.angular_velocity_rms *= scale;
                imu.turned_rad *= scale;
            }
            let fields = [
                "orientation_covariance",
                "angular_velocity_covariance",
                "linear_acceleration_covariance",
            ];
            for (number, field) in fields.into_iter().enumerate() {
                each_covariance(content, field, |sample| {
                    let Ok(values) = <[f64; 9]>::try_from(sample.values.as_slice()) else {
                        return;
                    };
                    if values[0] < 0.0 {
                        return;
                    }
                    let mut told = ImuRow {
                        t_s: 0.0,
                        orientation: [0.0, 0.0, 0.0, 1.0],
                        orientation_covariance: values,
                        gyro: [0.0; 3],
                        gyro_covariance: values,
                        acceleration: [0.0; 3],
                        acceleration_covariance: values,
                    };
                    change(&mut told);
                    sample.values = [
                        told.orientation_covariance,
                        told.gyro_covariance,
                        told.acceleration_covariance,
                    ][number]
                        .to_vec();
                });
            }
        });
    }
}

fn imu_row(row: &InertialRow) -> ImuRow {
    ImuRow {
        t_s: 0.0,
        orientation: row.orientation,
        orientation_covariance: [0.0; 9],
        gyro: row.angular_velocity,
        gyro_covariance: [0.0; 9],
        acceleration: row.linear_acceleration,
        acceleration_covariance: [0.0; 9],
    }
}

/// Changes poses of topics and of TF, and what else says the same.
pub fn as_odometry_rows(world: &mut World, stream: &Stream, change: fn(&mut OdometryRow)) {
    let row_of = |row: &PoseRow, pose: [f64; 36], twist: [f64; 36]| {
        let velocity = row.twist.unwrap_or(Twist {
            linear: [0.0; 3],
            angular: [0.0; 3],
        });
        let mut told = OdometryRow {
            pose: Pose {
                t_s: 0.0,
                position: row.position,
                orientation: row.orientation,
                covariance: pose,
            },
            linear: velocity.linear,
            angular: velocity.angular,
            twist_covariance: twist,
        };
        change(&mut told);
        told
    };
    let changed = |row: &mut PoseRow| {
        let told = row_of(row, [0.0; 36], [0.0; 36]);
        (row.position, row.orientation) = (told.pose.position, told.pose.orientation);
        row.twist = row.twist.map(|_| Twist {
            linear: told.linear,
            angular: told.angular,
        });
    };
    stream.contents(world, |content| {
        let before: Vec<PoseRow> = content.motion.poses.iter().flat_map(Series::rows).copied().collect();
        for (number, field) in ["pose.covariance", "twist.covariance"].into_iter().enumerate() {
            each_covariance(content, field, |sample| {
                let Ok(values) = <[f64; 36]>::try_from(sample.values.as_slice()) else {
                    return;
                };
                let near = before.iter().min_by_key(|row| row.log_ns.abs_diff(sample.at.log_ns));
                let Some(near) = near else { return };
                let told = row_of(near, values, values);
                sample.values = [told.pose.covariance, told.twist_covariance][number].to_vec();
            });
        }
        content
            .motion
            .poses
            .iter_mut()
            .flat_map(|series| series.stretches.iter_mut().flatten())
            .for_each(changed);
        for at in content.odometry.iter_mut().flat_map(|odometry| &mut odometry.samples) {
            places::as_row(&mut at.pose, changed);
        }
    });
    for edge in edges(world, stream) {
        edge.motion
            .iter_mut()
            .flat_map(|series| series.stretches.iter_mut().flatten())
            .for_each(changed);
        for at in &mut edge.samples {
            places::as_row(&mut at.pose, changed);
        }
        if let Some((at, ..)) = &mut edge.extreme {
            places::as_row(&mut at.pose, changed);
        }
    }
}

/// The edges of TF that a stream stands in.
pub fn edges<'w>(world: &'w mut World, stream: &Stream) -> Vec<&'w mut frames_lint::world::bag::TfEdge> {
    let is_meant = |edge: &&mut frames_lint::world::bag::TfEdge| {
        let at = StreamPlace::Edge(
            edge.parent.canonical().as_str().to_owned(),
            edge.child.canonical().as_str().to_owned(),
            edge.topic.clone(),
        );
        stream.at.contains(&at)
    };
    world.bags[stream.bag].tf.iter_mut().filter(is_meant).collect()
}

pub fn each_covariance(content: &mut ContentEvidence, field: &str, mut change: impl FnMut(&mut CovarianceAt)) {
    let Some(covariances) = content.covariances.get_mut(field) else {
        return;
    };
    let worst = [&mut covariances.most_asymmetric, &mut covariances.least_positive];
    let worst = worst.into_iter().flatten().map(|(_, sample)| sample);
    covariances.samples.iter_mut().chain(worst).for_each(&mut change);
}

fn change_fixes(content: &mut ContentEvidence, change: fn(&mut Fix)) {
    let told = |latitude: f64, longitude: f64, altitude: f64| {
        let mut row = Fix {
            t_s: 0.0,
            latitude,
            longitude,
            altitude,
            status: 0,
            covariance: [0.0; 9],
        };
        change(&mut row);
        row
    };
    for row in content
        .motion
        .fixes
        .iter_mut()
        .flat_map(|series| series.stretches.iter_mut().flatten())
    {
        let row: &mut FixRow = row;
        let new = told(row.latitude_deg, row.longitude_deg, row.altitude_m);
        (row.latitude_deg, row.longitude_deg, row.altitude_m) = (new.latitude, new.longitude, new.altitude);
    }
    let Some(fixes) = &mut content.fixes else { return };
    for fix in &mut fixes.samples {
        let new = told(fix.latitude_deg, fix.longitude_deg, fix.altitude_m);
        (fix.latitude_deg, fix.longitude_deg, fix.altitude_m) = (new.latitude, new.longitude, new.altitude);
    }
    let is_out = |fix: &&frames_lint::world::content::FixAt| {
        fix.status >= 0 && (fix.latitude_deg.abs() > 90.0 || fix.longitude_deg.abs() > 180.0)
    };
    let out: Vec<_> = fixes.samples.iter().filter(is_out).cloned().collect();
    if !out.is_empty() {
        let share = out.len() as f64 / fixes.samples.len() as f64;
        let count = (share * (fixes.count - fixes.no_fix) as f64).round() as u64;
        fixes.out_of_range = (count, out.into_iter().take(8).collect());
    }
}
