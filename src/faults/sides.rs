//! Mistakes of parts of which a platform has a left and a right one.

use nalgebra::Isometry3;

use crate::world::frame_words::pairs_of_sides;
use crate::world::graph::Edge;
use crate::world::{FrameId, World};

use super::{Change, Fault, Subject, SubjectPlace, mountings};

/// The transforms of the two from their parent are exchanged.
struct Exchanged;

impl Change for Exchanged {
    fn subjects(&self, world: &World) -> Vec<Subject> {
        let pairs = pairs_of_sides(world.graph().frames.iter()).into_iter();
        let mounted = pairs.filter(|pair| mounts(world, *pair).is_some());
        let subjects = mounted.map(|(left, right)| Subject {
            name: format!("`{left}` and `{right}`"),
            words: vec![format!("`{left}`"), format!("`{right}`")],
            at: SubjectPlace::Frame(left.clone()),
        });
        subjects.collect()
    }

    fn apply(&self, world: &mut World, subject: &Subject) -> bool {
        let SubjectPlace::Frame(left) = &subject.at else {
            return false;
        };
        let pairs = pairs_of_sides(world.graph().frames.iter());
        let pair = pairs.into_iter().find(|(of, _)| *of == left);
        let Some([(left, base_from_left), (right, base_from_right)]) = pair.and_then(|pair| mounts(world, pair)) else {
            return false;
        };
        mountings::remount(world, &left, |_| Some(base_from_right))
            && mountings::remount(world, &right, |_| Some(base_from_left))
    }
}

/// A mounting: where it is stated, and `parent_from_frame`.
type Mount = (SubjectPlace, Isometry3<f64>);

/// The rigid transforms of two frames from one parent; `None` where there are none.
fn mounts(world: &World, (left, right): (&FrameId, &FrameId)) -> Option<[Mount; 2]> {
    let graph = world.graph();
    let rigid = |edge: &&Edge| edge.is_rigid && edge.pose.is_some();
    let of_left = graph.edges_to(left).find(rigid)?;
    let of_right = graph
        .edges_to(right)
        .find(|edge| rigid(edge) && edge.parent == of_left.parent)?;
    let mount = |edge: &Edge| Some((mountings::place_of(edge), edge.pose?));
    Some([mount(of_left)?, mount(of_right)?])
}

/// Every mistake of this kind.
pub(super) static FAULTS: &[Fault] = &[fault!(
    Mounting,
    "sides-exchanged",
    "The transforms of a left and a right part are exchanged, or their names.",
    Exchanged,
    ["sides-exchanged", "exchanged", "mirrored-y"],
    [],
    ["NAME09", "CROSS02"],
    "other pairs of left and right parts in the robot's description, or a calibration file that states the transforms independently of it",
)];
