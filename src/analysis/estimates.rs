//! A world with the settings of a run, and the estimates made of both so far.

use std::any::{Any, TypeId};
use std::cell::RefCell;
use std::collections::HashMap;
use std::hash::{BuildHasher, Hasher};
use std::ops::Deref;
use std::rc::Rc;
use std::sync::{Arc, Mutex, PoisonError};

use foldhash::quality::{FixedState, FoldHasher};

use crate::world::World;

use super::settings::Settings;

/// Costly results that worlds share which differ in a part only: each is a pure function, kept by its type and a hash of its input.
#[derive(Default)]
pub struct KeptResults(Mutex<HashMap<(TypeId, u64), Arc<dyn Any + Send + Sync>>>);

/// Hashes the input of a costly result: whole clouds, for every altered world, which the hasher of the standard library is slow for.
pub(crate) type InputHasher = FoldHasher<'static>;

/// Adds numbers to the hash of an input of [`Estimates::shared`], bit by bit.
pub(crate) fn hash_numbers(hasher: &mut InputHasher, numbers: impl IntoIterator<Item = f64>) {
    for number in numbers {
        hasher.write_u64(number.to_bits());
    }
}

/// Input of the rules: the world, the limits in force, and estimates, each made on first use.
///
/// It dereferences to the world. It belongs to one thread: nothing is locked while an estimate is made, so an estimate may use
/// others. Estimates cannot use each other in a cycle, because their files do not import each other in one.
pub struct Estimates<'w> {
    world: &'w World,
    settings: &'w Settings,
    kept: Option<&'w KeptResults>,
    made: RefCell<HashMap<TypeId, Rc<dyn Any>>>,
}

impl<'w> Estimates<'w> {
    /// Without estimates.
    pub fn new(world: &'w World, settings: &'w Settings) -> Self {
        Self {
            world,
            settings,
            kept: None,
            made: RefCell::default(),
        }
    }

    /// With costly results that are shared with other worlds; see [`KeptResults`].
    #[must_use]
    pub fn sharing(self, kept: Option<&'w KeptResults>) -> Self {
        Self { kept, ..self }
    }

    /// The result of a function of these numbers and of nothing else, made once for all worlds that share results.
    pub(crate) fn shared<T: Any + Send + Sync>(
        &self,
        numbers: impl FnOnce(&mut InputHasher),
        make: impl FnOnce() -> T,
    ) -> Arc<T> {
        let Some(KeptResults(kept)) = self.kept else {
            return Arc::new(make());
        };
        let mut hasher = FixedState::default().build_hasher();
        numbers(&mut hasher);
        let key = (TypeId::of::<T>(), hasher.finish());
        let known = kept.lock().unwrap_or_else(PoisonError::into_inner).get(&key).cloned();
        if let Some(known) = known.and_then(|known| known.downcast().ok()) {
            return known;
        }
        let made = Arc::new(make());
        let one: Arc<dyn Any + Send + Sync> = Arc::<T>::clone(&made);
        kept.lock().unwrap_or_else(PoisonError::into_inner).insert(key, one);
        made
    }

    /// The estimate of this type, made on first use.
    pub(crate) fn once<T: Any>(&self, make: impl FnOnce(&Self) -> T) -> Rc<T> {
        let known = self.made.borrow().get(&TypeId::of::<T>()).cloned();
        if let Some(known) = known.and_then(|known| known.downcast().ok()) {
            return known;
        }
        let made = Rc::new(make(self));
        self.made.borrow_mut().insert(TypeId::of::<T>(), Rc::<T>::clone(&made));
        made
    }

    /// The limits of this type, by the page and the configuration.
    pub(crate) fn limits<L: Any + Send + Sync>(&self) -> Arc<L> {
        self.settings.limits()
    }
}

impl Deref for Estimates<'_> {
    type Target = World;

    fn deref(&self) -> &World {
        self.world
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Inner(u32);
    struct Outer(u32);

    #[test]
    fn an_estimate_is_made_once_and_may_use_others() {
        let (world, settings) = (World::default(), Settings::default());
        let estimates = Estimates::new(&world, &settings);
        let outer = |estimates: &Estimates| Outer(estimates.once(|_| Inner(20)).0 + 1);
        assert_eq!(estimates.once(outer).0, 21);
        assert_eq!(estimates.once(|_| Inner(0)).0, 20);
        assert_eq!(estimates.once(|_| Outer(0)).0, 21);
    }

    #[test]
    fn a_result_is_shared_by_worlds_with_the_same_input() {
        let (world, settings, kept) = (World::default(), Settings::default(), KeptResults::default());
        let of = |kept, input: u32, made: u32| {
            let estimates = Estimates::new(&world, &settings).sharing(kept);
            *estimates.shared(|hasher| hasher.write_u32(input), || made)
        };
        assert_eq!((of(Some(&kept), 1, 10), of(Some(&kept), 1, 11)), (10, 10));
        assert_eq!(of(Some(&kept), 2, 12), 12, "another input");
        assert_eq!((of(None, 1, 13), of(None, 1, 14)), (13, 14), "nothing is shared");
    }
}
