//! Faults of a bird's-eye grid: of its declaration alone, and compared with its messages. Must not judge.

use serde::Deserialize;

use crate::analysis::{camera::declared::is_about, camera::fault::Fault};
use crate::math::circular::difference;
use crate::source::Place;
use crate::verdict::Measured;
use crate::world::projection::{Axis, Cell, Grid, GridAt, Projection};
use crate::world::{World, bag::TopicEvidence};

fn resolution(resolution_m: f64, limits: &Limits) -> Option<Fault> {
    let is_sound = resolution_m.is_finite() && resolution_m > 0.0;
    (!is_sound || resolution_m > limits.max_resolution_m).then(|| {
        let (what, help) = if is_sound {
            (
                "resolution",
                "set the resolution to the side of a cell in metres, not to cells per metre or pixels",
            )
        } else {
            (
                "resolution, which must be above 0 m",
                "set the resolution to the side of a cell in metres, for example 0.05",
            )
        };
        let fault = Fault::new(
            "resolution",
            format!("the resolution of the grid is {resolution_m} m per cell"),
            help,
            Measured::new(what, resolution_m, "m").limit(limits.max_resolution_m),
        );
        if is_sound { fault } else { fault.error() }
    })
}

/// The faults of a grid message, and its tilt, degrees.
pub(crate) fn of_message(grid: &GridAt, limits: &Limits) -> (Vec<Fault>, f64) {
    let [x, y, z, w] = grid.orientation;
    let norm = (x * x + y * y + z * z + w * w).sqrt();
    let tilt_deg = (1.0 - 2.0 * (x * x + y * y) / (norm * norm))
        .clamp(-1.0, 1.0)
        .acos()
        .to_degrees();
    let count = grid.cells.iter().product::<f64>();
    let finite = grid.position.iter().all(|value| value.is_finite());
    let mut faults: Vec<Fault> = resolution(grid.resolution_m, limits).into_iter().collect();
    if !finite || (norm - 1.0).abs() > limits.max_norm || !norm.is_finite() {
        faults.push(
            Fault::new(
                "origin",
                format!("the origin of the grid is no valid pose: the norm of the quaternion is {norm:.3}"),
                "fill in the whole pose (w = 1 is the identity, a quaternion of zeros is invalid)",
                Measured::new("norm of the origin's quaternion", norm, "1").expected(1.0),
            )
            .detail(format!("The position of the origin is {:?}.", grid.position))
            .error(),
        );
    } else if tilt_deg > limits.max_tilt_deg {
        faults.push(Fault::new(
            "tilted",
            format!("the grid is tilted by {tilt_deg:.1} deg in its frame, but readers use x, y and yaw only"),
            "set only the yaw of the origin, and tilt the frame instead",
            Measured::new("tilt of the grid", tilt_deg, "deg").limit(limits.max_tilt_deg),
        ));
    }
    if let Some(data) = grid.data
        && (data as f64 - count).abs() > 0.5
    {
        faults.push(
            Fault::new(
                "size",
                format!(
                    "the grid states {} x {} cells, but its data have {data} cells",
                    grid.cells[0], grid.cells[1]
                ),
                "set width and height to the numbers of cells along x and y (the data are row by row, along x first)",
                Measured::new("cells of the data", data as f64, "count").expected(count),
            )
            .error(),
        );
    }
    (faults, tilt_deg)
}

/// The faults of a declaration alone.
pub(crate) fn of_declaration(projection: &Projection, grid: &Grid, limits: &Limits) -> Vec<Fault> {
    let of_cells = grid.resolution_m.and_then(|m| resolution(m, limits));
    let all = [
        of_cells,
        missing(projection, grid),
        origin(projection, grid),
        thresholds(grid),
        affine(grid, limits),
    ];
    all.into_iter().flatten().collect()
}

/// The missing parts of a declaration.
fn missing(projection: &Projection, grid: &Grid) -> Option<Fault> {
    let is_ours = projection.format == "frames-lint";
    let parts = [
        ("resolution", grid.resolution_m.is_none()),
        ("origin", grid.origin.is_empty()),
        ("frame", is_ours && grid.frame.is_none()),
        ("cell (centre or corner)", is_ours && grid.cell.is_none()),
        ("columns", is_ours && grid.columns.is_none()),
        ("rows", is_ours && grid.rows.is_none()),
        ("ego_motion", is_ours && grid.ego_motion.is_none()),
    ];
    let left: Vec<&str> = parts
        .iter()
        .filter(|(_, is_missing)| *is_missing)
        .map(|(what, _)| *what)
        .collect();
    (!left.is_empty()).then(|| {
        Fault::new(
            "incomplete",
            format!("the declaration of the grid lacks: {}", left.join(", ")),
            "declare frame, resolution, origin, cell (centre or corner), columns, rows and ego_motion",
            Measured::count("parts that are not declared", left.len()).limit(0.0),
        )
    })
}

fn origin(projection: &Projection, grid: &Grid) -> Option<Fault> {
    if grid.origin.is_empty() {
        return None;
    }
    let most = grid.origin.get(2).copied().unwrap_or(0.0).abs();
    if !grid.origin.iter().all(|value| value.is_finite()) || projection.format == "map_server" && grid.origin.len() != 3
    {
        let fault = Fault::new(
            "origin",
            format!("the origin of the grid is {:?}, not x, y and yaw", grid.origin),
            "write x and y of the lower left cell in metres, and the yaw in radians",
            Measured::count("numbers of the origin", grid.origin.len()).expected(3.0),
        );
        return Some(fault.error());
    }
    (most > std::f64::consts::TAU).then(|| {
        Fault::new(
            "degrees",
            format!("the yaw of the grid's origin is {most}: probably degrees, but radians are required"),
            "multiply the third number by pi / 180 (the third number is the yaw, not z)",
            Measured::new("yaw of the origin", most, "1").limit(std::f64::consts::TAU),
        )
    })
}

fn thresholds(grid: &Grid) -> Option<Fault> {
    let [occupied, free] = *grid.thresholds.as_slice() else {
        return None;
    };
    let is_sound = (0.0..=1.0).contains(&occupied) && (0.0..=1.0).contains(&free) && free < occupied;
    (!is_sound).then(|| {
        Fault::new(
            "thresholds",
            format!("the thresholds of the map are invalid: free below {free}, occupied above {occupied}"),
            "write shares from 0 to 1 with free_thresh below occupied_thresh (map_saver writes 0.196 and 0.65)",
            Measured::new("occupied threshold - free threshold", occupied - free, "1").at_least(0.0),
        )
    })
}

/// The declared map of cells to metres compared with the other parts of the declaration.
fn affine(grid: &Grid, limits: &Limits) -> Option<Fault> {
    let [a, b, c, d, e, f] = *grid.affine.as_slice() else {
        return None;
    };
    let (column, row) = ([a, d], [b, e]);
    let turn = a * e - b * d;
    let dot = |of: [f64; 2], axis: Axis| of[0] * axis.direction()[0] + of[1] * axis.direction()[1];
    let length = |of: [f64; 2]| of[0].hypot(of[1]);
    let determinant = Measured::new("determinant of the map of cells", turn, "1");
    if let (Some(columns), Some(rows)) = (grid.columns, grid.rows) {
        let [cx, cy] = columns.direction();
        let [rx, ry] = rows.direction();
        let declared = cx * ry - cy * rx;
        let along = |of, axis| dot(of, axis) > 0.7 * length(of);
        if !(along(column, columns) && along(row, rows)) {
            let (relation, what) = if along(column, rows) && along(row, columns) {
                ("swapped", "columns and rows are exchanged")
            } else if turn * declared < 0.0 {
                ("mirrored", "it is mirrored")
            } else {
                ("turned", "it is rotated by 90 or 180 deg")
            };
            return Some(
                Fault::new(
                    relation,
                    format!("the map of cells to metres contradicts the declared columns and rows: {what}"),
                    "correct one of the two: rows of arrays grow with y, rows of images downwards",
                    determinant.expected(declared),
                )
                .error(),
            );
        }
    }
    if let Some(resolution_m) = grid.resolution_m {
        let sides = [length(column), length(row)];
        if let Some(side) = sides
            .into_iter()
            .find(|side| (side / resolution_m - 1.0).abs() > limits.same)
        {
            return Some(
                Fault::new(
                    "resolution",
                    format!("the map of cells to metres has cells of {side} m, but the resolution is {resolution_m} m"),
                    "correct one of the two",
                    Measured::new("side of a cell", side, "m").expected(resolution_m),
                )
                .error(),
            );
        }
        if let ([x, y, ..], Some(cell)) = (grid.origin.as_slice(), grid.cell) {
            // The map takes the number of a cell to the point that `cell` says: origin is that of the first cell.
            let off = [(c - x) / resolution_m, (f - y) / resolution_m];
            let largest = off[0].abs().max(off[1].abs());
            if largest > 0.01 {
                let is_half = off.iter().all(|off| (off.abs() - 0.5).abs() < 0.01);
                let word = if cell == Cell::Corner { "corner" } else { "centre" };
                let fault = Fault::new(
                    if is_half { "half-cell" } else { "origin" },
                    format!("the origin of the grid is {largest:.2} cells off its map of cells to metres"),
                    "let origin and map mean the same point of a cell, its centre or its corner",
                    Measured::new("offset in cells", largest, "1").limit(0.01),
                );
                return Some(fault.detail(format!(
                    "The map puts the {word} of the first cell at {c}, {f}; the origin is {x}, {y}."
                )));
            }
        }
    }
    None
}

/// The grid messages: the place of one, and its difference.
pub(crate) fn against_messages(
    world: &World,
    projection: &Projection,
    grid: &Grid,
    limits: &Limits,
) -> Option<(Place, Option<Fault>)> {
    let topics = world
        .bags
        .iter()
        .flat_map(|bag| bag.topics.values().map(move |topic| (bag, topic)));
    let is_grid = |topic: &TopicEvidence| topic.message_type.ends_with("/OccupancyGrid");
    // A map file is about the map; cost maps have their own sizes.
    let is_map = |topic: &TopicEvidence| {
        projection.topic.is_some() || topic.topic.ends_with("map") && !topic.topic.contains("costmap")
    };
    let all: Vec<(Place, &GridAt, Option<&String>)> = topics
        .filter(|(_, topic)| is_grid(topic) && is_map(topic) && is_about(projection, topic))
        .flat_map(|(bag, topic)| {
            let grids = topic.content.grids.iter().flat_map(|grids| &grids.grids);
            let frame = topic
                .header_frames
                .keys()
                .next()
                .map(|frame| frame.canonical().as_str().to_owned());
            let differs = grid.frame.as_ref().filter(|stated| {
                frame
                    .as_ref()
                    .is_some_and(|frame| frame != stated.trim_start_matches('/'))
            });
            grids.map(move |grid| (Place::message(bag.source, grid.at.clone()), grid, differs))
        })
        .collect();
    let faults: Vec<(Place, Option<Fault>)> = all
        .into_iter()
        .map(|(place, sent, frame)| (place, differs(grid, sent, frame, limits)))
        .collect();
    // Of several grids, one that matches.
    let fits = faults.iter().position(|(_, fault)| fault.is_none());
    faults.into_iter().nth(fits.unwrap_or(0))
}

fn differs(grid: &Grid, sent: &GridAt, frame: Option<&String>, limits: &Limits) -> Option<Fault> {
    if let Some(frame) = frame {
        return Some(Fault::new(
            "frame",
            format!("the grid is declared in `{frame}`, but sent in another frame"),
            "declare the frame of the message header",
            Measured::count("frames that differ", 1).limit(0.0),
        ));
    }
    if let (Some(columns), Some(rows)) = (grid.columns, grid.rows)
        && (columns, rows) != (Axis::PlusX, Axis::PlusY)
    {
        return Some(
            Fault::new(
                "mirrored",
                "the declared columns and rows are not those of an OccupancyGrid (columns +x, rows +y)".to_owned(),
                "declare columns +x and rows +y; an image of it with row 0 at the top is flipped",
                Measured::count(
                    "axes that differ",
                    usize::from(columns != Axis::PlusX) + usize::from(rows != Axis::PlusY),
                )
                .limit(0.0),
            )
            .error(),
        );
    }
    let resolution_m = grid.resolution_m?;
    if (sent.resolution_m / resolution_m - 1.0).abs() > limits.same {
        return Some(Fault::new(
            "resolution",
            format!(
                "the cells are declared as {resolution_m} m wide, but sent as {} m",
                sent.resolution_m
            ),
            "use the declaration that belongs to this map: one of the two is of another map or version",
            Measured::new("resolution as sent", sent.resolution_m, "m").expected(resolution_m),
        ));
    }
    let [x, y, rest @ ..] = grid.origin.as_slice() else {
        return None;
    };
    let off = [sent.position[0] - x, sent.position[1] - y].map(|m| m / resolution_m);
    let [.., z, w] = sent.orientation;
    let yaw = 2.0 * z.atan2(w);
    let off_yaw = rest.first().map_or(0.0, |stated| difference(yaw, *stated).abs());
    let largest = off[0].abs().max(off[1].abs());
    if largest <= 0.01 && off_yaw <= 1e-3 {
        return None;
    }
    let near = |value: f64, wanted: f64| (value - wanted).abs() <= 0.02 * wanted.abs().max(1.0);
    let [_, height] = sent.cells;
    let (relation, what) = if largest <= 0.01 {
        ("yaw", "The yaws differ.")
    } else if near(off[0].abs(), 0.5) && near(off[1].abs(), 0.5) {
        (
            "half-cell",
            "One is the corner of the first cell, the other its centre.",
        )
    } else if near(off[0], 0.0) && near(off[1].abs(), height) {
        (
            "upper-left",
            "One of the two is the upper left corner, and the other is the lower left corner.",
        )
    } else if near(sent.position[0], *y) && near(sent.position[1], *x) {
        ("swapped", "x and y are exchanged.")
    } else {
        ("origin", "One of the two is probably of another map or version.")
    };
    let fault = Fault::new(
        relation,
        format!(
            "the declared origin of the grid is {largest:.2} cells and {:.2} deg off the published origin",
            off_yaw.to_degrees()
        ),
        "declare the lower left corner of the first cell as x, y and yaw in the map's frame",
        Measured::new("offset in cells", largest, "1").limit(0.01),
    );
    let detail = format!(
        "Declared origin: {x}, {y}. Published origin: {}, {}. {what}",
        sent.position[0], sent.position[1]
    );
    Some(fault.detail(detail))
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limits {
    pub(crate) max_resolution_m: f64,
    pub(crate) same: f64,
    pub(crate) max_norm: f64,
    pub(crate) max_tilt_deg: f64,
    pub(crate) max_pixels: u32,
}
