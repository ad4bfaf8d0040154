//! The layout of the viewer's window: space at the left; plots, log and page at the right; which views are shown first, the camera
//! position, and the time range that plays.

use rerun::external::re_log_types::{BlueprintActivationCommand, LogMsg};
use rerun::external::re_sdk_types::blueprint::archetypes::{
    ContainerBlueprint, EntityBehavior, EyeControls3D, PanelBlueprint, TimePanelBlueprint, ViewBlueprint, ViewContents,
    ViewportBlueprint, VisualBounds2D,
};
use rerun::external::re_sdk_types::blueprint::components::{
    AutoLayout, AutoViews, ColumnShare, ContainerKind, IncludedContent, LoopMode, PanelState, PlayState,
    QueryExpression, RootContainer, RowShare, TimelineName, ViewClass,
};
use rerun::external::re_sdk_types::components::{Name, Position3D, Visible};
use rerun::external::re_sdk_types::datatypes::{AbsoluteTimeRange, Float32, Range2D, Uuid};
use rerun::{EntityPath, RecordingStream, RecordingStreamBuilder, RecordingStreamResult};
use sha2::{Digest, Sha256};

use crate::view::scene::{Kind, Scene, View};

use super::{APPLICATION, TIMELINE, entity};

/// The viewer cannot open at a time, only at a time range that plays in a loop: one from the worst finding on, too short for things to
/// move away, nanoseconds.
const LOOP_NS: i64 = 100_000_000;

/// Sends the layout of a scene to the destination of its recording. `id` distinguishes it from the layouts of other recordings.
pub(super) fn send(scene: &Scene, id: &str, stream: &RecordingStream) -> RecordingStreamResult<()> {
    let (own, storage) = RecordingStreamBuilder::new(APPLICATION)
        .recording_id(id)
        .blueprint()
        .memory()?;
    own.set_time_sequence("blueprint", 0);
    window(scene, &own)?;
    let messages = storage.take();
    let store = messages.iter().find_map(|message| match message {
        LogMsg::SetStoreInfo(info) => Some(info.info.store_id.clone()),
        _ => None,
    });
    if let Some(blueprint_id) = store {
        let activation = BlueprintActivationCommand {
            blueprint_id,
            make_active: true,
            make_default: true,
        };
        stream.send_blueprint(messages, activation);
    }
    Ok(())
}

fn window(scene: &Scene, own: &RecordingStream) -> RecordingStreamResult<()> {
    let of = |kinds: &[Kind]| -> RecordingStreamResult<Vec<String>> {
        let views = scene.views.iter().enumerate();
        let views = views.filter(|(_, view)| kinds.contains(&view.kind));
        views.map(|(number, known)| view(number, known, own)).collect()
    };
    let tabs = |name: &str, contents: Vec<String>| -> RecordingStreamResult<Option<String>> {
        if contents.is_empty() {
            return Ok(None);
        }
        let known = ContainerBlueprint::new(ContainerKind::Tabs).with_contents(included(contents));
        container(name, &known, own).map(|(path, _)| Some(path))
    };
    let space = tabs("space", of(&[Kind::Space])?)?;
    let plotted = tabs("plots", of(&[Kind::Plane, Kind::Time])?)?;
    let words = tabs("words", of(&[Kind::Page, Kind::Log])?)?;
    let right: Vec<String> = [plotted, words].into_iter().flatten().collect();
    let shares = right.iter().map(|_| RowShare(Float32(1.0)));
    let known = ContainerBlueprint::new(ContainerKind::Vertical).with_row_shares(shares.collect::<Vec<_>>());
    let (right, _) = container("right", &known.with_contents(included(right)), own)?;
    let whole: Vec<String> = space.into_iter().chain([right]).collect();
    let shares = [3.0, 2.0].map(|share| ColumnShare(Float32(share)));
    let known = ContainerBlueprint::new(ContainerKind::Horizontal).with_col_shares(shares);
    let (_, root) = container("whole", &known.with_contents(included(whole)), own)?;
    own.log(
        "viewport",
        &ViewportBlueprint::new()
            .with_root_container(RootContainer(root))
            .with_auto_layout(AutoLayout(false.into()))
            .with_auto_views(AutoViews(false.into())),
    )?;
    own.log(
        "selection_panel",
        &PanelBlueprint::new().with_state(PanelState::Collapsed),
    )?;
    let mut time = TimePanelBlueprint::new().with_state(PanelState::Collapsed);
    if scene.items.iter().any(|item| item.stamp_ns.is_some()) {
        time = time.with_timeline(TimelineName(TIMELINE.into()));
    }
    if let Some(at_ns) = scene.at_ns {
        let around = AbsoluteTimeRange {
            min: at_ns.into(),
            max: at_ns.saturating_add(LOOP_NS).into(),
        };
        time = time
            .with_time_selection(around)
            .with_loop_mode(LoopMode::Selection)
            .with_play_state(PlayState::Playing);
    }
    own.log("time_panel", &time)
}

fn included(paths: Vec<String>) -> Vec<IncludedContent> {
    paths.into_iter().map(|path| IncludedContent(path.into())).collect()
}

/// Adds a container to the layout; returns its path and its identity.
fn container(name: &str, known: &ContainerBlueprint, own: &RecordingStream) -> RecordingStreamResult<(String, Uuid)> {
    let (words, uuid) = identity(name);
    let path = format!("container/{words}");
    own.log(path.as_str(), known)?;
    Ok((path, uuid))
}

/// Adds a view to the layout; returns its path.
fn view(number: usize, view: &View, own: &RecordingStream) -> RecordingStreamResult<String> {
    let (words, _) = identity(&format!("view {number}"));
    let path = format!("view/{words}");
    let class = match view.kind {
        Kind::Space => "3D",
        Kind::Plane => "2D",
        Kind::Time => "TimeSeries",
        Kind::Log => "TextLog",
        Kind::Page => "TextDocument",
    };
    let known = ViewBlueprint::new(ViewClass(class.into()))
        .with_display_name(Name(view.name.as_str().into()))
        .with_space_origin(entity(&view.origin).to_string());
    own.log(path.as_str(), &known)?;
    let shown = QueryExpression(format!("+ {}/**", entity(&view.origin)).into());
    own.log(format!("{path}/ViewContents"), &ViewContents::new([shown]))?;
    if let Some(eye) = &view.eye {
        let controls = EyeControls3D::new()
            .with_position(Position3D::from(eye.at_m))
            .with_look_target(Position3D::from(eye.target_m));
        own.log(format!("{path}/EyeControls3D"), &controls)?;
    }
    if let Some([x_range, y_range]) = view.bounds {
        let bounds = VisualBounds2D::new(Range2D {
            x_range: x_range.map(f64::from).into(),
            y_range: y_range.map(f64::from).into(),
        });
        own.log(format!("{path}/VisualBounds2D"), &bounds)?;
    }
    for hidden in &view.hidden {
        let behavior = EntityBehavior::new().with_visible(Visible(false.into()));
        let overrides = EntityPath::from(format!("{path}/ViewContents/overrides"));
        let place = overrides.join(&entity(hidden)).join(&EntityPath::from("visualizers"));
        own.log(place, &behavior)?;
    }
    Ok(path)
}

/// A stable identity of a part of the window, as text and in the viewer's form.
fn identity(name: &str) -> (String, Uuid) {
    let digest = Sha256::digest(name.as_bytes());
    let mut bytes = [0; 16];
    for (byte, of) in bytes.iter_mut().zip(digest) {
        *byte = of;
    }
    let hex = format!("{:032x}", u128::from_be_bytes(bytes));
    let parts = [0..8, 8..12, 12..16, 16..20, 20..32].map(|part| hex.get(part).unwrap_or_default().to_owned());
    (parts.join("-"), Uuid { bytes })
}
