//! The finding about a declaration.

use crate::analysis::camera::fault::Fault;
use crate::source::Place;
use crate::verdict::Finding;

impl Fault {
    pub(crate) fn finding(self, subject: &str, place: Place) -> Finding {
        let finding = if self.is_error {
            Finding::error(subject, self.message, place)
        } else {
            Finding::warning(subject, self.message, place)
        };
        let finding = finding.relation(self.relation).detail(self.detail);
        finding.help(self.help).measured(self.measured)
    }
}
