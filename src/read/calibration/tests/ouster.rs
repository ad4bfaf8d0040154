//! Metadata of Ouster sensors of every firmware, flat and in parts.

use super::super::ouster::may_be_ouster;
use super::*;

/// Firmware 1.13: keys side by side, no beam origin. Shortened.
const FLAT: &str = r#"{"prod_line": "OS-1-16-A0", "build_rev": "v1.13.0", "prod_sn": "991937000062",
"image_rev": "ousteros-image-prod-aries-v1.13.0-20191105025459", "beam_altitude_angles": [14.9, 4.9], "beam_azimuth_angles": [3.1, -3.1],
"imu_to_sensor_transform": [1, 0, 0, 6.253, 0, 1, 0, -11.775, 0, 0, 1, 7.645, 0, 0, 0, 1],
"lidar_to_sensor_transform": [-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 36.18, 0, 0, 0, 1]}"#;

/// Firmware 3.2: in parts. Shortened.
const NESTED: &str = r#"{"beam_intrinsics": {"beam_to_lidar_transform": [1.0, 0.0, 0.0, 27.116, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0],
"lidar_origin_to_beam_origin_mm": 27.116, "beam_altitude_angles": [45.1, "x"]}, "config_params": {"lidar_frame_azimuth_offset": 0},
"lidar_data_format": {"columns_per_frame": 1024, "pixels_per_column": 128},
"lidar_intrinsics": {"lidar_to_sensor_transform": [-1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 38.195, 0.0, 0.0, 0.0, 1.0]},
"sensor_info": {"prod_line": "OS-0-128", "image_rev": "ousteros-image-prod-bootes-v3.2.0+20260204221027"}}"#;

#[test]
fn keys_beside_each_other_and_in_parts_say_the_same() {
    let (_, facts) = json(FLAT);
    let metadata = &facts.ousters[0];
    assert_eq!(metadata.product.as_deref(), Some("OS-1-16-A0"));
    assert_eq!(metadata.firmware.as_deref(), Some("v1.13.0"));
    assert_eq!(metadata.serial.as_deref(), Some("991937000062"));
    assert_eq!((metadata.beam_origin_mm.is_none(), metadata.columns), (true, None));
    assert_eq!(metadata.azimuths.as_ref().map(|angles| angles.count), Some(2));
    assert_eq!(facts.claims.len(), 2);

    let (_, facts) = json(NESTED);
    let metadata = &facts.ousters[0];
    assert_eq!(metadata.product.as_deref(), Some("OS-0-128"));
    assert_eq!(
        metadata.beam_origin_mm.as_ref().map(|stated| stated.value),
        Some(27.116)
    );
    assert_eq!(
        metadata.azimuth_offset_mdeg.as_ref().map(|stated| stated.value),
        Some(0.0)
    );
    assert_eq!((metadata.columns, metadata.rows), (Some(1024), Some(128)));
    let altitudes = metadata.altitudes.as_ref().unwrap();
    assert_eq!((altitudes.count, altitudes.broken), (2, 1));
    let beam = facts
        .claims
        .iter()
        .find(|claim| claim.label.ends_with("beam_to_lidar_transform"))
        .unwrap();
    assert!((beam.pose.unwrap().translation_m[0] - 0.027_116).abs() < 1e-12);
}

#[test]
fn what_is_cut_off_is_read_as_far_as_it_goes_and_what_is_no_ousters_is_none() {
    let (source, facts) = json(&FLAT[..FLAT.len() - 40]);
    assert_eq!(source.status, ReadStatus::Partial);
    assert_eq!(facts.ousters[0].product.as_deref(), Some("OS-1-16-A0"));
    assert_eq!(facts.claims.len(), 1);
    assert!(
        json(r#"{"prod_line": "a car", "columns": [1, 2]}"#)
            .1
            .ousters
            .is_empty()
    );
    assert!(may_be_ouster(FLAT) && may_be_ouster(NESTED));
    assert!(!may_be_ouster("lidar_to_sensor_transform") && !may_be_ouster("") && !may_be_ouster("{}"));
}

/// Of every file: the transforms, where they are stated, are those of a row of the table for its model.
#[test]
fn the_metadata_of_the_corpus_are_those_of_the_table() {
    use crate::tables::{OusterPart, Tables};
    let Some(folder) = crate::read::at_hand::corpus() else {
        return;
    };
    let (tables, mut seen) = (Tables::default(), 0);
    for (path, _, facts) in super::corpus::read_all(&folder.join("ouster_meta")) {
        assert_eq!(facts.ousters.len(), 1, "{path}");
        let metadata = &facts.ousters[0];
        for claim in &facts.claims {
            let part = match claim.label.rsplit('/').next() {
                Some("lidar_to_sensor_transform") => OusterPart::Lidar,
                Some("imu_to_sensor_transform") => OusterPart::Imu,
                Some("beam_to_lidar_transform") => OusterPart::Beam,
                _ => continue,
            };
            seen += 1;
            let place_mm = claim.pose.unwrap().translation_m.map(|metres| metres * 1e3);
            let near =
                |row: &&crate::tables::OusterPlace| row.xyz_mm.iter().zip(place_mm).all(|(a, b)| (a - b).abs() < 1e-6);
            let mut rows = tables.ouster_places(part).filter(near);
            let fits = rows.any(|row| row.may_be_of(metadata.product.as_deref(), metadata.image.as_deref()));
            assert!(fits, "{path} {}", claim.label);
        }
    }
    assert!(seen > 60, "{seen}");
}
