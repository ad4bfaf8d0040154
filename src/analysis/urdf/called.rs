//! The names of robots, joints and links in rows.

use crate::world::World;
use crate::world::robot::{Joint, Link, Robot};

/// "robot `cart` of robot.urdf".
pub(crate) fn robot(world: &World, robot: &Robot) -> String {
    format!("robot `{}` of {}", robot.name.value, world.path(robot.source))
}

/// "joint `lidar_joint` of robot.urdf".
pub(crate) fn joint(world: &World, robot: &Robot, joint: &Joint) -> String {
    format!("joint `{}` of {}", joint.name.value, world.path(robot.source))
}

/// "link `lidar` of robot.urdf".
pub(crate) fn link(world: &World, robot: &Robot, link: &Link) -> String {
    format!("link `{}` of {}", link.name.value, world.path(robot.source))
}
