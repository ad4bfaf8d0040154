//! TIME05: clouds of a scanning lidar whose points have no times.

use crate::analysis::motion::{BagMotion, Motion, Stream};
use crate::analysis::{lidar::Clouds, names};
use crate::rules::prelude::*;
use crate::world::cloud::RING_FIELDS;
use crate::world::motion::{FixRow, PoseRow};

pub(crate) struct PointTimeMissing;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    min_smear_m: f64,
    at_m: f64,
    min_s: f64,
    max_period_s: f64,
}

impl Rule for PointTimeMissing {
    const NEEDS: &'static [Need] = &[Need::Bag];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        Clouds::say_packets(world, "times of the points", out);
        let motion = Motion::of(world);
        for clouds in Clouds::published(world) {
            if let Some(motion) = motion.bags.get(clouds.index) {
                judge_clouds(&clouds, motion, limits, out);
            }
        }
    }
}

fn judge_clouds(clouds: &Clouds, motion: &BagMotion, limits: &Limits, out: &mut Judge) {
    let subject = clouds.subject("times of the points");
    if !clouds.is_of_a_lidar() {
        return out.not_applicable(
            subject,
            "fields, topic and frame do not identify these as raw points of a lidar",
        );
    }
    if clouds.evidence.samples.iter().all(|sample| sample.returns == 0) {
        return out.too_little(subject, "no cloud has a point");
    }
    let most = clouds.timed().max_by_key(|(_, times)| times.distinct);
    if let Some((_, times)) = most.filter(|(_, times)| times.distinct > 2) {
        let seen = Measured::new(
            format!("distinct values of `{}`", times.field),
            f64::from(times.distinct),
            "1",
        );
        return out.pass(subject, [seen]);
    }
    let Some(period_s) = clouds.period_s().filter(|period_s| *period_s <= limits.max_period_s) else {
        let why = format!(
            "the scan period is unknown: the clouds are not stamped at least every {} s",
            limits.max_period_s
        );
        return out.too_little(subject, why);
    };
    let what = match most {
        Some((_, times)) => format!("have one time per scan (`{}`)", times.field),
        None => "have no time field".to_owned(),
    };
    let severity = if most.is_none() && !spins(clouds) {
        Severity::Note
    } else {
        Severity::Error
    };
    let Some(fastest) = PeakMotion::of(motion, limits) else {
        let message = format!(
            "`{}`: the points {what}; a scan of {period_s:.2} s is smeared if the platform moves",
            clouds.topic.topic
        );
        let finding = Finding::new(severity.min(Severity::Warning), subject, message, clouds.place())
            .hint()
            .detail(format!(
                "Nothing in the recording shows how fast the platform moves: the smear is {period_s:.2} m for each m/s. Without the times of \
                 the points, the smear cannot be corrected."
            ));
        let measured = [Measured::new("duration of a scan", period_s, "s")];
        return out.fail(named(finding, clouds, most.is_some()).measured(measured));
    };
    let smear_m = fastest.speed_m_s * period_s + limits.at_m * fastest.rate_rad_s * period_s;
    let measured = [
        Measured::new(format!("smear at {} m", limits.at_m), smear_m, "m").limit(limits.min_smear_m),
        Measured::new("speed of the platform (95th percentile)", fastest.speed_m_s, "m/s"),
        Measured::new(
            "turn rate of the platform (95th percentile)",
            fastest.rate_rad_s.to_degrees(),
            "deg/s",
        ),
        Measured::new("duration of a scan", period_s, "s"),
    ];
    if smear_m < limits.min_smear_m {
        let why =
            format!("the points {what}, but the platform moves too slowly for that to matter (smear {smear_m:.3} m)");
        return out.too_little(subject, why);
    }
    let message = format!(
        "`{}`: the points {what}; motion smears a scan by {smear_m:.2} m at {} m",
        clouds.topic.topic, limits.at_m
    );
    let finding = Finding::new(severity, subject, message, clouds.place())
        .likely()
        .detail("Without the times of the points, the smear cannot be corrected.");
    // A speed or a turn rate of zero is one that nothing shows.
    let shown = measured.into_iter().filter(|one| one.value > 0.0);
    out.fail(named(finding, clouds, most.is_some()).measured(shown));
}

/// Whether the points are known to be measured one after the other: by a driver recognised by its fields, or by the ring number of each point.
fn spins(clouds: &Clouds) -> bool {
    clouds.driver.is_some() || RING_FIELDS.iter().any(|name| clouds.datatype(name).is_some())
}

/// Words of topics, and the field in which that maker's driver publishes the times.
const FIELDS: &[(&str, &str)] = &[
    ("ouster", "Ouster: field `t`"),
    ("velodyne", "Velodyne: field `time`"),
    ("hesai", "Hesai: field `timestamp`"),
    ("robosense", "RoboSense: field `timestamp`, point type XYZIRT"),
    ("rslidar", "RoboSense: field `timestamp`, point type XYZIRT"),
];

fn named(finding: Finding, clouds: &Clouds, is_constant: bool) -> Finding {
    let words = clouds.topic.words();
    let own = FIELDS.iter().find(|(maker, _)| words.iter().any(|word| word == maker));
    let field = own.map_or(
        "Ouster: field `t`, Velodyne: `time`, Hesai and RoboSense: `timestamp`",
        |(_, field)| *field,
    );
    let finding = finding.help(format!(
        "publish the time of each point from the driver ({field}), or record the packets of the lidar"
    ));
    finding.relation(if is_constant { "constant" } else { "missing" })
}

/// How fast the platform moves and turns: 95th percentiles.
struct PeakMotion {
    speed_m_s: f64,
    rate_rad_s: f64,
}

impl PeakMotion {
    /// `None` where nothing shows motion.
    fn of(motion: &BagMotion, limits: &Limits) -> Option<Self> {
        let is_long = |seconds: f64| seconds >= limits.min_s;
        let gyro = motion.imus.iter().filter(|imu| is_long(imu.stream.seconds()));
        let gyro = gyro.map(|imu| high(imu.stream.rows().map(|timed| norm(timed.row.angular_velocity))));
        let poses = motion
            .poses
            .iter()
            .filter(|stream| !names::is_wish(&stream.topic) && is_long(stream.seconds()));
        let tracks = poses
            .map(Stream::<PoseRow>::track)
            .chain(motion.fixes.iter().map(Stream::<FixRow>::track));
        let speeds = tracks.map(|track| {
            let courses = track.courses(0.0);
            high(courses.iter().flatten().map(|course| course.speed_m_s))
        });
        let twists = motion
            .poses
            .iter()
            .filter(|stream| is_long(stream.seconds()))
            .map(turning);
        let (speeds, rates): (Vec<Option<f64>>, Vec<Option<f64>>) = (speeds.collect(), gyro.chain(twists).collect());
        let most = |values: &[Option<f64>]| values.iter().flatten().copied().reduce(f64::max);
        match (most(&speeds), most(&rates)) {
            (None, None) => None,
            (speed, rate) => Some(Self {
                speed_m_s: speed.unwrap_or(0.0),
                rate_rad_s: rate.unwrap_or(0.0),
            }),
        }
    }
}

/// The turn rate by the velocities of poses.
fn turning(stream: &Stream<PoseRow>) -> Option<f64> {
    high(stream.rows().filter_map(|timed| Some(norm(timed.row.twist?.angular))))
}

/// The 95th percentile of the finite values.
fn high(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    values.get((values.len().max(1) - 1) * 95 / 100).copied()
}

fn norm([x, y, z]: [f64; 3]) -> f64 {
    (x * x + y * y + z * z).sqrt()
}
