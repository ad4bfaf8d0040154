//! The registry: one line for each rule, in the order of the families. It makes the modules, [`RuleCode`](crate::verdict::RuleCode)s
//! and the list of rules. A rule judges worlds unless its line says otherwise.

/// Hands every rule to a macro.
macro_rules! registry {
    ($then:ident) => {
        $then! {
            #[doc = "TREE: the structure of the frame tree."]
            tree {
                TREE01 => orphan_subtree::OrphanSubtree,
                TREE02 => multiple_parents::MultipleParents,
                TREE03 => tf_cycle::TfCycle,
                TREE04 => self_or_empty_transform::SelfOrEmptyTransform,
                TREE05 => static_dynamic_conflict::StaticDynamicConflict,
                TREE06 => rep105_order::Rep105Order,
                TREE07 => message_frame_unresolved::MessageFrameUnresolved,
                TREE08 => tf_static_missing_or_late::TfStaticMissingOrLate,
                TREE09 => tf_lookup_coverage::TfLookupCoverage,
                TREE10 => tf_rate_too_low::TfRateTooLow,
                TREE11 => static_transform_changes::StaticTransformChanges as across,
                TREE12 => urdf_structure::UrdfStructure,
                TREE13 => base_footprint::BaseFootprint,
                TREE14 => map_odom_jump::MapOdomJump,
                TREE15 => odom_discontinuity::OdomDiscontinuity,
                TREE16 => map_odom_not_applied::MapOdomNotApplied,
            }
            #[doc = "NAME: the names of frames."]
            name {
                NAME01 => frame_case_mismatch::FrameCaseMismatch,
                NAME02 => frame_whitespace_or_slash::FrameWhitespaceOrSlash,
                NAME03 => frame_near_duplicate::FrameNearDuplicate,
                NAME04 => ned_suffix::NedSuffix,
                NAME05 => flu_frd_suffix::FluFrdSuffix,
                NAME06 => optical_suffix::OpticalSuffix,
                NAME07 => image_frame_not_optical::ImageFrameNotOptical,
                NAME08 => transform_name_cancellation::TransformNameCancellation,
                NAME09 => left_right::LeftRight,
            }
            #[doc = "ROT: rotations, translations and the numbers that state them."]
            rot {
                ROT01 => rotation_determinant::RotationDeterminant,
                ROT02 => rotation_orthogonality::RotationOrthogonality,
                ROT03 => homogeneous_layout::HomogeneousLayout,
                ROT04 => quaternion_norm::QuaternionNorm,
                ROT05 => non_finite_or_zero::NonFiniteOrZero,
                ROT06 => translation_units::TranslationUnits,
                ROT07 => identity_or_placeholder::IdentityOrPlaceholder,
                ROT08 => angle_unit::AngleUnit,
                ROT09 => truncated_literal::TruncatedLiteral,
                ROT10 => rotation_error_budget::RotationErrorBudget as review,
                ROT11 => pcd_viewpoint::PcdViewpoint,
            }
            #[doc = "AXES: axes and conventions, measured from motion."]
            axes {
                AXES01 => imu_gravity_sign::ImuGravitySign,
                AXES02 => imu_units::ImuUnits,
                AXES03 => orientation_vs_gravity::OrientationVsGravity,
                AXES04 => heading_convention::HeadingConvention,
                AXES05 => gyro_vs_turn_sign::GyroVsTurnSign,
                AXES06 => accel_vs_speed::AccelVsSpeed,
                AXES07 => gnss_vs_odom_handedness::GnssVsOdomHandedness,
                AXES08 => odom_twist_frame::OdomTwistFrame,
                AXES09 => ground_z::GroundZ,
                AXES10 => up_axis_flip::UpAxisFlip,
                AXES11 => cloud_mirror::CloudMirror,
                AXES12 => lidar_forward_axis::LidarForwardAxis,
                AXES13 => base_frame_flu::BaseFrameFlu,
                AXES14 => map_z_up::MapZUp,
                AXES15 => radar_doppler::RadarDoppler,
                AXES16 => imu_mounting::ImuMountingRotation,
                AXES17 => map_file_up::MapFileUp,
            }
            #[doc = "QUAT: the order and the algebra of quaternions, and the angles that they are computed from."]
            quat {
                QUAT01 => quaternion_convention::QuaternionConvention,
                QUAT02 => quaternion_order_static::QuaternionOrderStatic,
                QUAT03 => euler_sequence::EulerSequence,
                QUAT04 => left_vs_right_multiplication::LeftVsRightMultiplication,
                QUAT05 => jpl_provenance::JplProvenance,
            }
            #[doc = "GEO: positions on the earth."]
            geo {
                GEO01 => navsatfix_sanity::NavsatfixSanity,
                GEO02 => ecef_enu_rotation::EcefEnuRotation,
                GEO03 => coordinate_kind::CoordinateKind,
                GEO04 => grid_convergence_scale::GridConvergenceScale,
                GEO05 => tangent_plane_range::TangentPlaneRange,
                GEO06 => altitude_datum::AltitudeDatum,
                GEO07 => origin_consistency::OriginConsistency as across,
                GEO08 => antenna_mounting::AntennaMounting,
                GEO09 => point_file_crs::PointFileCrs,
                GEO10 => point_file_origin::PointFileOrigin,
            }
            #[doc = "TIME: stamps, clocks and their offsets."]
            time {
                TIME01 => epoch_offset::EpochOffset,
                TIME02 => stamp_vs_log::StampVsLog,
                TIME03 => stamp_monotonic::StampMonotonic,
                TIME04 => clock_domain::ClockDomain,
                TIME05 => point_time_missing::PointTimeMissing,
                TIME06 => point_time_unit::PointTimeUnit,
                TIME07 => point_time_sweep::PointTimeSweep,
                TIME08 => point_time_reference::PointTimeReference,
                TIME09 => sensor_time_offset::SensorTimeOffset,
                TIME10 => tf_vs_sensor_time::TfVsSensorTime,
                TIME11 => leap_table_expiry::LeapTableExpiry,
                TIME12 => camera_imu_offset::CameraImuOffset,
            }
            #[doc = "SENSOR: conventions of drivers, devices, simulators and autopilots."]
            sensor {
                SENSOR01 => ouster_frame::OusterFrame,
                SENSOR02 => ouster_tf_metadata::OusterTfMetadata,
                SENSOR03 => extrinsic_z180_double::ExtrinsicZ180Double,
                SENSOR04 => native_y_forward::NativeYForward,
                SENSOR05 => imu_shares_lidar_frame::ImuSharesLidarFrame,
                SENSOR06 => ins_profile::InsProfile,
                SENSOR07 => mavros_frames::MavrosFrames,
                SENSOR08 => compass_in_quaternion::CompassInQuaternion,
                SENSOR09 => left_handed_simulator::LeftHandedSimulator,
                SENSOR10 => dataset_profile::DatasetProfile,
                SENSOR11 => beam_calibration::BeamAngles,
            }
            #[doc = "CAMERA: cameras, their parameters and their mounting."]
            camera {
                CAMERA01 => optical_rotation::OpticalRotation,
                CAMERA02 => camera_info_k_size::CameraInfoKSize,
                CAMERA03 => camera_info_distortion::CameraInfoDistortion,
                CAMERA04 => camera_info_r_p::CameraInfoRP,
                CAMERA05 => lidar_in_view::LidarInView,
                CAMERA06 => camera_extrinsic_direction::CameraExtrinsicDirection,
                CAMERA07 => stereo_baseline::StereoBaseline,
                CAMERA08 => range_image_config::RangeImageConfig,
                CAMERA09 => bev_panorama_metadata::BevPanoramaMetadata,
            }
            #[doc = "COV: covariances as published, and compared with the motion that they belong to."]
            cov {
                COV01 => cov_psd::CovPsd,
                COV02 => cov_order::CovOrder,
                COV03 => cov_unknown_marking::CovUnknownMarking,
                COV04 => cov_frame::CovFrame,
                COV05 => cov_units::CovUnits,
            }
            #[doc = "AUTH: where transforms come from, and who may publish them."]
            auth {
                AUTH01 => multiple_authorities::MultipleAuthorities,
                AUTH02 => calibration_artifact_id::CalibrationArtifactId,
                AUTH03 => adhoc_static_transform::AdhocStaticTransform,
                AUTH04 => convention_undeclared::ConventionUndeclared,
                AUTH05 => calibration_missing_default::CalibrationMissingDefault,
            }
            #[doc = "CROSS: several statements of the same pair of frames."]
            cross {
                CROSS01 => extrinsic_consistency::ExtrinsicConsistency,
                CROSS02 => extrinsic_relation::ExtrinsicRelation,
                CROSS03 => calibration_loop::CalibrationLoop,
                CROSS04 => extrinsic_direction::ExtrinsicDirection,
                CROSS05 => hand_eye::HandEyeCalibration,
                CROSS06 => urdf_tf_topology::UrdfTfTopology,
                CROSS07 => frame_aliases::FrameAliases,
                CROSS08 => poses_vs_tf::PosesVsTf,
            }
            #[doc = "CONFIG: what launch files and parameters pass to programs that publish or move frames."]
            config {
                CONFIG01 => static_transform_arguments::StaticTransformArguments,
                CONFIG02 => navsat_transform::NavsatTransform,
                CONFIG03 => localization_frames::LocalizationFrames,
            }
            #[doc = "CONTRACT: recordings compared with what the configuration says that they hold."]
            contract {
                CONTRACT01 => contract_topic::ContractTopic,
                CONTRACT02 => contract_rate::ContractRate,
                CONTRACT03 => contract_frame::ContractFrame,
                CONTRACT04 => contract_transform::ContractTransform,
                CONTRACT05 => contract_sensor::ContractSensor,
            }
            #[doc = "URDF: the contents of robot descriptions, and how consumers read them."]
            urdf {
                URDF01 => mesh_scale::MeshScale,
                URDF02 => self_joint::SelfJoint,
                URDF03 => joint_axis::JointAxis,
                URDF04 => joint_limits::JointLimits,
                URDF05 => duplicate_name::DuplicateName,
                URDF06 => missing_mimic::MissingMimic,
                URDF07 => repeated_element::RepeatedElement,
                URDF08 => inertia_invalid::InertiaInvalid,
                URDF09 => mesh_missing::MeshMissing,
                URDF10 => malformed_number::MalformedNumber,
                URDF11 => ignored_name::IgnoredName,
                URDF12 => unknown_joint_type::UnknownJointType,
                URDF13 => consumer_disagrees::ConsumerDisagrees,
            }
            #[doc = "PREC: precision lost by number types."]
            prec {
                PREC01 => float32_ulp::Float32Ulp,
                PREC02 => point_time_precision::PointTimePrecision,
                PREC03 => local_origin::LocalOrigin,
                PREC04 => las_grid::LasGrid,
            }
            #[doc = "GATE: waivers, comments and baselines that have no effect, have expired, or are not understood."]
            gate {
                GATE01 => unused_waiver::UnusedWaiver as policy,
                GATE02 => expired_waiver::ExpiredWaiver as policy,
                GATE03 => comment_not_understood::CommentNotUnderstood as policy,
            }
        }
    };
}
pub(crate) use registry;
