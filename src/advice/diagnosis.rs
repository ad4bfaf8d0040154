//! What the diagnosis of an inertial sensor makes of a finding: its words, and the rule that says it better.

use crate::analysis::{axes::causes::Aspect, axes::diagnosis::Diagnosis, motion::Imu};
use crate::rules::codes;
use crate::verdict::{Finding, RuleCode};

/// The finding of a rule that looks at one aspect of a sensor, with the fault's name and help, and how the numbers were read; `otherwise`
/// is the help where no known fault fits. Where another aspect shows the fault better, the finding defers to that one's rule.
pub(crate) fn explain(diagnosis: &Diagnosis, imu: &Imu, own: Aspect, finding: Finding, otherwise: &str) -> Finding {
    let help = diagnosis.help().unwrap_or_else(|| otherwise.to_owned());
    let mut finding = diagnosis.expressed_in.tell(finding).help(help);
    if let Some(word) = diagnosis.word() {
        finding = finding.relation(word);
    }
    defer(diagnosis, imu, Some(own), finding)
}

/// The finding, which defers to the rule of the aspect that shows the fault best.
pub(crate) fn defer(diagnosis: &Diagnosis, imu: &Imu, own: Option<Aspect>, finding: Finding) -> Finding {
    match (diagnosis.shown_by.filter(|aspect| Some(*aspect) != own), &imu.mount) {
        (Some(Aspect::Body), Some(mount)) => {
            let finding = finding.unless_about(codes::AXES13, format!("`{}`", mount.base));
            if diagnosis.goes_backward {
                finding.hint()
            } else {
                finding
            }
        }
        (Some(aspect), _) => finding.unless(rule_of(aspect)),
        (None, _) => finding,
    }
}

/// The rule that looks at an aspect.
pub(crate) fn rule_of(aspect: Aspect) -> RuleCode {
    match aspect {
        Aspect::Base => codes::AXES01,
        Aspect::World => codes::AXES03,
        Aspect::Turn => codes::QUAT01,
        Aspect::Heading => codes::AXES04,
        Aspect::Sense => codes::AXES05,
        Aspect::Push => codes::AXES06,
        Aspect::AngleOrder => codes::QUAT03,
        Aspect::Body => codes::AXES13,
    }
}
