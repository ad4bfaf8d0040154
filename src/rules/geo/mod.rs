//! GEO: positions on the earth.

pub mod altitude_datum;
mod apart;
mod columns;
pub mod coordinate_kind;
mod curvature;
mod earth;
pub mod ecef_enu_rotation;
mod fixes;
mod grid;
pub mod grid_convergence_scale;
mod heights;
mod kind_findings;
mod kinds;
mod level;
pub mod navsatfix_sanity;
pub mod origin_consistency;
mod origins;
mod overlay;
mod own_origin;
mod plane;
pub mod tangent_plane_range;

pub(crate) use fixes::some_position;
pub(crate) use kinds::is_earth_centred;
