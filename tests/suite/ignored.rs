//! No reason of a page's cases points at a rule that is silent.

#![allow(clippy::unwrap_used)]

use frames_lint::page;
use frames_lint::rules::RULES;
use rayon::prelude::*;

use crate::cases::{cases, worlds};
use crate::support::deference::faults;

#[test]
fn no_reason_of_a_page_points_at_a_rule_that_is_silent() {
    let of_page = |entry: &frames_lint::rules::Entry| {
        let sections = page::sections(entry.page.body);
        let bad = sections.iter().filter(|section| section.title == "Bad").flat_map(cases);
        let faults = bad.flat_map(|case| {
            let worlds = worlds(&case);
            let faults = worlds.iter().flat_map(faults).collect::<Vec<_>>();
            faults
                .into_iter()
                .map(move |fault| format!("{} {}: {fault}", entry.code, case.title))
        });
        faults.collect::<Vec<_>>()
    };
    let mut faults: Vec<String> = RULES.par_iter().flat_map_iter(of_page).collect();
    faults.sort();
    assert!(faults.is_empty(), "{}:\n{}", faults.len(), faults.join("\n"));
}
