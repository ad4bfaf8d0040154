//! Lines of the rules on places, covariances and headings: GEO02 to GEO07, COV02, COV04, COV05 and SENSOR08.
//!
//! Their worlds are what a recording of the drive gives, as it is collected: a recipe for each scene, healthy or with one
//! fault. Owns the scenes, and what a finding must say to have named their faults.

use std::sync::Arc;

use frames_lint::world::World;
use nalgebra::{Isometry3, Translation3};

use crate::drives::Kind;
use crate::faults::Fault;
use crate::lines;
use crate::support;
use crate::support::drive::Place;
use crate::support::drive::description::{Gnss, Grade, Motion, Vehicle};
use crate::support::drive::errors::slots;
use crate::table::{ALL, AnswerKey, Table};

/// What is recorded of a drive, and what is wrong with it.
#[derive(Debug)]
pub struct Scene {
    pub name: &'static str,
    pub is_healthy: bool,
    /// Topics of the recipe, in which words that begin with `$` stand for what follows from the seed.
    topics: &'static [&'static str],
    /// What else the topics say: a word of theirs, and its text. Words without one are left out.
    says: &'static [(&'static str, &'static str)],
    /// What names the fault: words of relations, and texts of messages.
    names: (&'static [&'static str], &'static [&'static str]),
    /// The rules that are asked, with their subjects.
    asked: &'static [(&'static str, &'static str)],
}

const EARTH: &str = "{topic: /tf_static, transforms: [{parent: earth, child: map, from_drive: earth$earth}]}";
const EARTH_BELOW: &str = "{topic: /tf_static, transforms: [{parent: map, child: earth, from_drive: earth}]}";
const EARTH_CENTRE: &str = "{topic: /tf_static, transforms: [{parent: map, child: earth, $below}]}";
const ANTENNA: &str = "{topic: /tf_static, transforms: [{parent: base_link, child: gps, xyz: [-0.1, 0, 0.8]}]}";
const MOVES: &str = "{topic: /tf, rate_hz: 10, transforms: [{parent: map, child: base_link, from_drive: pose$moves}]}";
const FIX: &str = "{topic: /fix, from_drive: fix, rate_hz: 5, frame_id: gps, xyz: [-0.1, 0, 0.8], late_s: 0.1, \
                   stamp_offset_s: -0.1$fix}";
const REAR: &str = "{topic: /rear, from_drive: fix, rate_hz: 5, frame_id: gps_2, xyz: [-1, 0, 1.5]$rear}";
const NMEA: &str =
    "{topic: /nmea, from_drive: nmea, rate_hz: 5, frame_id: gps, xyz: [-0.1, 0, 0.8], sentences: [GGA, RMC, HDT]}";
const POSE: &str = "{topic: /pose, type: geometry_msgs/msg/PoseWithCovarianceStamped, from_drive: pose, rate_hz: 10, \
                    frame_id: $frame$pose}";
const SITE: &str = "{topic: /pose_site, type: geometry_msgs/msg/PoseWithCovarianceStamped, from_drive: pose, \
                    rate_hz: 10, frame_id: site_map, noise: 0.1, covariance_scale: 100, \
                    world_from_enu: {xyz: [5, 3, 0], rpy_deg: [0, 0, 60]}$site}";
const OTHER: &str = "{topic: /gps/pose, from_drive: pose, rate_hz: 5, frame_id: map, errors: [utm]}";
const ODOM: &str = "{topic: /odom, from_drive: odometry, rate_hz: 20, frame_id: odom, child_frame_id: base_link$odom}";
const HEADING: &str = "{topic: /heading, from_drive: heading, rate_hz: 5, frame_id: base_link$heading}";
const IMU: &str = "{topic: /imu, from_drive: imu, rate_hz: 50, frame_id: base_link$imu}";
const ORIGIN: &str = "{topic: /map/origin, type: sensor_msgs/msg/NavSatFix, frame_id: map, $origin}";

const ON_EARTH: (&str, &str) = ("GEO02", "TF `earth`");
const KIND: (&str, &str) = ("GEO03", "frame `map`");
const GRID: (&str, &str) = ("GEO04", "topic `/pose`");
const GRID_ON_TF: (&str, &str) = ("GEO04", "TF `map`");
const PLANE: (&str, &str) = ("GEO05", "TF `earth`");
const UNTOLD_PLANE: (&str, &str) = ("GEO05", "topic `/pose`");
const ALTITUDE: (&str, &str) = ("GEO06", "altitude of topic `/fix`");
const MAP_HEIGHT: (&str, &str) = ("GEO06", "height of");
const ORIGINS: (&str, &str) = ("GEO07", "origin");
const ORDER: (&str, &str) = ("COV02", "order of");
const AXES: (&str, &str) = ("COV04", "axes of `pose.covariance`");
const TWIST_AXES: (&str, &str) = ("COV04", "axes of `twist.covariance`");
const PAIR: (&str, &str) = ("COV04", "");
const UNITS: (&str, &str) = ("COV05", "units of");
const HEADING_YAW: (&str, &str) = ("SENSOR08", "yaw of topic `/heading`");
const IMU_YAW: (&str, &str) = ("SENSOR08", "yaw of topic `/imu`");
const POSE_YAW: (&str, &str) = ("SENSOR08", "yaw of topic `/pose`");

type Subjects = &'static [(&'static str, &'static str)];

const fn healthy(name: &'static str, topics: &'static [&'static str], says: Subjects, asked: Subjects) -> Scene {
    Scene {
        name,
        is_healthy: true,
        topics,
        says,
        names: (&[], &[]),
        asked,
    }
}

const fn faulty(
    name: &'static str,
    topics: &'static [&'static str],
    says: Subjects,
    relations: &'static [&'static str],
    asked: Subjects,
) -> Scene {
    Scene {
        name,
        is_healthy: false,
        topics,
        says,
        names: (relations, &[]),
        asked,
    }
}

/// Nothing but their words names two origins, and a compass in an inertial sensor has other names in other rules.
const fn with_texts(scene: &Scene, texts: &'static [&'static str]) -> Scene {
    Scene {
        names: (scene.names.0, texts),
        ..*scene
    }
}

const COMPASS: &[&str] = &["compass-yaw"];
const SEA: &[&str] = &["msl-as-ellipsoidal"];
const TWO_ORIGINS: &[&str] = &["put the origin"];

/// Every scene.
pub const SCENES: &[Scene] = &[
    // Where the local frame is on the Earth.
    healthy(
        "all sound",
        &[EARTH, FIX, REAR, NMEA, POSE, ODOM, HEADING, ORIGIN],
        &[],
        &[
            ON_EARTH,
            KIND,
            GRID,
            ALTITUDE,
            ORIGINS,
            ORDER,
            AXES,
            UNITS,
            HEADING_YAW,
            POSE_YAW,
        ],
    ),
    healthy(
        "map along a street",
        &[EARTH, FIX, NMEA, POSE],
        &[
            ("$earth", ", world_from_enu: $turned"),
            ("$pose", ", world_from_enu: $turned"),
        ],
        &[ON_EARTH, KIND, GRID, ALTITUDE, POSE_YAW],
    ),
    faulty(
        "earth: transposed",
        &[EARTH, FIX],
        &[("$earth", ", errors: [transposed]")],
        &["transposed"],
        &[ON_EARTH],
    ),
    faulty(
        "earth: NED",
        &[EARTH, FIX],
        &[("$earth", ", errors: [ned_rows]")],
        &["ned-enu"],
        &[ON_EARTH],
    ),
    faulty(
        "earth: of a sphere",
        &[EARTH, FIX],
        &[("$earth", ", errors: [spherical_latitude]")],
        &["spherical-latitude"],
        &[ON_EARTH],
    ),
    faulty(
        "earth: of vectors",
        &[EARTH, FIX],
        &[("$earth", ", errors: [active_rotations]")],
        &["active-rotations"],
        &[ON_EARTH],
    ),
    faulty(
        "earth: lat/lon",
        &[EARTH, FIX],
        &[("$earth", ", errors: [lat_lon_swapped]")],
        &["lat-lon-swapped"],
        &[ON_EARTH],
    ),
    faulty(
        "earth: inverse",
        &[EARTH_BELOW, FIX],
        &[],
        &["inverse"],
        &[("GEO02", "TF `map`")],
    ),
    healthy(
        "earth below the map",
        &[EARTH_CENTRE, FIX, POSE],
        &[],
        &[("GEO02", "TF `map`"), KIND],
    ),
    // Kinds of coordinates.
    healthy(
        "in a grid's square",
        &[FIX, POSE],
        &[("$pose", ", world_from_enu: {xyz: [89571.2, 42301.9, 43]}")],
        &[KIND],
    ),
    healthy(
        "utm in utm",
        &[FIX, POSE],
        &[("$frame", "utm"), ("$pose", ", errors: [utm]")],
        &[("GEO03", "frame `utm`"), GRID],
    ),
    faulty("utm", &[FIX, POSE], &[("$pose", ", errors: [utm]")], &["utm"], &[KIND]),
    faulty(
        "ecef",
        &[FIX, POSE],
        &[("$pose", ", errors: [ecef]")],
        &["ecef"],
        &[KIND],
    ),
    faulty(
        "degrees",
        &[FIX, POSE],
        &[("$pose", ", errors: [lat_lon_degrees]")],
        &["degrees"],
        &[KIND],
    ),
    faulty("two kinds", &[FIX, POSE, OTHER], &[], &["mixed-coordinates"], &[KIND]),
    // Grids and planes.
    healthy("east, north on TF", &[ANTENNA, MOVES, FIX], &[], &[GRID_ON_TF]),
    faulty(
        "utm grid on TF",
        &[ANTENNA, MOVES, FIX],
        &[("$moves", ", errors: [utm_grid]")],
        &["utm-grid"],
        &[GRID_ON_TF],
    ),
    faulty(
        "utm grid",
        &[FIX, POSE],
        &[("$pose", ", errors: [utm_grid]")],
        &["utm-grid"],
        &[GRID],
    ),
    healthy(
        "origin 2 km off",
        &[EARTH, FIX, POSE],
        &[("$earth", ", datum: $by2km"), ("$pose", ", datum: $by2km")],
        &[PLANE, ORIGINS],
    ),
    healthy(
        "altitude, no plane",
        &[FIX, POSE],
        &[("$pose", ", datum: $mid, errors: [altitude_as_z]")],
        &[UNTOLD_PLANE],
    ),
    with_texts(
        &faulty(
            "altitude as z",
            &[EARTH, FIX, POSE],
            &[
                ("$earth", ", datum: $near"),
                ("$pose", ", datum: $near, errors: [altitude_as_z]"),
            ],
            &["altitude-as-z"],
            &[PLANE],
        ),
        // Where the heights do not tell, what the plane is there is told.
        &["z may differ from altitude"],
    ),
    faulty(
        "plane, 6 km",
        &[EARTH, FIX, POSE],
        &[("$earth", ", datum: $mid"), ("$pose", ", datum: $mid")],
        &["tangent-plane"],
        &[PLANE],
    ),
    faulty(
        "plane, 15 km",
        &[EARTH, FIX, POSE],
        &[("$earth", ", datum: $far"), ("$pose", ", datum: $far")],
        &["far-from-origin"],
        &[PLANE],
    ),
    faulty(
        "plane, 6 km, no TF",
        &[FIX, POSE],
        &[("$pose", ", datum: $mid")],
        &["tangent-plane"],
        &[UNTOLD_PLANE],
    ),
    // Heights.
    healthy("two receivers", &[FIX, REAR], &[], &[ALTITUDE]),
    faulty(
        "msl, NMEA",
        &[FIX, NMEA],
        &[("$fix", ", errors: [msl]")],
        SEA,
        &[ALTITUDE],
    ),
    faulty(
        "msl, two receivers",
        &[FIX, REAR],
        &[("$fix", ", errors: [msl]")],
        SEA,
        &[ALTITUDE],
    ),
    faulty(
        "msl, map",
        &[EARTH, FIX, POSE],
        &[("$fix", ", errors: [msl]")],
        SEA,
        &[ALTITUDE],
    ),
    faulty(
        "map at msl",
        &[EARTH, FIX, POSE],
        &[("$earth", ", datum: $sunk")],
        SEA,
        &[MAP_HEIGHT],
    ),
    // Origins.
    with_texts(
        &faulty(
            "origin 30 m off",
            &[EARTH, FIX, ORIGIN],
            &[("$origin", "$aside30")],
            &[],
            &[ORIGINS],
        ),
        TWO_ORIGINS,
    ),
    with_texts(
        &faulty(
            "origin 0.3 m off",
            &[EARTH, FIX, ORIGIN],
            &[("$origin", "$aside03")],
            &[],
            &[ORIGINS],
        ),
        TWO_ORIGINS,
    ),
    with_texts(
        &faulty(
            "origin at msl",
            &[EARTH, FIX, ORIGIN],
            &[("$origin", "$sunk_origin")],
            &["geoid"],
            &[ORIGINS],
        ),
        // The least of the undulations, which an error of height may be as well.
        &["put the origin 2.97 m apart"],
    ),
    with_texts(
        &faulty(
            "map 40 m off",
            &[EARTH, FIX, POSE],
            &[("$pose", ", datum: $aside40")],
            &[],
            &[ORIGINS],
        ),
        TWO_ORIGINS,
    ),
    with_texts(
        &faulty(
            "map 40 m off, topic",
            &[FIX, POSE, ORIGIN],
            &[("$pose", ", datum: $aside40")],
            &[],
            &[ORIGINS],
        ),
        TWO_ORIGINS,
    ),
    // Covariances.
    healthy(
        "cov. cautious",
        &[FIX, POSE],
        &[("$pose", ", covariance_scale: 4")],
        &[ORDER, AXES, UNITS],
    ),
    healthy(
        "cov. very cautious",
        &[FIX, POSE],
        &[("$pose", ", covariance_scale: 100")],
        &[ORDER, AXES, UNITS],
    ),
    healthy(
        "cov. too sure",
        &[FIX, POSE],
        &[("$pose", ", covariance_scale: 0.02")],
        &[ORDER, AXES, UNITS],
    ),
    healthy(
        "cov. filtered",
        &[FIX, POSE],
        &[("$pose", ", noise: 0.02, covariance_scale: 2500")],
        &[ORDER, AXES, UNITS],
    ),
    healthy("cov. of velocity", &[FIX, ODOM], &[], &[TWIST_AXES]),
    faulty(
        "rotations first",
        &[FIX, POSE],
        &[("$pose", ", errors: [covariance_rotation_first]")],
        &["rotation-first"],
        &[ORDER],
    ),
    faulty(
        "rot. in deg2",
        &[FIX, POSE],
        &[("$pose", ", errors: [covariance_degrees]")],
        &["degrees"],
        &[UNITS],
    ),
    faulty(
        "pos. in cm2",
        &[FIX, POSE],
        &[("$pose", ", errors: [covariance_centimetres]")],
        &["centimetres"],
        &[UNITS],
    ),
    faulty(
        "pos. in mm2",
        &[FIX, POSE],
        &[("$pose", ", errors: [covariance_millimetres]")],
        &["millimetres"],
        &[UNITS],
    ),
    faulty(
        "deviations",
        &[FIX, POSE],
        &[("$pose", ", errors: [covariance_std]")],
        &["deviations"],
        &[UNITS],
    ),
    faulty(
        "cov. in the body",
        &[FIX, POSE],
        &[("$pose", ", errors: [covariance_not_rotated]")],
        &["not-rotated"],
        &[AXES],
    ),
    faulty(
        "velocity's in world",
        &[FIX, ODOM],
        &[("$odom", ", errors: [twist_covariance_in_world]")],
        &["in-world"],
        &[TWIST_AXES],
    ),
    faulty(
        "cov. of other frame",
        &[FIX, POSE, SITE],
        &[
            ("$pose", ", noise: 0.1, covariance_scale: 100"),
            ("$site", ", errors: [covariance_of_enu]"),
        ],
        &["not-rotated"],
        &[PAIR],
    ),
    healthy(
        "cov. in two frames",
        &[FIX, POSE, SITE],
        &[("$pose", ", noise: 0.1, covariance_scale: 100")],
        &[PAIR],
    ),
    // Headings.
    healthy("heading, track", &[HEADING, FIX], &[], &[HEADING_YAW]),
    healthy("heading of IMU", &[IMU, NMEA], &[], &[IMU_YAW]),
    healthy("heading of poses", &[POSE], &[], &[POSE_YAW]),
    faulty(
        "compass, NMEA",
        &[HEADING, NMEA],
        &[("$heading", ", errors: [compass_yaw]")],
        COMPASS,
        &[HEADING_YAW],
    ),
    faulty(
        "compass, track",
        &[HEADING, FIX],
        &[("$heading", ", errors: [compass_yaw]")],
        COMPASS,
        &[HEADING_YAW],
    ),
    with_texts(
        &faulty(
            "compass, IMU",
            &[IMU, NMEA],
            &[("$imu", ", errors: [compass_yaw]")],
            COMPASS,
            &[IMU_YAW],
        ),
        &["the yaw is a compass heading", "does not follow its gyro about z"],
    ),
    faulty(
        "compass, poses",
        &[POSE],
        &[("$pose", ", errors: [compass_yaw]")],
        COMPASS,
        &[POSE_YAW],
    ),
];

/// Latitude, longitude and the undulation of EGM96 there: the points that NGA publishes for programs to be tested with, but
/// for one on the equator and one on the meridian of Greenwich, where a spherical latitude and axes taken for vectors leave a map
/// level, and Munich.
const PLACES: [(f64, f64, f64); 5] = [
    (48.0, 11.0, 46.0),
    (38.628_155, -90.220_845, -31.628),
    (-14.621_217, -54.978_886, -2.969),
    (46.874_319, 102.448_729, -43.575),
    (-23.617_446, 133.874_712, 15.871),
];

/// The scene of a name.
pub fn scene(name: &str) -> &'static Scene {
    let found = SCENES.iter().find(|scene| scene.name == name);
    found.unwrap_or_else(|| panic!("no scene is called `{name}`"))
}

impl Scene {
    /// Whether a finding names the fault.
    pub fn is_named_by(&self, relation: Option<&str>, message: &str) -> bool {
        let (relations, texts) = self.names;
        relation.is_some_and(|word| relations.contains(&word)) || texts.iter().any(|text| message.contains(text))
    }

    /// The world of a drive.
    pub fn world(&self, kind: Kind, seed: u64) -> World {
        let (source, collected) = support::collected(&support::build(&self.recipe(kind, seed)));
        let mut world = World::default();
        world.sources = Arc::new(vec![Arc::new(source)]);
        world.absorb(collected.facts);
        world
    }

    fn recipe(&self, kind: Kind, seed: u64) -> String {
        let (latitude, longitude, undulation_m) = PLACES[(seed % 5) as usize];
        let place = Place {
            latitude,
            longitude,
            altitude: 200.0,
        };
        let bearing = (seed as f64 * 137.5).to_radians();
        let aside = |metres: f64| {
            let flat = nalgebra::Vector3::new(bearing.cos() * metres, bearing.sin() * metres, 0.0);
            Place {
                altitude: place.altitude,
                ..place.of_enu(flat)
            }
        };
        let sunk = Place {
            altitude: place.altitude - undulation_m,
            ..place
        };
        let numbers = |at: Place| {
            format!(
                "latitude: {:.12}, longitude: {:.12}, altitude: {:.6}",
                at.latitude, at.longitude, at.altitude
            )
        };
        let down = Isometry3::from_parts(Translation3::from(place.ecef()), place.earth_from_enu().into()).inverse();
        let ([x, y, z], [i, j, k, w]): ([f64; 3], [f64; 4]) = (down.translation.vector.into(), slots(down.rotation));
        let below = format!("xyz: [{x:.6}, {y:.6}, {z:.6}], quaternion: [{i:.15}, {j:.15}, {k:.15}, {w:.15}]");
        let words = [
            ("$below", below),
            ("$by2km", format!("{{{}}}", numbers(aside(2000.0)))),
            ("$near", format!("{{{}}}", numbers(aside(3300.0)))),
            ("$mid", format!("{{{}}}", numbers(aside(6000.0)))),
            ("$far", format!("{{{}}}", numbers(aside(15_000.0)))),
            ("$aside40", format!("{{{}}}", numbers(aside(40.0)))),
            ("$aside30", numbers(aside(30.0))),
            ("$aside03", numbers(aside(0.3))),
            ("$sunk_origin", numbers(sunk)),
            ("$sunk", format!("{{{}}}", numbers(sunk))),
            ("$origin", numbers(place)),
            (
                "$turned",
                format!("{{rpy_deg: [0, 0, {:.3}]}}", (seed as f64 * 47.3 + 20.0) % 360.0),
            ),
            ("$frame", "map".to_owned()),
        ];
        let vehicle = match kind.vehicle {
            Vehicle::Car => "car",
            Vehicle::Walker => "walker",
            Vehicle::Drone => "drone",
            Vehicle::Robot => "robot",
        };
        let motion = match kind.motion {
            Motion::Turning => "turning",
            Motion::Straight => "straight",
            Motion::Still => "still",
            Motion::Circles => "circles",
            Motion::OutAndBack => "out_and_back",
        };
        let imu = match kind.imu {
            Grade::Tactical => "tactical",
            Grade::Mems => "mems",
            Grade::Perfect => "perfect",
        };
        let gnss = match kind.gnss {
            Gnss::Rtk => "rtk",
            Gnss::Single => "single",
            Gnss::Perfect => "perfect",
        };
        let mut recipe = format!(
            "duration_s: {}\ncompression: none\ndrive: {{vehicle: {vehicle}, motion: {motion}, seed: {seed}, imu: {imu}, gnss: {gnss}, \
             place: {{{}}}, undulation_m: {undulation_m}}}\ntopics:\n",
            kind.seconds,
            numbers(place)
        );
        for topic in self.topics {
            let mut topic = (*topic).to_owned();
            for (word, text) in self.says {
                topic = topic.replace(word, text);
            }
            for (word, text) in &words {
                topic = topic.replace(word, text);
            }
            for word in [
                "$earth", "$moves", "$fix", "$rear", "$pose", "$site", "$odom", "$heading", "$imu",
            ] {
                topic = topic.replace(word, "");
            }
            recipe.extend(["  - ", topic.as_str(), "\n"]);
        }
        recipe
    }
}

/// Drives that are long enough for a grid and for the curve of the Earth.
fn long() -> Vec<Kind> {
    let kind = |vehicle, gnss| Kind {
        vehicle,
        motion: Motion::Turning,
        seconds: 400,
        imu: Grade::Mems,
        gnss,
    };
    vec![
        kind(Vehicle::Car, Gnss::Rtk),
        kind(Vehicle::Car, Gnss::Single),
        kind(Vehicle::Drone, Gnss::Rtk),
    ]
}

/// Each rule on each scene that it is asked of, and all rules together.
pub fn lines(table: &mut Table) {
    for (group, kinds, pooled) in lines::groups() {
        for scene in SCENES {
            ask(table, group, &kinds, pooled, scene, |_| true);
        }
    }
    for scene in SCENES {
        ask(table, "Long", &long(), false, scene, |rule| {
            matches!(rule, "GEO04" | "GEO05" | "GEO07")
        });
    }
}

fn ask(
    table: &mut Table,
    group: &'static str,
    kinds: &[Kind],
    pooled: bool,
    scene: &'static Scene,
    is_meant: impl Fn(&str) -> bool,
) {
    let all = (ALL, "");
    let asked = scene.asked.iter().chain([&all]).filter(|(rule, _)| is_meant(rule));
    for (rule, subject) in asked {
        for kind in kinds {
            table.ask(
                *kind,
                &AnswerKey {
                    group,
                    rule,
                    subject,
                    fault: Fault::Place(scene.name),
                    called: None,
                    pooled: pooled || *rule == ALL,
                    reference: None,
                },
            );
        }
    }
}
