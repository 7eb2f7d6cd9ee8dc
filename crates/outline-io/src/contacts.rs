//! Objects that touch others, and what becomes of their names.

/// An object that was seen after another one had been forgotten while it touched a third: it may be that one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AfterContact {
    /// Number of the picture that shows it first.
    pub frame: u64,
    /// Its name.
    pub name: u64,
    /// Name of the one that was forgotten.
    pub forgotten: u64,
}

/// The objects that touch others, and what became of the first that was forgotten so.
#[derive(Debug, Default)]
pub(crate) struct Contacts {
    touching: Vec<u64>,
    first_forgotten: Option<u64>,
    first_after: Option<AfterContact>,
}

impl Contacts {
    /// An object that is not seen by itself, as it touches others.
    pub(crate) fn touch(&mut self, name: u64) {
        if !self.touching.contains(&name) {
            self.touching.push(name);
        }
    }

    /// An object is seen by itself.
    pub(crate) fn see(&mut self, name: u64) {
        self.touching.retain(|touching| *touching != name);
    }

    /// An object is forgotten.
    pub(crate) fn forget(&mut self, name: u64) {
        if self.touching.contains(&name) {
            self.see(name);
            self.first_forgotten.get_or_insert(name);
        }
    }

    /// A picture shows an object that has no name yet, and gets this one.
    pub(crate) fn name(&mut self, frame: u64, name: u64) {
        let after = self.first_forgotten.map(|forgotten| AfterContact { frame, name, forgotten });
        self.first_after = self.first_after.or(after);
    }

    /// The first new object since one was forgotten.
    pub(crate) fn first_after(&self) -> Option<AfterContact> {
        self.first_after
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_was_forgotten_while_it_touched_another_may_be_what_is_new() {
        let mut contacts = Contacts::default();
        contacts.touch(0);
        contacts.touch(1);
        // It is seen by itself again, and leaves later; another one was never touched.
        contacts.see(1);
        [1, 2].into_iter().for_each(|name| contacts.forget(name));
        contacts.name(30, 3);
        assert_eq!(contacts.first_after(), None);
        contacts.forget(0);
        contacts.name(40, 4);
        contacts.name(41, 5);
        assert_eq!(contacts.first_after(), Some(AfterContact { frame: 40, name: 4, forgotten: 0 }));
    }
}
