//! The key `projections` of the configuration: the formulas by which programs build a range image, a grid or a panorama.
//!
//! ```yaml
//! projections:
//!   - topic: /points              # a glob
//!     range_image:
//!       width: 1024               # columns
//!       height: 64                # rows
//!       fov_up_deg: 22.5          # elevation of the highest row
//!       fov_down_deg: -22.5
//!       azimuth: clockwise        # how it grows with the column, seen from above; or counter_clockwise
//!       seam: clamp               # what happens to a point whose formula gives column `width`: none, clamp, wrap
//!       beam_offset_mm: 15.806    # distance of the beams' origin from the axis of rotation
//!   - topic: /bev
//!     grid:
//!       frame: base_link
//!       resolution_m: 0.1
//!       origin: [-50, -50]        # x, y, and optionally a yaw in radians
//!       cell: corner              # the point of the first cell that is at the origin; or centre
//!       columns: +x               # direction in which they grow: +x, -x, +y, -y
//!       rows: +y
//!       ego_motion: compensated   # or raw
//!       affine: [0.1, 0, -50, 0, 0.1, -50]   # x = a col + b row + c, y = d col + e row + f
//!   - topic: /panorama/image_raw
//!     panorama: {width: 4096, height: 2048, azimuth: clockwise}
//! ```

use crate::read::calibration::document::Node;
use crate::source::Span;
use crate::world::projection::{Axis, Cell, EgoMotion, Form, Grid, Panorama, RangeImage, Seam, Sense};

use super::ConfigError;
use super::reader::Reader;

/// A declaration without the identity of its source.
#[derive(Clone, Debug)]
pub(super) struct ProjectionDraft {
    pub(super) topic: Option<String>,
    pub(super) form: Form,
    pub(super) span: Span,
}

const FORMS: &[&str] = &["range_image", "grid", "panorama"];
const RANGE_IMAGE: &[&str] = &[
    "width",
    "height",
    "fov_up_deg",
    "fov_down_deg",
    "azimuth",
    "seam",
    "beam_offset_mm",
];
const GRID: &[&str] = &[
    "frame",
    "resolution_m",
    "origin",
    "cell",
    "columns",
    "rows",
    "ego_motion",
    "affine",
];
const PANORAMA: &[&str] = &["width", "height", "azimuth"];

impl Reader<'_> {
    pub(super) fn projections(&self, root: &Node) -> Result<Vec<ProjectionDraft>, ConfigError> {
        let Some(list) = root.get("projections") else {
            return Ok(Vec::new());
        };
        let items = list.items().ok_or_else(|| {
            self.error(
                list.span.start,
                "`projections` must be a list: `- topic: /points` on one line, `range_image: {...}` below it",
            )
        })?;
        items.iter().map(|item| self.projection(item)).collect()
    }

    fn projection(&self, item: &Node) -> Result<ProjectionDraft, ConfigError> {
        self.keys(item, &["topic", "range_image", "grid", "panorama"])?;
        // Read only for its errors; it is matched later, when topics are known.
        self.glob(item, "topic")?;
        let topic = item.get("topic").and_then(Node::text).map(str::to_owned);
        let mut forms = FORMS.iter().filter_map(|key| Some((*key, item.get(key)?)));
        let (Some((key, node)), None) = (forms.next(), forms.next()) else {
            let what = "expected one of `range_image`, `grid` and `panorama`";
            return Err(self.error(item.span.start, what));
        };
        let form = match key {
            "range_image" => Form::RangeImage(self.range_image(node)?),
            "grid" => Form::Grid(self.grid(node)?),
            _ => Form::Panorama(self.panorama(node)?),
        };
        Ok(ProjectionDraft {
            topic,
            form,
            span: item.span,
        })
    }

    fn range_image(&self, node: &Node) -> Result<RangeImage, ConfigError> {
        self.keys(node, RANGE_IMAGE)?;
        Ok(RangeImage {
            width: self.whole(node, "width")?,
            height: self.whole(node, "height")?,
            fov_up_deg: self.number(node, "fov_up_deg")?,
            fov_down_deg: self.number(node, "fov_down_deg")?,
            azimuth: self.word(node, "azimuth", Sense::WORDS)?,
            seam: self.word(node, "seam", Seam::WORDS)?,
            beam_offset_mm: self.number(node, "beam_offset_mm")?,
        })
    }

    fn grid(&self, node: &Node) -> Result<Grid, ConfigError> {
        self.keys(node, GRID)?;
        Ok(Grid {
            frame: node.get("frame").and_then(Node::text).map(str::to_owned),
            resolution_m: self.number(node, "resolution_m")?,
            origin: self.list(node, "origin", &[2, 3])?,
            cell: self.word(node, "cell", Cell::WORDS)?,
            columns: self.word(node, "columns", Axis::WORDS)?,
            rows: self.word(node, "rows", Axis::WORDS)?,
            ego_motion: self.word(node, "ego_motion", EgoMotion::WORDS)?,
            affine: self.list(node, "affine", &[6])?,
            thresholds: Vec::new(),
        })
    }

    fn panorama(&self, node: &Node) -> Result<Panorama, ConfigError> {
        self.keys(node, PANORAMA)?;
        Ok(Panorama {
            width: self.whole(node, "width")?,
            height: self.whole(node, "height")?,
            azimuth: self.word(node, "azimuth", Sense::WORDS)?,
        })
    }

    fn whole(&self, item: &Node, key: &str) -> Result<Option<u32>, ConfigError> {
        let Some(value) = item.get(key) else { return Ok(None) };
        let number = value.text().and_then(|text| text.parse::<u32>().ok());
        let number = number.filter(|number| *number > 0);
        let number =
            number.ok_or_else(|| self.error(value.span.start, &format!("`{key}` must be a whole number above 0")))?;
        Ok(Some(number))
    }

    fn list(&self, item: &Node, key: &str, counts: &[usize]) -> Result<Vec<f64>, ConfigError> {
        let Some(value) = item.get(key) else {
            return Ok(Vec::new());
        };
        let items = value.items().filter(|items| counts.contains(&items.len()));
        let counts: Vec<String> = counts.iter().map(ToString::to_string).collect();
        let what = format!("`{key}` must be a list of {} numbers", counts.join(" or "));
        let items = items.ok_or_else(|| self.error(value.span.start, &what))?;
        items.iter().map(|item| self.one(item, key)).collect()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use std::path::Path;

    use super::super::parse;
    use crate::world::projection::{Axis, Form, Sense};

    #[test]
    fn every_form_is_read() {
        let text = "projections:\n  - topic: /points\n    range_image: {width: 1024, height: 64, fov_up_deg: 22.5, azimuth: clockwise, seam: none}\n  \
                    - topic: /bev\n    grid: {frame: base_link, origin: [-50, -50], cell: corner, columns: +x, rows: -y}\n  \
                    - panorama: {width: 2048, height: 1024}\n";
        let config = parse("c.yaml", text.to_owned(), Path::new("")).unwrap();
        let conventions = config.conventions(Some(3));
        let [points, bev, panorama] = conventions.projections.as_slice() else {
            panic!()
        };
        let Form::RangeImage(image) = &points.form else {
            panic!()
        };
        assert_eq!((image.width, image.azimuth), (Some(1024), Some(Sense::Clockwise)));
        let Form::Grid(grid) = &bev.form else { panic!() };
        assert_eq!(
            (grid.origin.as_slice(), grid.rows),
            ([-50.0, -50.0].as_slice(), Some(Axis::MinusY))
        );
        assert_eq!(
            (panorama.topic.as_deref(), points.topic.as_deref()),
            (None, Some("/points"))
        );
        assert!(config.conventions(None).projections.is_empty());
    }

    #[test]
    fn faults_have_a_place() {
        let fault = |text: &str| parse("c.yaml", text.to_owned(), Path::new("")).unwrap_err().0;
        assert!(fault("projections: {}\n").contains("must be a list"));
        assert!(fault("projections:\n  - topic: /a\n").contains("one of `range_image`"));
        assert!(
            fault("projections:\n  - grid: {rows: down}\n")
                .contains("`rows` must be one of +x, -x, +y, -y, not `down`")
        );
        assert!(fault("projections:\n  - grid: {affine: [1, 2]}\n").contains("a list of 6 numbers"));
        assert!(
            fault("projections:\n  - range_image: {width: -4}\n")
                .contains("c.yaml:2:26: `width` must be a whole number")
        );
        assert!(fault("projections:\n  - range_image: {fov: 3}\n").contains("unknown key `fov`"));
    }
}
