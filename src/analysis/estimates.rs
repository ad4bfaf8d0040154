//! A world with the settings of a run, and the estimates made of both so far.

use std::any::{Any, TypeId};
use std::cell::RefCell;
use std::collections::HashMap;
use std::ops::Deref;
use std::rc::Rc;
use std::sync::Arc;

use crate::world::World;

use super::settings::Settings;

/// Input of the rules: the world, the limits in force, and estimates, each made on first use.
///
/// It dereferences to the world. It belongs to one thread: nothing is locked while an estimate is made, so an estimate may use
/// others. Estimates cannot use each other in a cycle, because their files do not import each other in one.
pub struct Estimates<'w> {
    world: &'w World,
    settings: &'w Settings,
    made: RefCell<HashMap<TypeId, Rc<dyn Any>>>,
}

impl<'w> Estimates<'w> {
    /// Without estimates.
    pub fn new(world: &'w World, settings: &'w Settings) -> Self {
        Self {
            world,
            settings,
            made: RefCell::default(),
        }
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
}
