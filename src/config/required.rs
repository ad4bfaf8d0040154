//! The key `require` of the configuration: rules that must have been evaluated, and known mistakes that must be found.

use crate::policy::{Force, RequiredShare, Requirement};
use crate::read::calibration::document::Node;

use super::ConfigError;
use super::policy::PolicyLayer;
use super::reader::Reader;

impl Reader<'_> {
    /// Adds what is required to the policy.
    pub(super) fn requirements(&self, root: &Node, asked: &mut PolicyLayer) -> Result<(), ConfigError> {
        const EXAMPLE: &str =
            "`- TREE01`, `- {rule: AXES03, subject: '*/imu*'}`, `- {share: 0.8}`, `- {detects: imu-wxyz}`";
        let items = match root.get("require") {
            Some(one) if one.is_mapping() => std::slice::from_ref(one),
            _ => self.list_of(root, "require", EXAMPLE)?,
        };
        for item in items {
            if let Some(share) = item.get("share") {
                self.keys(item, &["share"])?;
                asked.share = Some(self.share(share)?);
            } else if let Some(names) = item.get("detects") {
                self.keys(item, &["detects", "smaller-than", "subject", "if", "lifted"])?;
                let items: Vec<&Node> = names
                    .items()
                    .map_or_else(|| vec![names], |items| items.iter().collect());
                if items.is_empty() {
                    let what = "expected the names of known mistakes: this requires nothing";
                    return Err(self.error(names.span.start, what));
                }
                for mistake in items {
                    asked.detections.push(self.detection(item, mistake)?);
                }
            } else {
                let requirement = self.requirement(item, &mut asked.named)?;
                asked.required.push(requirement);
            }
        }
        Ok(())
    }

    /// The share of the applicable checks that must be evaluated.
    fn share(&self, node: &Node) -> Result<RequiredShare, ConfigError> {
        let share = node.text().and_then(|text| text.trim().parse().ok());
        let share = share.filter(|share| (0.0..=1.0).contains(share));
        Ok(RequiredShare {
            share: share
                .ok_or_else(|| self.error(node.span.start, "`share` must be a number from 0 to 1: `share: 0.8`"))?,
            origin: self.origin(node, false),
        })
    }

    fn requirement(&self, item: &Node, named: &mut Vec<(String, String)>) -> Result<Requirement, ConfigError> {
        let origin = self.origin(item, false);
        if !item.is_mapping() {
            let (rule, _) = self.rule_word(item, named)?;
            return Ok(Requirement {
                rule,
                subject: None,
                force: Force::Always,
                smaller_than: None,
                origin,
            });
        }
        self.keys(item, &["rule", "subject", "if", "lifted"])?;
        let rule = self.rule_of(item, named)?;
        self.required(item, rule)
    }

    /// A known mistake or a family of them, by its name, or by its name and the size from which on it must be found.
    fn detection(&self, item: &Node, mistake: &Node) -> Result<Requirement, ConfigError> {
        let name = if mistake.is_mapping() {
            self.keys(mistake, &["fault", "smaller-than"])?;
            self.required_text(mistake, "fault", "the name of a known mistake")?
        } else {
            let text = mistake.text().map(str::trim).filter(|text| !text.is_empty());
            let what = "expected the name of a known mistake, or `{fault: time-offset, smaller-than: 50 ms}`";
            text.ok_or_else(|| self.error(mistake.span.start, what))?.to_owned()
        };
        let size = mistake.get("smaller-than").or_else(|| item.get("smaller-than"));
        Ok(Requirement {
            smaller_than: size.map(|size| self.quantity(size)).transpose()?,
            origin: self.origin(mistake, true),
            ..self.required(item, name)?
        })
    }

    /// What an entry requires of a rule or of a known mistake.
    fn required(&self, item: &Node, rule: String) -> Result<Requirement, ConfigError> {
        let force = match (
            item.get("lifted"),
            self.word(item, "if", &[("applicable", Force::IfApplicable)])?,
        ) {
            (None, force) => force.unwrap_or(Force::Always),
            (Some(_), None) => Force::Lifted(self.required_text(
                item,
                "lifted",
                "the reason why it is not required, for readers of the report",
            )?),
            (Some(_), Some(_)) => {
                let what = "`if` and `lifted` exclude each other: a lifted rule is not required at all";
                return Err(self.error(item.span.start, what));
            }
        };
        Ok(Requirement {
            rule,
            subject: self.glob(item, "subject")?,
            force,
            smaller_than: None,
            origin: self.origin(item, false),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::fault;

    #[test]
    fn faults_have_a_place() {
        assert!(fault("require: [{subject: a}]\n").contains("`rule` is missing"));
        assert!(fault("require: [{rule: a, if: maybe}]\n").contains("`if` must be one of applicable"));
        assert!(fault("require: [{rule: a, lifted: ''}]\n").contains("`lifted` must be the reason"));
        assert!(fault("require: [{rule: a, if: applicable, lifted: b}]\n").contains("exclude each other"));
        for share in ["80", "-0.1", "most", "nan"] {
            let fault = fault(&format!("require: [{{share: {share}}}]\n"));
            assert_eq!(
                fault, "c.yaml:1:19: `share` must be a number from 0 to 1: `share: 0.8`",
                "{share}"
            );
        }
    }
}
