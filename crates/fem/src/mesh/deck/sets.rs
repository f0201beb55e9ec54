//! ByName sets of nodes or of elements, and surfaces of faces.

use std::collections::HashMap;
use std::hash::Hash;

use super::source::{DataFields, DeckCard, DeckPlace, cut, key};
use crate::error::{Error, nearly};

/// Things with names; names that differ only in case or blanks are one name.
#[derive(Clone, Debug, PartialEq)]
pub struct ByName<T> {
    pub all: Vec<T>,
    places: HashMap<String, usize>,
}

impl<T> Default for ByName<T> {
    fn default() -> Self {
        ByName { all: Vec::new(), places: HashMap::new() }
    }
}

impl<T> ByName<T> {
    pub fn named(&self, name: &str) -> Option<&T> {
        self.places.get(&key(name)).map(|&place| &self.all[place])
    }

    pub fn named_mut(&mut self, name: &str) -> Option<&mut T> {
        self.places.get(&key(name)).map(|&place| &mut self.all[place])
    }

    /// Adds a thing under a name that is new.
    pub fn add(&mut self, name: &str, thing: T) {
        self.places.insert(key(name), self.all.len());
        self.all.push(thing);
    }
}

/// A set as it is named first, with the places of its members, increasing.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedSet {
    pub name: String,
    pub members: Vec<usize>,
    /// A member that is given several times; it counts once.
    pub repeated: Option<usize>,
}

/// The things of a deck that have numbers, nodes or elements: their numbers, their places in the deck, and their sets.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Numbered {
    /// `node` or `element`.
    of: &'static str,
    /// The number of each, in the order of the deck.
    pub numbers: Vec<usize>,
    places: HashMap<usize, usize>,
    pub sets: ByName<NamedSet>,
}

impl Numbered {
    pub fn new(of: &'static str) -> Self {
        Numbered { of, ..Numbered::default() }
    }

    /// Adds the thing of this number; `false` if there is one.
    pub fn add(&mut self, number: usize) -> bool {
        if self.places.contains_key(&number) {
            return false;
        }
        self.places.insert(number, self.numbers.len());
        self.numbers.push(number);
        true
    }

    /// Leaves out those that have no new place, also in sets; the others keep their order.
    pub fn renumber(&mut self, places: &[Option<usize>]) {
        self.places.clear();
        let all = std::mem::take(&mut self.numbers).into_iter().zip(places);
        all.filter(|(_, place)| place.is_some()).for_each(|(number, _)| _ = self.add(number));
        for set in &mut self.sets.all {
            set.members = set.members.iter().filter_map(|&member| places[member]).collect();
            set.repeated = set.repeated.and_then(|member| places[member]);
        }
    }

    pub fn len(&self) -> usize {
        self.numbers.len()
    }

    /// The place of a number, from 0.
    pub fn place(&self, number: usize) -> Option<usize> {
        self.places.get(&number).copied()
    }

    /// Adds members to the set of this name, which begins if it is new.
    pub fn extend(&mut self, name: &str, members: impl IntoIterator<Item = usize>) {
        if self.sets.named(name).is_none() {
            self.sets.add(name, NamedSet { name: name.into(), members: Vec::new(), repeated: None });
        }
        let Some(NamedSet { members: own, repeated, .. }) = self.sets.named_mut(name) else { return };
        own.extend(members);
        own.sort_unstable();
        *repeated = repeated.or(own.windows(2).find(|pair| pair[0] == pair[1]).map(|pair| pair[0]));
        own.dedup();
    }

    /// A sentence for a set that is loaded, although a member is given in it several times.
    pub fn repetition(&self, target: &str) -> Option<String> {
        let NamedSet { name, repeated, .. } = self.sets.named(target)?;
        let number = self.numbers[(*repeated)?];
        Some(format!(
            "{} {number} is in the set `{name}` several times; it is loaded once, CalculiX loads it each time",
            self.of
        ))
    }

    fn parameter(&self) -> &'static str {
        if self.of == "node" { "NSET" } else { "ELSET" }
    }

    /// The name of the set that a card makes or extends, if it names one; a number is no name.
    pub fn name_in<'a>(&self, card: DeckCard<'a>) -> Result<Option<&'a str>, Error> {
        match card.value(self.parameter()).filter(|name| !name.is_empty()) {
            Some(name) if name.parse::<usize>().is_ok() => {
                Err(card.fault(format!("a set of {}s is called {name}; a name must not be a number", self.of)))
            }
            name => Ok(name),
        }
    }

    /// Reads a card *NSET or *ELSET: numbers, names of earlier sets, or ranges of numbers.
    pub fn read(&mut self, card: DeckCard) -> Result<(), Error> {
        let Some(name) = self.name_in(card)? else {
            return Err(card.fault(format!("{} has no name; write {}=NAME", card.name, self.parameter())));
        };
        let (mut members, mut repeated) = (Vec::new(), None);
        for mut fields in card.fields() {
            if card.has("GENERATE") {
                members.extend(self.range(&mut fields)?);
                continue;
            }
            while fields.clone().next().is_some() {
                if let Some(target) = fields.text() {
                    members.extend(fields.placed(self.members(&target))?);
                    repeated = repeated.or(self.sets.named(&target).and_then(|set| set.repeated));
                }
            }
        }
        self.extend(name, members.into_iter().chain(repeated));
        Ok(())
    }

    /// The members of a range: first, last, step.
    fn range(&self, fields: &mut DataFields) -> Result<Vec<usize>, Error> {
        let (first, last) =
            (fields.whole("the first number of the range")?, fields.whole("the last number of the range")?);
        let step = if fields.clone().text().is_some() { fields.whole("the step of the range")? } else { 1 };
        fields.end()?;
        if step == 0 || last < first {
            return Err(fields.fault(format!("the range from {first} to {last} in steps of {step} has no number")));
        }
        let steps = (last - first) / step;
        let is_in = |number: usize| (first..=last).contains(&number) && (number - first).is_multiple_of(step);
        let members: Vec<usize> = match steps < self.numbers.len() {
            true => (0..=steps).filter_map(|count| self.place(first + count * step)).collect(),
            false => (0..self.numbers.len()).filter(|&place| is_in(self.numbers[place])).collect(),
        };
        match members.is_empty() {
            true => Err(fields.fault(format!("the deck has no {} from {first} to {last} in steps of {step}", self.of))),
            false => Ok(members),
        }
    }

    /// The members of a set, or the thing of a number.
    ///
    /// # Errors
    /// A sentence if there is none.
    pub fn members(&self, target: &str) -> Result<Vec<usize>, String> {
        if let Ok(number) = target.parse() {
            let missing = || format!("the deck has no {} {number}", self.of);
            return self.place(number).map(|place| vec![place]).ok_or_else(missing);
        }
        match self.sets.named(target) {
            Some(set) => Ok(set.members.clone()),
            None => {
                let meant = nearly(target, self.sets.all.iter().map(|set| set.name.as_str()));
                Err(format!("there is no set of {}s `{}` above this line{meant}", self.of, cut(target, 80)))
            }
        }
    }

    /// The set or the number that begins a line, with its members.
    pub fn target(&self, fields: &mut DataFields) -> Result<(String, Vec<usize>), Error> {
        let target = fields.first()?;
        let members = fields.placed(self.members(&target))?;
        Ok((target, members))
    }

    /// Returns `true` for the number of one of the things, and for the name of a set of them.
    pub fn has(&self, target: &str) -> bool {
        match target.parse() {
            Ok(number) => self.place(number).is_some(),
            Err(_) => self.sets.named(target).is_some(),
        }
    }
}

/// What is given again later: the last step, or line, that gives each thing, and the one that removes all before it.
pub struct Overridden<K> {
    last: HashMap<K, usize>,
    first: usize,
}

impl<K> Default for Overridden<K> {
    fn default() -> Self {
        Overridden { last: HashMap::new(), first: 0 }
    }
}

impl<K: Eq + Hash> Overridden<K> {
    pub fn give(&mut self, thing: K, step: usize) {
        let last = self.last.entry(thing).or_default();
        *last = (*last).max(step);
    }

    /// Removes what is given before a step.
    pub fn clear(&mut self, step: usize) {
        self.first = self.first.max(step);
    }

    /// Returns `true` if what a step gives acts at the end.
    pub fn acts(&self, thing: &K, step: usize) -> bool {
        step >= self.first && self.last.get(thing).is_none_or(|last| *last == step)
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct DeckSurface {
    pub name: String,
    pub place: DeckPlace,
    /// Elements and their faces, from 0; for a surface of nodes the faces that have only nodes of it.
    pub faces: Vec<(usize, usize)>,
    /// The nodes of a surface of nodes that are on none of these faces, by their places.
    pub bare: Vec<usize>,
}

/// Faces that a card *DLOAD presses with one value.
#[derive(Clone, Debug, PartialEq)]
pub struct FacePressure {
    /// The place of the card.
    pub card: DeckPlace,
    pub step: usize,
    /// The name of the surface of these faces.
    pub surface: String,
    pub place: DeckPlace,
    pub value: f64,
}
