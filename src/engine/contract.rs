//! The contract that good recordings give.

use std::path::Path;

use crate::analysis::contract::of;
use crate::run::Run;
use crate::world::BagEvidence;
use crate::world::contract::Contract;

use super::UsageError;

/// What the recordings of a run at or below a path hold. An error if there is none with messages.
pub fn contract(run: &Run, good: &Path) -> Result<Contract, UsageError> {
    let whole = |path: &Path| std::fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    let is_good = |bag: &BagEvidence| {
        let source = run.sources.get(bag.source.0 as usize);
        source.is_some_and(|source| whole(Path::new(&source.path)).starts_with(whole(good)))
    };
    let recordings = run.worlds.iter().flat_map(|world| {
        let bags = world.bags.iter().enumerate();
        bags.filter(|(_, bag)| is_good(bag))
            .map(move |(number, _)| (world, number))
    });
    let contract = of(&recordings.collect::<Vec<_>>());
    if contract.is_empty() {
        let shown = good.display();
        return Err(UsageError(format!(
            "--from {shown}: no recording with topics or latched transforms could be read there"
        )));
    }
    Ok(contract)
}
