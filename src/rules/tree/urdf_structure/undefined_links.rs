//! Names that joints use and no link has: one finding each, however many joints use it.

use std::collections::BTreeMap;

use crate::analysis::near::{Names, Reach};
use crate::analysis::spelling::loose;
use crate::source::SourceValue;
use crate::verdict::{Finding, Measured};
use crate::world::robot::{Joint, Link};
use crate::world::{FrameId, Robot};

/// Places that are shown beside the first one.
pub(crate) const MOST_SHOWN: usize = 5;

/// A name that joints use and no link has.
#[derive(Debug)]
pub(crate) struct UndefinedLink<'a> {
    /// The first joint that names it, its end there, and the name.
    pub first: (&'a Joint, &'static str, &'a SourceValue<String>),
    /// Other places that name it.
    others: Vec<&'a SourceValue<String>>,
    /// Whether any joint names it as its child.
    pub is_child: bool,
}

/// The names without a link, in file order. Empty names are TREE04's.
pub(crate) fn undefined<'a>(robot: &'a Robot, links: &BTreeMap<String, &Link>) -> Vec<UndefinedLink<'a>> {
    let mut missing: Vec<UndefinedLink> = Vec::new();
    let mut numbers: BTreeMap<&str, usize> = BTreeMap::new();
    for joint in &robot.joints {
        for (end, role) in [(&joint.parent, "parent"), (&joint.child, "child")] {
            let Some(link) = end else { continue };
            if link.value.is_empty() || links.contains_key(&loose(&link.value)) {
                continue;
            }
            let number = *numbers.entry(&link.value).or_insert(missing.len());
            if let Some(known) = missing.get_mut(number) {
                known.others.push(link);
                known.is_child |= role == "child";
            } else {
                missing.push(UndefinedLink {
                    first: (joint, role, link),
                    others: Vec::new(),
                    is_child: role == "child",
                });
            }
        }
    }
    missing
}

impl UndefinedLink<'_> {
    /// The name.
    pub(crate) fn name(&self) -> &str {
        &self.first.2.value
    }

    /// The finding of the name, at its first place.
    pub(crate) fn finding(&self, subject: &str, links: &Names) -> Finding {
        let (joint, role, link) = self.first;
        let near = links.nearest(&FrameId::new(self.name()), Reach::SUGGESTION);
        let help = match near {
            Some(near) => format!("use `{}` if that is meant, or define the link", near.frame),
            None => "define the link, or use one that exists".to_owned(),
        };
        let message = format!(
            "{role} `{}` of joint `{}` is not a link of the robot",
            self.name(),
            joint.name.value
        );
        let finding = Finding::error(subject, message, link.place.clone())
            .label("no link of this name")
            .help(help)
            .measured(Measured::count("joints that use it", 1 + self.others.len()).limit(0.0));
        self.others.iter().take(MOST_SHOWN).fold(finding, |finding, other| {
            finding.related(other.place.clone(), "used here too")
        })
    }
}
