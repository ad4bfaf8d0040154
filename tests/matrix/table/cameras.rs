//! Errors of optical frames, and of cameras that are staged in them.

use frames_lint::faults::Fault;
use nalgebra::{Isometry3, Vector3};

use super::StagedFault;
use crate::cameras::{self, CAMERA, STEREO};
use crate::errors::Change;
use crate::lidars::turn;

pub static ERRORS: &[StagedFault] = &[
    error!(
        "optical not rotated",
        Change::Frames(|_| Isometry3::identity()),
        ["optical"],
        [],
        ["NAME06", "CAMERA01"]
    ),
    error!(
        "optical reversed",
        Change::Frames(|told| told.inverse()),
        ["inverse", "optical-inverse"],
        [],
        ["NAME06", "CAMERA01"]
    ),
    error!(
        "optical upside down",
        Change::Frames(|told| told * turn(Vector3::z(), 180.0)),
        ["upside-down", "z180"],
        [],
        ["NAME06", "CAMERA01"]
    ),
    error!(
        "stereo pair swapped",
        Change::Staged(&STEREO, cameras::swap_pair),
        ["swapped"],
        [],
        ["CAMERA07"]
    ),
    error!(
        "K not rescaled",
        Change::Staged(&CAMERA, cameras::shrink),
        ["not-rescaled"],
        [],
        ["CAMERA02"]
    ),
];
