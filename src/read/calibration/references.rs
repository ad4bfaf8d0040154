//! References from one file to a calibration file: `relative_config_imucam: "kalibr_imucam_chain.yaml"`.
//!
//! Owns what counts as such a reference. The caller, which knows the folder, checks whether the file exists.

use crate::source::{Place, SourceId, SourceValue};
use crate::world::{FileReference, FrameId, ReferenceState};

use super::document::{Kind, Node};

/// Endings of files that may hold extrinsics.
const ENDINGS: &[&str] = &[".yaml", ".yml", ".json", ".urdf", ".xacro"];

/// Words of a key, or of the file's name, that make a path a path to a calibration.
const WORDS: &[&str] = &[
    "calib",
    "calibration",
    "extrinsic",
    "extrinsics",
    "camchain",
    "imucam",
    "kalibr",
];

/// All references of a document. Paths with substitutions are skipped: their files cannot be known.
pub(super) fn collect(root: &Node, source: SourceId) -> Vec<FileReference> {
    let mut found = Vec::new();
    let mut stack = vec![root];
    while let Some(node) = stack.pop() {
        match &node.kind {
            Kind::Mapping(pairs) => {
                for (key, value) in pairs {
                    if let (Some(key), Some(path)) = (key.text(), value.text())
                        && is_reference(key, path)
                    {
                        found.push(FileReference {
                            key: key.to_owned(),
                            path: SourceValue::new(path.to_owned(), Place::text(source, value.span)),
                            state: ReferenceState::Unknown,
                        });
                    }
                    stack.push(value);
                }
            }
            Kind::Sequence(items) => stack.extend(items),
            Kind::Scalar { .. } => {}
        }
    }
    found.sort_by(|a, b| a.path.place.cmp(&b.path.place));
    found
}

fn is_reference(key: &str, path: &str) -> bool {
    let lower = path.to_lowercase();
    let is_file = ENDINGS.iter().any(|ending| lower.ends_with(ending)) && !path.contains(['$', '{', '*', '\n']);
    let names = |text: &str| {
        FrameId::new(text)
            .tokens()
            .iter()
            .any(|token| WORDS.contains(&token.as_str()))
    };
    is_file && (names(key) || names(path))
}
