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

/// The objects that touch others, and those that were forgotten so.
#[derive(Debug, Default)]
pub(crate) struct Contacts {
    touching: Vec<u64>,
    forgotten: Vec<u64>,
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
            self.forgotten.push(name);
        }
    }

    /// A picture shows an object that has no name yet, and gets this one.
    pub(crate) fn name(&mut self, frame: u64, name: u64) {
        if let (None, [forgotten, ..]) = (self.first_after, &self.forgotten[..]) {
            self.first_after = Some(AfterContact { frame, name, forgotten: *forgotten });
        }
    }

    /// The first new object since one was forgotten.
    pub(crate) fn first_after(&self) -> Option<AfterContact> {
        self.first_after
    }
}
