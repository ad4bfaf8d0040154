//! What a lidar shows of one camera: whether its mounting transform is possible, and which error explains it. Must not report.

use nalgebra::{Isometry3, Vector3};
use serde::Deserialize;

use crate::analysis::camera::published::{NameAgreement, RecordedCamera, VERTICAL, looks_against_its_name};
use crate::analysis::camera::views::{Attitude, Image, Mistake, Scene};
use crate::analysis::ground::{Ground, Planes};
use crate::analysis::{Estimates, lidar::Clouds, motion::mount::mount, names};
use crate::verdict::NotEvaluated;
use crate::world::FrameId;

/// Why it is not evaluated.
pub(crate) type Reason = (NotEvaluated, String);

/// A fault of a camera's frame, by what the lidar sees.
#[derive(Clone, Debug)]
pub(crate) enum Fault {
    UpsideDown,
    Under,
    /// The errors that explain it equally well, the first one is named; and the share of points without it.
    Mistaken(Vec<Mistake>, f64),
}

/// What a lidar shows of a camera.
#[derive(Clone, Debug)]
pub(crate) struct ViewEstimate {
    pub(crate) attitude: Attitude,
    pub(crate) base: FrameId,
    pub(crate) topic: String,
    /// Share of the points in the image, and the largest share of a level camera at its position.
    pub(crate) share: f64,
    pub(crate) most: f64,
    pub(crate) points: usize,
    pub(crate) clouds: usize,
    pub(crate) judged: Result<Option<Fault>, Reason>,
}

/// What the lidar that could show most of a camera shows of it.
pub(crate) fn look(
    world: &Estimates,
    planes: &Planes,
    camera: &RecordedCamera,
    frame: &FrameId,
    limits: &Limits,
) -> Result<ViewEstimate, Reason> {
    let not_applicable = |why: &str| (NotEvaluated::NotApplicable, why.to_owned());
    if camera.is_uncalibrated() {
        return Err(not_applicable("K is all zeros: the camera is not calibrated"));
    }
    let image = Image::of(camera.calibration)
        .ok_or_else(|| not_applicable("its size, K, distortion model or coefficients are not usable"))?;
    if crate::analysis::name::optical::reports(world, frame) {
        return Err(not_applicable("its axes are not optical"));
    }
    if crate::analysis::name::image_frame::reports(world, camera.bag, frame) {
        return Err(not_applicable("it is not an optical frame"));
    }
    let lidars: Vec<Clouds> = Clouds::all(world)
        .filter(|clouds| clouds.bag.source == camera.bag.source && clouds.is_of_a_lidar())
        .collect();
    if lidars.is_empty() {
        return Err((
            NotEvaluated::MissingInput,
            "the recording has no clouds of a lidar: record them too".to_owned(),
        ));
    }
    let mut seen: Vec<Result<ViewEstimate, Reason>> = lidars
        .iter()
        .map(|clouds| by_lidar(world, planes, clouds, (frame, &image), limits))
        .collect();
    // The lidar that could show most.
    seen.sort_by(|a, b| {
        let most = |seen: &Result<ViewEstimate, Reason>| seen.as_ref().map_or(-1.0, |shown| shown.most);
        most(b).total_cmp(&most(a))
    });
    seen.into_iter()
        .next()
        .unwrap_or_else(|| Err((NotEvaluated::MissingInput, String::new())))
}

fn by_lidar(
    world: &Estimates,
    planes: &Planes,
    clouds: &Clouds,
    (frame, image): (&FrameId, &Image),
    limits: &Limits,
) -> Result<ViewEstimate, Reason> {
    let little = |why: String| (NotEvaluated::TooLittleEvidence, why);
    let topic = clouds.topic.topic.clone();
    let lidar = clouds.frame().ok_or_else(|| {
        (
            NotEvaluated::MissingInput,
            format!("the clouds on `{topic}` have no frame_id"),
        )
    })?;
    let Some((lidar_from_camera, _)) = world.graph().chain(&lidar, frame, |edge| edge.is_rigid) else {
        let why = format!("no rigid chain of transforms connects `{frame}` and `{lidar}` of `{topic}`");
        return Err((NotEvaluated::MissingInput, why));
    };
    let up = world.limits::<crate::analysis::ground::Limits>();
    let grounds = planes.grounds(clouds, &up.is_ground());
    let side = up.agreed(clouds, &grounds).map_err(little)?;
    let of_side: Vec<&Ground> = grounds.iter().filter(|ground| ground.side == side).collect();
    if of_side.len() < limits.min_clouds {
        return Err(little(format!(
            "{} clouds show the ground; {} are needed",
            of_side.len(),
            limits.min_clouds
        )));
    }
    let (base, base_from_lidar) = match mount(world, &lidar) {
        Some(mount) => (mount.base, mount.base_from_sensor),
        None => (lidar.clone(), Isometry3::identity()),
    };
    let stated = base_from_lidar * lidar_from_camera;
    let scene = Scene::new(world, clouds, &base_from_lidar, &of_side, [limits.near_m, limits.far_m])
        .ok_or_else(|| little("the ground planes of its clouds have no common direction".to_owned()))?;
    let lean_deg = scene.up.angle(&Vector3::z()).to_degrees();
    if base != lidar && lean_deg > limits.max_lean_deg {
        let why = format!(
            "the ground on `{topic}` is tilted by {lean_deg:.0} deg in `{base}`: the lidar's mounting is probably wrong"
        );
        return Err((NotEvaluated::NotApplicable, why));
    }
    if scene.points() < limits.min_points {
        return Err(little(format!(
            "{} points of `{topic}` are between {} and {} m; {} are needed",
            scene.points(),
            limits.near_m,
            limits.far_m,
            limits.min_points
        )));
    }
    let (share, most) = (scene.share(image, &stated), scene.most(image, &stated));
    if most < limits.min_most {
        return Err(little(format!(
            "a level camera at this position sees at most {:.1} % of the points of `{topic}`, in any direction",
            100.0 * most
        )));
    }
    let attitude = scene.attitude(&stated);
    let camera = Camera {
        world,
        frame,
        image,
        stated,
        scene: &scene,
        most,
        limits,
    };
    Ok(ViewEstimate {
        attitude,
        judged: camera.judged(attitude, share, &topic),
        base,
        topic,
        share,
        most,
        points: scene.points(),
        clouds: scene.clouds,
    })
}

/// A camera and the data that it is judged by.
struct Camera<'a> {
    world: &'a Estimates<'a>,
    frame: &'a FrameId,
    image: &'a Image,
    /// `base_from_camera`.
    stated: Isometry3<f64>,
    scene: &'a Scene,
    most: f64,
    limits: &'a Limits,
}

impl Camera<'_> {
    fn judged(&self, attitude: Attitude, share: f64, topic: &str) -> Result<Option<Fault>, Reason> {
        let limits = self.limits;
        let little = |why: String| Err((NotEvaluated::TooLittleEvidence, why));
        let is_blind = share < limits.blind * self.most;
        let roll_deg = attitude.roll_deg.abs();
        if attitude.pitch_deg.abs() > limits.max_pitch_deg {
            let looks = if attitude.pitch_deg > 0.0 { "up" } else { "down" };
            if names::has_word(self.frame, VERTICAL)
                || crate::analysis::name::optical::is_turned_from_its_link(self.world, self.frame)
            {
                let why = format!(
                    "it looks {looks}, as its name or its own link states: {:.1} % of the points are in its image",
                    100.0 * share
                );
                return little(why);
            }
            return match self.mistakes() {
                found if is_blind && !found.is_empty() => Ok(Some(self.mistaken(found))),
                _ => little(format!(
                    "it looks {looks}, where `{topic}` has {:.1} % of its points: this may be intended",
                    100.0 * share
                )),
            };
        }
        if roll_deg >= 180.0 - limits.max_roll_deg {
            return Ok(Some(Fault::UpsideDown));
        }
        if roll_deg > limits.max_roll_deg {
            return match self.mistakes() {
                found if !found.is_empty() => Ok(Some(self.mistaken(found))),
                _ => little(format!(
                    "its roll is {:.0} deg, as for cameras that are mounted in portrait orientation",
                    attitude.roll_deg
                )),
            };
        }
        if attitude.height_m < -limits.under_m {
            return Ok(Some(Fault::Under));
        }
        if is_blind {
            let is_against =
                looks_against_its_name(self.frame, &(self.stated.rotation * Vector3::z())) == NameAgreement::Against;
            if is_against && self.fits(Mistake::Reversed) {
                return Ok(Some(self.mistaken(vec![Mistake::Reversed])));
            }
            return little(format!(
                "it is upright, and looks where `{topic}` has {:.1} % of its points: the lidar sees nothing there",
                100.0 * share
            ));
        }
        Ok(None)
    }

    fn mistaken(&self, found: Vec<Mistake>) -> Fault {
        let corrected = found.first().map(|mistake| mistake.corrected(&self.stated));
        let share = corrected.map_or(0.0, |corrected| self.scene.share(self.image, &corrected));
        Fault::Mistaken(found, share)
    }

    /// The errors that would explain the mounting. The direction of a camera is known from names only.
    fn mistakes(&self) -> Vec<Mistake> {
        let explains = |mistake: &Mistake| *mistake != Mistake::Reversed && self.fits(*mistake);
        Mistake::ALL.into_iter().filter(explains).collect()
    }

    /// Whether the corrected mounting is plausible: upright, above the ground, on the vehicle, with points in view.
    fn fits(&self, mistake: Mistake) -> bool {
        let limits = self.limits;
        let corrected = mistake.corrected(&self.stated);
        let attitude = self.scene.attitude(&corrected);
        let looks = corrected.rotation * Vector3::z();
        // Rotated by 90 deg about its view or about the vertical any camera becomes another upright one: the stated mounting must be
        // impossible, or the corrected one must look where cameras look.
        let is_expected = match looks_against_its_name(self.frame, &looks) {
            NameAgreement::Fit => true,
            NameAgreement::Against => false,
            NameAgreement::Unnamed => looks.angle(&Vector3::x()).to_degrees() <= limits.ahead_deg,
        };
        let is_impossible =
            mistake != Mistake::NotTurned && self.scene.attitude(&self.stated).height_m < -limits.under_m;
        attitude.roll_deg.abs() <= limits.corrected_roll_deg
            && attitude.pitch_deg.abs() <= limits.corrected_pitch_deg
            && attitude.height_m > 0.0
            && corrected.translation.vector.norm() <= limits.max_away_m
            && (is_expected || is_impossible)
            && self.scene.share(self.image, &corrected) >= limits.seeing * self.most
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) min_clouds: usize,
    pub(crate) near_m: f64,
    pub(crate) far_m: f64,
    pub(crate) min_points: usize,
    pub(crate) min_most: f64,
    pub(crate) blind: f64,
    pub(crate) seeing: f64,
    pub(crate) max_pitch_deg: f64,
    pub(crate) max_roll_deg: f64,
    pub(crate) corrected_roll_deg: f64,
    pub(crate) corrected_pitch_deg: f64,
    pub(crate) max_lean_deg: f64,
    pub(crate) max_away_m: f64,
    pub(crate) under_m: f64,
    pub(crate) ahead_deg: f64,
}
