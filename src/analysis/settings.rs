//! The limits of a run, by type: those of the pages, and over them those of the configuration.

use std::any::{Any, TypeId};
use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

type AnyLimits = Arc<dyn Any + Send + Sync>;
type Load = Box<dyn Fn() -> Option<AnyLimits> + Send + Sync>;

/// The limits in force. Each set is loaded on first use, since a run needs those of few rules.
#[derive(Default)]
pub struct Settings(HashMap<TypeId, (Load, OnceLock<Option<AnyLimits>>)>);

impl Settings {
    /// Adds the limits of one type.
    pub fn add<L: Any + Send + Sync>(&mut self, load: impl Fn() -> Option<L> + Send + Sync + 'static) {
        let load: Load = Box::new(move || load().map(|limits| Arc::new(limits) as AnyLimits));
        self.0.insert(TypeId::of::<L>(), (load, OnceLock::new()));
    }

    /// The limits of a type.
    ///
    /// # Panics
    /// If no page has them: a bug, which a test rules out. The engine reports it as a crash of the rule.
    #[allow(clippy::panic)]
    pub fn limits<L: Any + Send + Sync>(&self) -> Arc<L> {
        let known = self.0.get(&TypeId::of::<L>());
        let known = known.and_then(|(load, kept)| kept.get_or_init(load).clone());
        match known.and_then(|known| known.downcast().ok()) {
            Some(limits) => limits,
            None => panic!("no page has the limits `{}`", std::any::type_name::<L>()),
        }
    }
}
