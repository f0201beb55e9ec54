//! Named sets of nodes or of elements, and surfaces of faces.

use std::collections::HashMap;

use super::source::{Card, Fields, Place, Source, key};
use crate::error::{Error, nearly};

/// The things of a deck that have numbers, nodes or elements: their numbers, and their places in the deck.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Numbered {
    /// The number of each, in the order of the deck.
    pub numbers: Vec<usize>,
    places: HashMap<usize, usize>,
}

impl Numbered {
    /// Adds the thing of this number; `false` if there is one.
    pub fn add(&mut self, number: usize) -> bool {
        if self.places.contains_key(&number) {
            return false;
        }
        self.places.insert(number, self.numbers.len());
        self.numbers.push(number);
        true
    }

    /// Leaves out those that have no new place; the others keep their order.
    pub fn renumber(&mut self, places: &[Option<usize>]) {
        let all = std::mem::take(self);
        let kept = all.numbers.into_iter().zip(places).filter(|(_, place)| place.is_some());
        kept.for_each(|(number, _)| _ = self.add(number));
    }

    pub fn len(&self) -> usize {
        self.numbers.len()
    }

    /// The place of a number, from 0.
    pub fn place(&self, number: usize) -> Option<usize> {
        self.places.get(&number).copied()
    }

    /// The places of the numbers from `first` to `last` in steps of `step` that there are.
    fn range(&self, first: usize, last: usize, step: usize) -> Vec<usize> {
        let steps = (last - first) / step;
        if steps < self.numbers.len() {
            return (0..=steps).filter_map(|count| self.place(first + count * step)).collect();
        }
        let is_in = |number: usize| (first..=last).contains(&number) && (number - first).is_multiple_of(step);
        (0..self.numbers.len()).filter(|&place| is_in(self.numbers[place])).collect()
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

/// Sets of one kind of thing; names that differ only in case or blanks are one name.
#[derive(Clone, Debug, PartialEq)]
pub struct Sets {
    /// `node` or `element`.
    of: &'static str,
    pub all: Vec<NamedSet>,
    places: HashMap<String, usize>,
}

impl Sets {
    pub fn new(of: &'static str) -> Self {
        Sets { of, all: Vec::new(), places: HashMap::new() }
    }

    /// Adds members to the set of this name, which begins if it is new.
    pub fn extend(&mut self, name: &str, members: impl IntoIterator<Item = usize>) {
        let next = self.all.len();
        let place = *self.places.entry(key(name)).or_insert(next);
        if place == next {
            self.all.push(NamedSet { name: name.into(), members: Vec::new(), repeated: None });
        }
        let NamedSet { members: own, repeated, .. } = &mut self.all[place];
        own.extend(members);
        own.sort_unstable();
        *repeated = repeated.or(own.windows(2).find(|pair| pair[0] == pair[1]).map(|pair| pair[0]));
        own.dedup();
    }

    /// A sentence for a set that is loaded, although a member is given in it several times.
    pub fn repetition(&self, target: &str, of: &Numbered) -> Option<String> {
        let NamedSet { name, repeated, .. } = self.named(target)?;
        let number = of.numbers[(*repeated)?];
        Some(format!(
            "{} {number} is in the set `{name}` several times; it is loaded once, CalculiX loads it each time",
            self.of
        ))
    }

    /// Renumbers the members; those without a new place are left out.
    pub fn renumber(&mut self, places: &[Option<usize>]) {
        for set in &mut self.all {
            set.members = set.members.iter().filter_map(|&member| places[member]).collect();
            set.repeated = set.repeated.and_then(|member| places[member]);
        }
    }

    pub fn named(&self, name: &str) -> Option<&NamedSet> {
        self.places.get(&key(name)).map(|&place| &self.all[place])
    }

    fn parameter(&self) -> &'static str {
        if self.of == "node" { "NSET" } else { "ELSET" }
    }

    /// The name of the set that a card makes or extends, if it names one; a number is no name.
    pub fn name_in<'a>(&self, source: &Source, card: &'a Card) -> Result<Option<&'a str>, Error> {
        match card.value(self.parameter()).filter(|name| !name.is_empty()) {
            Some(name) if name.parse::<usize>().is_ok() => {
                let message = format!("a set of {}s is called {name}; a name must not be a number", self.of);
                Err(source.fault(card.place, message))
            }
            name => Ok(name),
        }
    }

    /// Reads a card *NSET or *ELSET: numbers, names of earlier sets, or ranges of numbers.
    pub fn read(&mut self, source: &Source, card: &Card, of: &Numbered) -> Result<(), Error> {
        let Some(name) = self.name_in(source, card)? else {
            let message = format!("{} has no name; write {}=NAME", card.name, self.parameter());
            return Err(source.fault(card.place, message));
        };
        let (mut members, mut repeated) = (Vec::new(), None);
        for line in &card.lines {
            let mut fields = source.fields(line);
            if card.has("GENERATE") {
                members.extend(self.range(&mut fields, of)?);
                continue;
            }
            while fields.clone().next().is_some() {
                if let Some(target) = fields.text() {
                    members.extend(self.members(&target, of).map_err(|message| fields.fault(message))?);
                    repeated = repeated.or(self.named(&target).and_then(|set| set.repeated));
                }
            }
        }
        self.extend(name, members.into_iter().chain(repeated));
        Ok(())
    }

    /// The members of a range: first, last, step.
    fn range(&self, fields: &mut Fields, of: &Numbered) -> Result<Vec<usize>, Error> {
        let (first, last) =
            (fields.whole("the first number of the range")?, fields.whole("the last number of the range")?);
        let step = if fields.clone().text().is_some() { fields.whole("the step of the range")? } else { 1 };
        fields.end()?;
        if step == 0 || last < first {
            return Err(fields.fault(format!("the range from {first} to {last} in steps of {step} has no number")));
        }
        match of.range(first, last, step) {
            members if members.is_empty() => {
                Err(fields.fault(format!("the deck has no {} from {first} to {last} in steps of {step}", self.of)))
            }
            members => Ok(members),
        }
    }

    /// The members of a set, or the thing of a number.
    ///
    /// # Errors
    /// A sentence if there is none.
    pub fn members(&self, target: &str, of: &Numbered) -> Result<Vec<usize>, String> {
        if let Ok(number) = target.parse() {
            let missing = || format!("the deck has no {} {number}", self.of);
            return of.place(number).map(|place| vec![place]).ok_or_else(missing);
        }
        match self.named(target) {
            Some(set) => Ok(set.members.clone()),
            None => {
                let meant = nearly(target, self.all.iter().map(|set| set.name.as_str()));
                let shown: String = target.chars().take(80).collect();
                Err(format!("there is no set of {}s `{shown}` above this line{meant}", self.of))
            }
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    pub name: String,
    pub place: Place,
    /// Elements and their faces, from 0; for a surface of nodes the faces that have only nodes of it.
    pub faces: Vec<(usize, usize)>,
    /// The nodes of a surface of nodes that are on none of these faces, by their places.
    pub bare: Vec<usize>,
}

/// All surfaces; names that differ only in case or blanks are one name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surfaces {
    pub all: Vec<Surface>,
    places: HashMap<String, usize>,
}

impl Surfaces {
    pub fn named(&self, name: &str) -> Option<&Surface> {
        self.places.get(&key(name)).map(|&place| &self.all[place])
    }

    pub fn named_mut(&mut self, name: &str) -> Option<&mut Surface> {
        self.places.get(&key(name)).map(|&place| &mut self.all[place])
    }

    pub fn add(&mut self, surface: Surface) {
        self.places.insert(key(&surface.name), self.all.len());
        self.all.push(surface);
    }
}

/// Faces that a card *DLOAD presses with one value.
#[derive(Clone, Debug, PartialEq)]
pub struct FacePressure {
    /// The number of the card among all cards.
    pub card: usize,
    /// The name of the surface of these faces.
    pub surface: String,
    pub place: Place,
    pub value: f64,
}
