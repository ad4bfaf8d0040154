//! The angles of the beams of spinning lidars, as the vendors publish them for each model, and the unit of their distances.

pub(crate) mod hesai;
pub(crate) mod velodyne;

use hesai::{
    OT128_ANGLES, PANDAR40P_ANGLES, PANDAR64_ANGLES, QT64_ANGLES, QT128_ANGLES, XT16_ANGLES, XT32_ANGLES, XT32M_ANGLES,
};
use velodyne::{HDL32E_ANGLES, VLP16_ANGLES, VLP32C_ANGLES, VLS128_ANGLES};

/// What is known of the beams of one model.
#[derive(Clone, Copy)]
pub struct BeamModel {
    /// `Velodyne`.
    pub maker: &'static str,
    /// `VLP-16`, as its packets state it.
    pub name: &'static str,
    angles: Angles,
    /// Metres of one unit of distance, where the driver takes it from the calibration.
    pub resolution_m: Option<f64>,
}

#[derive(Clone, Copy)]
enum Angles {
    /// Elevation and azimuth by laser, degrees.
    Fine(&'static [(f64, f64)]),
    Coarse(&'static [(f32, f32)]),
    /// The first, with elevations times a factor.
    Scaled(&'static [(f64, f64)], f64),
    /// So many evenly spaced elevations, from one and with a step; azimuths are not compared.
    Even(usize, f64, f64),
    /// So many, different from sensor to sensor.
    Own(usize),
}

impl BeamModel {
    /// How many beams it has.
    pub fn count(&self) -> usize {
        match self.angles {
            Angles::Fine(table) | Angles::Scaled(table, _) => table.len(),
            Angles::Coarse(table) => table.len(),
            Angles::Even(count, ..) | Angles::Own(count) => count,
        }
    }

    /// The elevations by laser, degrees; empty where they differ from sensor to sensor.
    pub fn elevations_deg(&self) -> Vec<f64> {
        match self.angles {
            Angles::Fine(table) => table.iter().map(|beam| beam.0).collect(),
            Angles::Scaled(table, factor) => table.iter().map(|beam| beam.0 * factor).collect(),
            Angles::Coarse(table) => table.iter().map(|beam| f64::from(beam.0)).collect(),
            Angles::Even(count, first, step) => (0..u32::try_from(count).unwrap_or(0))
                .map(|laser| first + step * f64::from(laser))
                .collect(),
            Angles::Own(_) => Vec::new(),
        }
    }

    /// The azimuths by laser, degrees; empty where they are not known.
    pub fn azimuths_deg(&self) -> Vec<f64> {
        match self.angles {
            Angles::Fine(table) | Angles::Scaled(table, _) => table.iter().map(|beam| beam.1).collect(),
            Angles::Coarse(table) => table.iter().map(|beam| f64::from(beam.1)).collect(),
            Angles::Even(..) | Angles::Own(_) => Vec::new(),
        }
    }
}

/// All models.
pub fn models() -> impl Iterator<Item = BeamModel> {
    let velodyne = |name, angles, resolution_m| BeamModel {
        maker: "Velodyne",
        name,
        angles,
        resolution_m,
    };
    let hesai = |name, angles| BeamModel {
        maker: "Hesai",
        name,
        angles,
        resolution_m: None,
    };
    [
        velodyne("VLP-16", Angles::Fine(&VLP16_ANGLES), Some(0.002)),
        // User manual 63-9318: the elevations of the VLP-16 between -10 and 10 degrees.
        velodyne("VLP-16 Hi-Res", Angles::Scaled(&VLP16_ANGLES, 2.0 / 3.0), Some(0.002)),
        velodyne("HDL-32E", Angles::Fine(&HDL32E_ANGLES), Some(0.002)),
        velodyne("VLP-32C", Angles::Fine(&VLP32C_ANGLES), Some(0.004)),
        velodyne("HDL-64E", Angles::Own(64), Some(0.002)),
        // The driver has 0.004 m in its code, and its own calibration states 0.007 m.
        velodyne("VLS-128", Angles::Fine(&VLS128_ANGLES), None),
        hesai("Pandar40P", Angles::Coarse(&PANDAR40P_ANGLES)),
        hesai("Pandar64", Angles::Coarse(&PANDAR64_ANGLES)),
        hesai("PandarQT64", Angles::Coarse(&QT64_ANGLES)),
        hesai("PandarQT128", Angles::Coarse(&QT128_ANGLES)),
        hesai("PandarXT16", Angles::Coarse(&XT16_ANGLES)),
        hesai("PandarXT32", Angles::Coarse(&XT32_ANGLES)),
        hesai("PandarXT32M", Angles::Coarse(&XT32M_ANGLES)),
        hesai("Pandar128E4X", Angles::Coarse(&OT128_ANGLES)),
        // github.com/tier4/nebula, calibration/PandarAT128.csv.
        hesai("PandarAT128", Angles::Even(128, 12.93, -0.2)),
    ]
    .into_iter()
}
