//! The rules: each judges a world and says what it measured. Mirrors `rules/` one to one.
//!
//! Rules are pure: no I/O, no clock, no randomness. They know the world and `math`, and nothing of reading,
//! collecting, configuration or reports.

pub mod auth;
pub mod axes;
pub mod camera;
pub mod config;
pub mod cov;
pub mod cross;
mod declared;
pub mod gate;
pub mod geo;
mod ground;
mod hand_eye;
mod judge;
mod landmarks;
mod lidar;
mod literal;
mod motion;
pub mod name;
mod names;
mod near;
mod optical;
mod ouster;
mod pairs;
mod places;
pub mod prec;
mod promised;
pub mod quat;
mod radar;
mod relate;
mod restate;
pub mod rot;
mod scan_motion;
pub mod sensor;
mod spelling;
mod suffix;
mod tally;
mod tf;
pub mod time;
pub mod tree;
pub mod urdf;

use serde::de::DeserializeOwned;

use crate::page::{Front, PageError};
use crate::verdict::waiver::{Applied, Misspelt};
use crate::verdict::{Finding, Row};
use crate::world::World;

pub use judge::{Judge, Need};

/// A rule: a page, its needs, typed limits and a judgement.
pub trait Rule {
    /// The rule's page, front matter and all.
    const PAGE: &'static str;
    /// What must be there before the rule is asked; the engine answers `not-evaluated` where it is not.
    const NEEDS: &'static [Need];
    /// How much of a recording the rule needs at first.
    const EVIDENCE: Evidence = Evidence::USUAL;
    /// The limits of the page, typed.
    type Limits: DeserializeOwned;

    /// Whether the rule speaks of what the others found.
    const REVIEWS: bool = false;

    /// Judges every subject of a world: one `pass`, `fail` or `not_evaluated` for each. Saying nothing at all means
    /// that the world holds no subject.
    fn judge(world: &World, limits: &Self::Limits, out: &mut Judge);

    /// Whether the rule compares recordings of one platform: it is asked for each of them, and once more for all together.
    const ACROSS: bool = false;

    /// Whether the rule speaks of what the user accepts.
    const OF_GATE: bool = false;

    /// Judges what the user accepts, once for a run and instead of [`Rule::judge`], where [`Rule::OF_GATE`] says so.
    fn judge_gate(_applied: &[Applied], _misspelt: &[Misspelt], _limits: &Self::Limits, _out: &mut Judge) {}

    /// Speaks of what the other rules found, and may add to what they measured: asked last, instead of [`Rule::judge`], where
    /// [`Rule::REVIEWS`] says so. As pure as that: findings and outcomes in, judgements out.
    fn review(_found: &mut [Finding], _rows: &[Row], _limits: &Self::Limits, _out: &mut Judge) {}
}

/// The limits of another rule, as its page has them.
pub(crate) fn limits_of<R: Rule>() -> Option<R::Limits> {
    Front::parse_limits(R::PAGE).ok()?.limits().ok()
}

/// How a recording is sampled for a rule, before anything is known of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evidence {
    /// Windows spread over the recording.
    pub windows: u32,
    /// Length of a window, seconds of log time.
    pub seconds: f64,
    /// Whether more is read where that does not suffice, though nobody gave a time for it.
    pub widens: bool,
}

impl Evidence {
    /// Next to nothing.
    pub const LEAST: Self = Self {
        windows: 2,
        seconds: 0.5,
        widens: true,
    };
    /// What rules on names, trees and stamps need.
    pub const USUAL: Self = Self {
        windows: 10,
        seconds: 2.0,
        widens: true,
    };
    /// What rules on motion need: a drive with turns. Of recordings with images or clouds that would be a large part, which
    /// is read where the user gives a time for it.
    pub const MOTION: Self = Self {
        widens: false,
        ..Self::USUAL
    };

    /// What suffices for both.
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        Self {
            windows: self.windows.max(other.windows),
            seconds: self.seconds.max(other.seconds),
            widens: self.widens || other.widens,
        }
    }
}

/// For rules without limits.
#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NoLimits {}

type Run = fn(&World, &Front, &mut Judge) -> Result<(), PageError>;
type Gate = fn(&[Applied], &[Misspelt], &Front, &mut Judge) -> Result<(), PageError>;
type Review = fn(&mut [Finding], &[Row], &Front, &mut Judge) -> Result<(), PageError>;

/// A registered rule.
#[derive(Clone, Copy)]
pub struct Entry {
    /// The rule's page.
    pub page: &'static str,
    /// Its needs.
    pub needs: &'static [Need],
    /// How much of a recording it needs at first.
    pub evidence: Evidence,
    /// Loads the limits and judges.
    pub run: Run,
    /// Loads the limits and speaks of what the others found, where the rule does that instead.
    pub review: Option<Review>,
    /// Loads the limits and judges what the user accepts, where the rule does that instead.
    pub gate: Option<Gate>,
    /// Whether it compares recordings.
    pub across: bool,
    /// Loads the limits only.
    pub check_limits: fn(&Front) -> Result<(), PageError>,
}

const fn entry<R: Rule>() -> Entry {
    Entry {
        page: R::PAGE,
        needs: R::NEEDS,
        evidence: R::EVIDENCE,
        run: |world, front, out| {
            R::judge(world, &front.limits::<R::Limits>()?, out);
            Ok(())
        },
        review: if R::REVIEWS { Some(review::<R>) } else { None },
        gate: if R::OF_GATE { Some(gate::<R>) } else { None },
        across: R::ACROSS,
        check_limits: |front| front.limits::<R::Limits>().map(|_| ()),
    }
}

fn review<R: Rule>(found: &mut [Finding], rows: &[Row], front: &Front, out: &mut Judge) -> Result<(), PageError> {
    R::review(found, rows, &front.limits::<R::Limits>()?, out);
    Ok(())
}

fn gate<R: Rule>(applied: &[Applied], misspelt: &[Misspelt], front: &Front, out: &mut Judge) -> Result<(), PageError> {
    R::judge_gate(applied, misspelt, &front.limits::<R::Limits>()?, out);
    Ok(())
}

/// Every rule, in the order of the catalogue. Adding a rule: its page, its file, one line here.
pub static RULES: &[Entry] = &[
    entry::<tree::orphan_subtree::OrphanSubtree>(),
    entry::<tree::multiple_parents::MultipleParents>(),
    entry::<tree::tf_cycle::TfCycle>(),
    entry::<tree::self_or_empty_transform::SelfOrEmptyTransform>(),
    entry::<tree::static_dynamic_conflict::StaticDynamicConflict>(),
    entry::<tree::rep105_order::Rep105Order>(),
    entry::<tree::message_frame_unresolved::MessageFrameUnresolved>(),
    entry::<tree::tf_static_missing_or_late::TfStaticMissingOrLate>(),
    entry::<tree::tf_lookup_coverage::TfLookupCoverage>(),
    entry::<tree::tf_rate_too_low::TfRateTooLow>(),
    entry::<tree::static_transform_changes::StaticTransformChanges>(),
    entry::<tree::urdf_structure::UrdfStructure>(),
    entry::<tree::base_footprint::BaseFootprint>(),
    entry::<tree::map_odom_jump::MapOdomJump>(),
    entry::<tree::odom_discontinuity::OdomDiscontinuity>(),
    entry::<tree::map_odom_not_applied::MapOdomNotApplied>(),
    entry::<name::frame_case_mismatch::FrameCaseMismatch>(),
    entry::<name::frame_whitespace_or_slash::FrameWhitespaceOrSlash>(),
    entry::<name::frame_near_duplicate::FrameNearDuplicate>(),
    entry::<name::ned_suffix::NedSuffix>(),
    entry::<name::flu_frd_suffix::FluFrdSuffix>(),
    entry::<name::optical_suffix::OpticalSuffix>(),
    entry::<name::image_frame_not_optical::ImageFrameNotOptical>(),
    entry::<name::transform_name_cancellation::TransformNameCancellation>(),
    entry::<rot::rotation_determinant::RotationDeterminant>(),
    entry::<rot::rotation_orthogonality::RotationOrthogonality>(),
    entry::<rot::homogeneous_layout::HomogeneousLayout>(),
    entry::<rot::quaternion_norm::QuaternionNorm>(),
    entry::<rot::non_finite_or_zero::NonFiniteOrZero>(),
    entry::<rot::translation_units::TranslationUnits>(),
    entry::<rot::identity_or_placeholder::IdentityOrPlaceholder>(),
    entry::<rot::angle_unit::AngleUnit>(),
    entry::<rot::truncated_literal::TruncatedLiteral>(),
    entry::<rot::rotation_error_budget::RotationErrorBudget>(),
    entry::<axes::imu_gravity_sign::ImuGravitySign>(),
    entry::<axes::imu_units::ImuUnits>(),
    entry::<axes::orientation_vs_gravity::OrientationVsGravity>(),
    entry::<axes::heading_convention::HeadingConvention>(),
    entry::<axes::gyro_vs_turn_sign::GyroVsTurnSign>(),
    entry::<axes::accel_vs_speed::AccelVsSpeed>(),
    entry::<axes::gnss_vs_odom_handedness::GnssVsOdomHandedness>(),
    entry::<axes::odom_twist_frame::OdomTwistFrame>(),
    entry::<axes::ground_z::GroundZ>(),
    entry::<axes::up_axis_flip::UpAxisFlip>(),
    entry::<axes::cloud_mirror::CloudMirror>(),
    entry::<axes::lidar_forward_axis::LidarForwardAxis>(),
    entry::<axes::base_frame_flu::BaseFrameFlu>(),
    entry::<axes::map_z_up::MapZUp>(),
    entry::<axes::radar_doppler::RadarDoppler>(),
    entry::<quat::quaternion_convention::QuaternionConvention>(),
    entry::<quat::quaternion_order_static::QuaternionOrderStatic>(),
    entry::<quat::euler_sequence::EulerSequence>(),
    entry::<quat::left_vs_right_multiplication::LeftVsRightMultiplication>(),
    entry::<quat::jpl_provenance::JplProvenance>(),
    entry::<geo::navsatfix_sanity::NavsatfixSanity>(),
    entry::<geo::ecef_enu_rotation::EcefEnuRotation>(),
    entry::<geo::coordinate_kind::CoordinateKind>(),
    entry::<geo::grid_convergence_scale::GridConvergenceScale>(),
    entry::<geo::tangent_plane_range::TangentPlaneRange>(),
    entry::<geo::altitude_datum::AltitudeDatum>(),
    entry::<geo::origin_consistency::OriginConsistency>(),
    entry::<time::epoch_offset::EpochOffset>(),
    entry::<time::stamp_vs_log::StampVsLog>(),
    entry::<time::stamp_monotonic::StampMonotonic>(),
    entry::<time::clock_domain::ClockDomain>(),
    entry::<time::point_time_missing::PointTimeMissing>(),
    entry::<time::point_time_unit::PointTimeUnit>(),
    entry::<time::point_time_sweep::PointTimeSweep>(),
    entry::<time::point_time_reference::PointTimeReference>(),
    entry::<time::sensor_time_offset::SensorTimeOffset>(),
    entry::<time::tf_vs_sensor_time::TfVsSensorTime>(),
    entry::<time::leap_table_expiry::LeapTableExpiry>(),
    entry::<sensor::ouster_frame::OusterFrame>(),
    entry::<sensor::ouster_tf_metadata::OusterTfMetadata>(),
    entry::<sensor::extrinsic_z180_double::ExtrinsicZ180Double>(),
    entry::<sensor::native_y_forward::NativeYForward>(),
    entry::<sensor::imu_shares_lidar_frame::ImuSharesLidarFrame>(),
    entry::<sensor::ins_profile::InsProfile>(),
    entry::<sensor::mavros_frames::MavrosFrames>(),
    entry::<sensor::compass_in_quaternion::CompassInQuaternion>(),
    entry::<sensor::left_handed_simulator::LeftHandedSimulator>(),
    entry::<sensor::dataset_profile::DatasetProfile>(),
    entry::<camera::optical_rotation::OpticalRotation>(),
    entry::<camera::camera_info_k_size::CameraInfoKSize>(),
    entry::<camera::camera_info_distortion::CameraInfoDistortion>(),
    entry::<camera::camera_info_r_p::CameraInfoRP>(),
    entry::<camera::lidar_in_view::LidarInView>(),
    entry::<camera::camera_extrinsic_direction::CameraExtrinsicDirection>(),
    entry::<camera::stereo_baseline::StereoBaseline>(),
    entry::<camera::range_image_config::RangeImageConfig>(),
    entry::<camera::bev_panorama_metadata::BevPanoramaMetadata>(),
    entry::<cov::cov_psd::CovPsd>(),
    entry::<cov::cov_order::CovOrder>(),
    entry::<cov::cov_unknown_marking::CovUnknownMarking>(),
    entry::<cov::cov_frame::CovFrame>(),
    entry::<cov::cov_units::CovUnits>(),
    entry::<auth::multiple_authorities::MultipleAuthorities>(),
    entry::<auth::calibration_artifact_id::CalibrationArtifactId>(),
    entry::<auth::adhoc_static_transform::AdhocStaticTransform>(),
    entry::<auth::convention_undeclared::ConventionUndeclared>(),
    entry::<auth::calibration_missing_default::CalibrationMissingDefault>(),
    entry::<cross::extrinsic_consistency::ExtrinsicConsistency>(),
    entry::<cross::extrinsic_relation::ExtrinsicRelation>(),
    entry::<cross::calibration_loop::CalibrationLoop>(),
    entry::<cross::extrinsic_direction::ExtrinsicDirection>(),
    entry::<cross::hand_eye::HandEyeCalibration>(),
    entry::<cross::urdf_tf_topology::UrdfTfTopology>(),
    entry::<cross::frame_aliases::FrameAliases>(),
    entry::<config::static_transform_arguments::StaticTransformArguments>(),
    entry::<config::navsat_transform::NavsatTransform>(),
    entry::<config::localization_frames::LocalizationFrames>(),
    entry::<urdf::mesh_scale::MeshScale>(),
    entry::<urdf::self_joint::SelfJoint>(),
    entry::<urdf::joint_axis::JointAxis>(),
    entry::<urdf::joint_limits::JointLimits>(),
    entry::<urdf::duplicate_name::DuplicateName>(),
    entry::<urdf::missing_mimic::MissingMimic>(),
    entry::<urdf::repeated_element::RepeatedElement>(),
    entry::<urdf::inertia_invalid::InertiaInvalid>(),
    entry::<urdf::mesh_missing::MeshMissing>(),
    entry::<urdf::malformed_number::MalformedNumber>(),
    entry::<urdf::ignored_name::IgnoredName>(),
    entry::<urdf::unknown_joint_type::UnknownJointType>(),
    entry::<urdf::consumer_disagrees::ConsumerDisagrees>(),
    entry::<prec::float32_ulp::Float32Ulp>(),
    entry::<prec::point_time_precision::PointTimePrecision>(),
    entry::<prec::local_origin::LocalOrigin>(),
    entry::<gate::unused_waiver::UnusedWaiver>(),
    entry::<gate::expired_waiver::ExpiredWaiver>(),
    entry::<gate::comment_not_understood::CommentNotUnderstood>(),
];
