//! Mistakes in the time offset between a camera and the IMU, as files state it.

use crate::world::World;

use super::{Change, Fault, Subject, SubjectPlace};

/// The offset has the opposite sign.
struct Negated;

impl Change for Negated {
    fn subjects(&self, world: &World) -> Vec<Subject> {
        let delays = world.delays.iter().enumerate();
        let subjects = delays.map(|(number, one)| {
            let path = world.path(one.place.source);
            let name = format!("`{}` of `cam{}` of {path}", one.key, one.camera);
            Subject {
                words: vec![format!("of `cam{}` of ", one.camera)],
                name,
                at: SubjectPlace::Delay(number),
            }
        });
        subjects.collect()
    }

    fn apply(&self, world: &mut World, subject: &Subject) -> bool {
        let SubjectPlace::Delay(number) = subject.at else {
            return false;
        };
        let Some(one) = world.delays.get_mut(number) else {
            return false;
        };
        one.offset_s = -one.offset_s;
        one.offset_s != 0.0
    }
}

/// Every mistake of this kind.
pub(super) static FAULTS: &[Fault] = &[fault!(
    Time,
    "camera-imu-offset-negated",
    "The time offset between a camera and the IMU has the opposite sign.",
    Negated,
    [],
    [": opposite signs"],
    ["TIME12"],
    "the result of the calibration (camchain-imucam.yaml) beside the file that uses it",
)];
