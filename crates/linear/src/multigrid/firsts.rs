//! The first of things that are alike, where few differ.

use std::collections::HashMap;

/// Keys of what was met, each with the number of its first owner.
#[derive(Default)]
pub struct Firsts {
    last: (Vec<u32>, u32),
    known: HashMap<Vec<u32>, u32>,
    /// Length of all keys.
    pub size: usize,
}

impl Firsts {
    /// The first number that came with this key; `number` if the key is new.
    pub fn of(&mut self, key: &[u32], number: usize) -> u32 {
        // Along a line of a lattice most have the key of the one before.
        if self.last.0 != key || self.known.is_empty() {
            let first = match self.known.get(key) {
                Some(&first) => first,
                None => {
                    self.size += key.len();
                    self.known.insert(key.to_vec(), number as u32);
                    number as u32
                }
            };
            self.last.0.clear();
            self.last.0.extend_from_slice(key);
            self.last.1 = first;
        }
        self.last.1
    }
}
