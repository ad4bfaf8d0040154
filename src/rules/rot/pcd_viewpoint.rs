//! ROT11: a pose in the header of a PCD file, which programs apply or ignore.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::analysis::point_files::NamedPoints;
use crate::rules::prelude::*;
use crate::source::SourceValue;
use crate::world::point_file::Viewpoint;

pub(crate) struct PcdViewpoint;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(clippy::struct_field_names, reason = "all of them are maxima")]
pub(crate) struct Limits {
    max_norm_off: f64,
    max_turn_deg: f64,
    max_shift_m: f64,
}

impl Rule for PcdViewpoint {
    const NEEDS: &'static [Need] = &[Need::Points];
    type Limits = Limits;

    fn judge(world: &Estimates, limits: &Limits, out: &mut Judge) {
        for points in NamedPoints::all(world) {
            let subject = points.subject("`VIEWPOINT`");
            match &points.file.viewpoint {
                Some(viewpoint) => judge_one(subject, points.name(), viewpoint, limits, out),
                None => out.not_applicable(subject, "the file states no viewpoint"),
            }
        }
    }
}

fn judge_one(subject: String, name: &str, stated: &SourceValue<Viewpoint>, limits: &Limits, out: &mut Judge) {
    let [w, x, y, z] = stated.value.wxyz;
    let quaternion = Quaternion::new(w, x, y, z);
    let norm = quaternion.norm();
    let length = Measured::new("norm of the quaternion", norm, "1").expected(1.0);
    let is_unit = (norm - 1.0).abs() <= limits.max_norm_off;
    let shift_m = Vector3::from(stated.value.translation).norm();
    if !is_unit || !shift_m.is_finite() {
        let message = format!("`{name}`: the quaternion of `VIEWPOINT` has the norm {norm:.3}, so it is no rotation");
        let finding = Finding::error(subject, message, stated.place.clone())
            .relation("not-a-rotation")
            .detail("The order is tx ty tz qw qx qy qz. Programs that apply it scale or lose the cloud.")
            .help("write `VIEWPOINT 0 0 0 1 0 0 0`, or a unit quaternion with w first");
        return out.fail(finding.measured([length]));
    }
    let turn_deg = UnitQuaternion::from_quaternion(quaternion).angle().to_degrees();
    let measured = [
        Measured::new("rotation of the viewpoint", turn_deg, "deg")
            .turn()
            .limit(limits.max_turn_deg),
        Measured::new("distance of the viewpoint from the origin", shift_m, "m").limit(limits.max_shift_m),
        length,
    ];
    let is_turned = turn_deg > limits.max_turn_deg;
    if !is_turned && shift_m <= limits.max_shift_m {
        return out.pass(subject, measured);
    }
    let what = if is_turned {
        format!("rotated by {turn_deg:.1} deg, {shift_m:.2} m away")
    } else {
        format!("{shift_m:.2} m from the origin")
    };
    let message = format!("`{name}`: `VIEWPOINT` is {what}; most programs ignore it");
    let finding = Finding::warning(subject, message, stated.place.clone())
        .relation("viewpoint")
        .detail(
            "pcl_viewer moves the points by it, and CloudCompare exports transforms in it. `pcd_to_pointcloud`, PCL's registration and Open3D use \
             the points as they are: the same file is at two places.",
        )
        .help(
            "do one of these:\n(1) the points are in the sensor's axes: apply the pose to them (`pcl_transform_point_cloud`), and write `VIEWPOINT 0 0 0 1 0 0 0`\n\
             (2) the points are in the map already, and the pose says where the sensor was: keep it in another file, and write the same line",
        );
    out.fail(finding.measured(measured));
}
