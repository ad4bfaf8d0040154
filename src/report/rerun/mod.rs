//! A scene as a recording of the Rerun viewer (<https://rerun.io>): the only module that uses it. Compiled with the feature `rerun`.

#![allow(clippy::cast_possible_truncation)] // the viewer takes single numbers

mod layout;

use std::collections::BTreeMap;
use std::path::Path as FilePath;

use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use nalgebra::Isometry3;
use rerun::{
    AsComponents, EntityPath, EntityPathPart, RecordingStream, RecordingStreamBuilder, RecordingStreamResult,
    SerializedComponentBatch, TimeColumn,
};
use sha2::{Digest, Sha256};

use crate::view::scene::{Body, Color, Content, Drawing, Item, Level, Lines, Path, Points, Scene, WORLD};

/// The timeline: header stamps; log times for messages without a header.
pub const TIMELINE: &str = "stamp";

/// The program's name in the viewer.
const APPLICATION: &str = "frames-lint";

/// The destination of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sink<'a> {
    /// A file.
    File(&'a FilePath),
    /// A viewer that is started: the program `rerun`.
    Spawn,
    /// A viewer that is running, by its URL.
    Connect(&'a str),
}

/// Writes a scene with the title `name`. The same scene has the same identity in the viewer.
///
/// # Errors
///
/// The message of the viewer's library if the scene cannot be written, or the viewer does not answer.
pub fn write(scene: &Scene, name: &str, sink: Sink) -> Result<(), String> {
    let id = Sha256::digest(name.as_bytes());
    let id = URL_SAFE_NO_PAD.encode(id.get(..9).unwrap_or_default());
    let builder = RecordingStreamBuilder::new(APPLICATION)
        .recording_id(id.as_str())
        .send_properties(false);
    let stream = match sink {
        Sink::File(path) => builder.save(path),
        Sink::Spawn => builder.spawn(),
        Sink::Connect(url) => builder.connect_grpc_opts(url),
    };
    let text = |error: rerun::RecordingStreamError| error.to_string();
    let stream = stream.map_err(text)?;
    stream.set_log_time_enabled(false);
    stream.set_log_tick_enabled(false);
    layout::send(scene, &format!("layout-{id}"), &stream).map_err(text)?;
    stream.send_recording_name(name).map_err(text)?;
    items(scene, &stream).map_err(text)?;
    stream.flush_blocking().map_err(|error| error.to_string())
}

fn entity(path: &Path) -> EntityPath {
    EntityPath::new(
        path.names()
            .iter()
            .map(|name| EntityPathPart::new(name.clone()))
            .collect(),
    )
}

fn items(scene: &Scene, stream: &RecordingStream) -> RecordingStreamResult<()> {
    stream.log_static(WORLD, &rerun::ViewCoordinates::RIGHT_HAND_Z_UP())?;
    // Data with many samples are sent in columns, and constant data of an entity together: each row costs more than its numbers.
    let mut poses: BTreeMap<&Path, Vec<(i64, &Isometry3<f64>)>> = BTreeMap::new();
    let mut numbers: BTreeMap<&Path, Vec<(i64, f64)>> = BTreeMap::new();
    let mut always: BTreeMap<&Path, BTreeMap<String, SerializedComponentBatch>> = BTreeMap::new();
    for item in &scene.items {
        match (&item.what, item.stamp_ns) {
            (Content::Pose(pose), Some(stamp_ns)) => poses.entry(&item.path).or_default().push((stamp_ns, pose)),
            (Content::Number(value), Some(stamp_ns)) => numbers.entry(&item.path).or_default().push((stamp_ns, *value)),
            (_, Some(stamp_ns)) => {
                stream.set_timestamp_nanos_since_epoch(TIMELINE, stamp_ns);
                stream.log_serialized_batches(entity(&item.path), false, batches(item))?;
            }
            (_, None) => {
                let named = batches(item)
                    .into_iter()
                    .map(|batch| (batch.descriptor.to_string(), batch));
                always.entry(&item.path).or_default().extend(named);
            }
        }
    }
    stream.reset_time();
    for (path, batches) in always {
        stream.log_serialized_batches(entity(path), true, batches.into_values())?;
    }
    for (path, poses) in poses {
        let translations = poses.iter().map(|(_, pose)| translation(pose));
        let rotations = poses.iter().map(|(_, pose)| quaternion(pose));
        let columns = rerun::Transform3D::update_fields()
            .with_many_translation(translations)
            .with_many_quaternion(rotations)
            .columns_of_unit_batches()?;
        let stamps = times(poses.iter().map(|(stamp_ns, _)| *stamp_ns));
        stream.send_columns(entity(path), [stamps], columns)?;
    }
    for (path, numbers) in numbers {
        let columns = rerun::Scalars::new(numbers.iter().map(|(_, value)| *value)).columns_of_unit_batches()?;
        let stamps = times(numbers.iter().map(|(stamp_ns, _)| *stamp_ns));
        stream.send_columns(entity(path), [stamps], columns)?;
    }
    Ok(())
}

fn times(stamps_ns: impl Iterator<Item = i64>) -> TimeColumn {
    TimeColumn::new_timestamp_nanos_since_epoch(TIMELINE, stamps_ns)
}

fn translation(pose: &Isometry3<f64>) -> [f32; 3] {
    let at = pose.translation.vector;
    [at.x as f32, at.y as f32, at.z as f32]
}

fn quaternion(pose: &Isometry3<f64>) -> rerun::Quaternion {
    let q = pose.rotation.coords;
    rerun::Quaternion::from_xyzw([q.x as f32, q.y as f32, q.z as f32, q.w as f32])
}

fn color([red, green, blue]: Color) -> rerun::Color {
    rerun::Color::from_rgb(red, green, blue)
}

/// Metres; negative: points of the screen.
fn radius(value: f32) -> rerun::Radius {
    if value < 0.0 {
        rerun::Radius::new_ui_points(-value)
    } else {
        rerun::Radius::new_scene_units(value)
    }
}

/// An item in the viewer's form.
fn batches(item: &Item) -> Vec<SerializedComponentBatch> {
    let shown = |what: &dyn rerun::AsComponents| what.as_serialized_batches();
    match &item.what {
        Content::Pose(pose) => shown(&rerun::Transform3D::from_translation_rotation(
            translation(pose),
            quaternion(pose),
        )),
        Content::Axes(length_m) => shown(&rerun::TransformAxes3D::new(*length_m)),
        Content::Points(points) => shown(&of_points(points)),
        Content::Lines(lines) => shown(&of_lines(lines)),
        Content::Body(body) => of_body(body),
        Content::Camera([a, b, c, d, e, f, g, h, i], resolution) => {
            // Column by column.
            let image_from_camera = rerun::Mat3x3([*a, *d, *g, *b, *e, *h, *c, *f, *i]);
            shown(
                &rerun::Pinhole::new(image_from_camera)
                    .with_resolution(*resolution)
                    .with_camera_xyz(rerun::components::ViewCoordinates::RDF),
            )
        }
        Content::Pixels(points) => shown(
            &rerun::Points2D::new(points.xyz_m.iter().map(|[x, y, _]| [*x, *y]))
                .with_radii([radius(points.radius)])
                .with_colors(points.colors.iter().map(|of| color(*of))),
        ),
        Content::Drawing(drawing) => of_drawing(drawing),
        Content::Number(value) => shown(&rerun::Scalars::single(*value)),
        Content::Curve(name, of, true) => shown(
            &rerun::SeriesLines::new()
                .with_names([name.as_str()])
                .with_colors([color(*of)]),
        ),
        Content::Curve(name, of, false) => shown(
            &rerun::SeriesPoints::new()
                .with_names([name.as_str()])
                .with_colors([color(*of)]),
        ),
        Content::Log(level, text) => shown(&rerun::TextLog::new(text.as_str()).with_level(match level {
            Level::Info => rerun::TextLogLevel::INFO,
            Level::Warning => rerun::TextLogLevel::WARN,
            Level::Error => rerun::TextLogLevel::ERROR,
        })),
        Content::Page(text) => shown(&rerun::TextDocument::from_markdown(text.as_str())),
    }
}

fn of_points(points: &Points) -> rerun::Points3D {
    let drawn = rerun::Points3D::new(points.xyz_m.iter().copied())
        .with_radii([radius(points.radius)])
        .with_colors(points.colors.iter().map(|of| color(*of)));
    if points.labels.is_empty() {
        drawn
    } else {
        drawn
            .with_labels(points.labels.iter().map(String::as_str))
            .with_show_labels(true)
    }
}

fn of_lines(lines: &Lines) -> rerun::LineStrips3D {
    let drawn = rerun::LineStrips3D::new(lines.strips_m.iter().map(|strip| strip.iter().copied()))
        .with_radii([radius(lines.radius)])
        .with_colors([color(lines.color)]);
    if lines.labels.is_empty() {
        drawn
    } else {
        drawn
            .with_labels(lines.labels.iter().map(String::as_str))
            .with_show_labels(true)
    }
}

fn of_body(body: &Body) -> Vec<SerializedComponentBatch> {
    match body {
        Body::Mesh(file, scale) => {
            // If a mesh file no longer exists, its frame is still shown.
            let Ok(asset) = rerun::Asset3D::from_file_path(&file.path) else {
                return Vec::new();
            };
            let mut batches = rerun::InstancePoses3D::new()
                .with_scales([*scale])
                .as_serialized_batches();
            batches.extend(asset.as_serialized_batches());
            batches
        }
        Body::Box(sides_m) => rerun::Boxes3D::from_sizes([*sides_m]).as_serialized_batches(),
        Body::Cylinder(radius_m, length_m) => {
            rerun::Cylinders3D::from_lengths_and_radii([*length_m], [*radius_m]).as_serialized_batches()
        }
        Body::Sphere(radius_m) => rerun::Ellipsoids3D::from_radii([*radius_m]).as_serialized_batches(),
    }
}

/// The viewer's planes have y down.
fn of_drawing(drawing: &Drawing) -> Vec<SerializedComponentBatch> {
    let flipped = |strip: &[[f32; 2]]| -> Vec<[f32; 2]> { strip.iter().map(|[x, y]| [*x, -y]).collect() };
    let label = drawing.label.as_str();
    if drawing.is_line {
        let lines = rerun::LineStrips2D::new(drawing.strips.iter().map(|strip| flipped(strip)));
        let lines = lines.with_colors([color(drawing.color)]).with_radii([radius(-1.0)]);
        return lines.as_serialized_batches();
    }
    let points: Vec<[f32; 2]> = drawing.strips.iter().flat_map(|strip| flipped(strip)).collect();
    let points = rerun::Points2D::new(points)
        .with_colors([color(drawing.color)])
        .with_radii([radius(-1.5)]);
    if label.is_empty() {
        points.as_serialized_batches()
    } else {
        points
            .with_labels([label])
            .with_show_labels(true)
            .as_serialized_batches()
    }
}
