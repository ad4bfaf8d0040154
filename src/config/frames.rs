//! The keys `aliases` and `transforms` of the configuration: the platform's frames for names and for transforms in files.

use crate::read::calibration::document::Node;
use crate::world::FrameId;
use crate::world::conventions::{Alias, DeclaredTransform};

use super::ConfigError;
use super::reader::Reader;

impl Reader<'_> {
    /// `velodyne: [lidar, velo]`.
    pub(super) fn aliases(&self, root: &Node) -> Result<Vec<Alias>, ConfigError> {
        let Some(map) = root.get("aliases") else {
            return Ok(Vec::new());
        };
        if !map.is_mapping() {
            let what = "`aliases` must map each frame of the platform to the names that files use for it: `velodyne: [lidar, velo]`";
            return Err(self.error(map.span.start, what));
        }
        let mut aliases: Vec<Alias> = Vec::new();
        for (key, value) in map.pairs() {
            let frame = FrameId::new(key.text().unwrap_or_default()).canonical();
            let names: Vec<&Node> = value
                .items()
                .map_or_else(|| vec![value], |items| items.iter().collect());
            for node in names {
                let text = node.text().filter(|text| !text.is_empty());
                let text = text.ok_or_else(|| self.error(node.span.start, "expected the name of a frame"))?;
                let name = FrameId::new(text).canonical();
                if let Some(other) = aliases.iter().find(|other| other.name == name) {
                    let what = format!("`{name}` is already an alias of `{}`", other.frame);
                    return Err(self.error(node.span.start, &what));
                }
                aliases.push(Alias {
                    file: None,
                    name,
                    frame: frame.clone(),
                    origin: self.origin(node, false),
                });
            }
        }
        Ok(aliases)
    }

    /// `- {file: a.yaml, key: extrinsic, is: imu from lidar}`.
    pub(super) fn transforms(&self, root: &Node) -> Result<Vec<DeclaredTransform>, ConfigError> {
        let Some(list) = root.get("transforms") else {
            return Ok(Vec::new());
        };
        let what = "`transforms` must be a list: `- {file: a.yaml, key: extrinsic, is: imu from lidar}`";
        let items = list.items().ok_or_else(|| self.error(list.span.start, what))?;
        let one = |item: &Node| {
            self.keys(item, &["file", "key", "is"])?;
            let key = self.glob(item, "key")?;
            let is = item
                .get("is")
                .and_then(Node::text)
                .and_then(|text| text.split_once(" from "));
            match (key, is) {
                (Some(key), Some((target, source))) => Ok(DeclaredTransform {
                    file: self.glob(item, "file")?,
                    key,
                    target: FrameId::new(target.trim()).canonical(),
                    source: FrameId::new(source.trim()).canonical(),
                    origin: self.origin(item, false),
                }),
                (None, _) => Err(self.error(
                    item.span.start,
                    "`key` is missing: the key of the transform in the file",
                )),
                (_, None) => Err(self.error(item.span.start, "`is: TARGET from SOURCE` is missing")),
            }
        };
        items.iter().map(one).collect()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use std::path::Path;

    use super::super::{parse, tests::fault};
    use super::*;

    #[test]
    fn aliases_and_transforms_are_read() {
        let text = "aliases:\n  velodyne: [lidar, /velo]\n  imu_link: imu\ntransforms:\n  - {file: '*.yaml', key: 'a/*', is: imu from lidar}\n";
        let config = parse("c.yaml", text.to_owned(), Path::new("")).unwrap();
        let conventions = config.conventions(None);
        let frame = |name: &str| {
            conventions
                .frame_of("a.yaml", &FrameId::new(name))
                .map(ToString::to_string)
        };
        assert_eq!(frame("velo").as_deref(), Some("velodyne"));
        assert_eq!(frame("/imu").as_deref(), Some("imu_link"));
        assert_eq!(frame("velodyne"), None);
        let stated = conventions.transform_of("robot/fast.yaml", "a/extrinsic").unwrap();
        assert_eq!((stated.0.as_str(), stated.1.as_str()), ("imu", "lidar"));
        assert!(conventions.transform_of("robot/fast.yaml", "b/extrinsic").is_none());
        assert!(fault("aliases: [a]\n").contains("must map each frame of the platform"));
        assert!(fault("aliases: {a: [c], b: [c]}\n").contains("`c` is already an alias of `a`"));
        assert!(fault("transforms: [{key: a, is: b}]\n").contains("TARGET from SOURCE"));
        assert!(fault("transforms: [{is: b from c}]\n").contains("`key` is missing"));
    }
}
