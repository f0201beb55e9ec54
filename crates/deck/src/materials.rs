//! Materials of a deck, and the sections that give them to elements.

use std::collections::HashMap;

use serde_json::{Value, json};

use signorini_fem::geometry::minus;
use signorini_fem::mesh::deck::{Card, Deck, Fields, Place, Space, key};
use signorini_fem::{Error, nearly};

#[derive(Clone, Debug, Default)]
struct Given {
    elastic: Option<Elastic>,
    density: Option<f64>,
    /// Along the axes of the material.
    expansion: Option<[f64; 3]>,
}

#[derive(Clone, Debug)]
enum Elastic {
    Isotropic {
        young: f64,
        poisson: f64,
    },
    /// E1, E2, E3, nu12, nu13, nu23, G12, G13, G23.
    Constants([f64; 9]),
}

/// A section: a set of elements with a material.
pub(super) struct Section {
    /// The name of the set.
    pub group: String,
    pub place: Place,
    /// The material as a scene has it.
    pub material: Value,
    pub expands: bool,
}

/// The sections of a deck, and the number of the section of each element.
pub(super) struct Sections {
    pub all: Vec<Section>,
    pub of_element: Vec<usize>,
    /// What is read, but may not be meant.
    pub noted: Vec<(Place, String)>,
    /// The one thickness of a plane model.
    pub thickness: Option<(f64, Place)>,
}

impl Sections {
    pub fn of(deck: &Deck, space: Space) -> Result<Self, Error> {
        let mut noted = Vec::new();
        let (materials, orientations) = (materials(deck, &mut noted)?, orientations(deck)?);
        let names: Vec<&str> = materials.keys().map(String::as_str).collect();
        let mut sections = Sections { all: Vec::new(), of_element: Vec::new(), noted, thickness: None };
        let mut of_element: Vec<Option<usize>> = vec![None; deck.elements.len()];
        for card in deck.source.cards.iter().filter(|card| card.is("SOLIDSECTION")) {
            let (Some(group), Some(material)) = (card.value("ELSET"), card.value("MATERIAL")) else {
                return Err(deck.source.fault(card.place, "*SOLID SECTION needs ELSET=NAME and MATERIAL=NAME"));
            };
            let Some(set) = deck.element_sets.named(group) else {
                return Err(deck.source.fault(card.place, format!("there is no set of elements `{group}`")));
            };
            let Some(given) = materials.get(&key(material)) else {
                let meant = nearly(&key(material), names.iter().copied());
                return Err(deck.source.fault(card.place, format!("there is no material `{material}`{meant}")));
            };
            let value = given.value().map_err(|message| deck.source.fault(card.place, message))?;
            let Some(mut value) = value else {
                return Err(deck.source.fault(card.place, format!("the material `{material}` has no *ELASTIC")));
            };
            sections.read_thickness(deck, card, space)?;
            if let Some(name) = card.value("ORIENTATION") {
                let orientation =
                    orientations.get(&key(name)).ok_or_else(|| format!("there is no *ORIENTATION `{name}`"));
                let turned = orientation.and_then(|orientation| orientation.turn(&mut value, space));
                turned.map_err(|message| deck.source.fault(card.place, message))?;
            }
            set.members.iter().for_each(|&element| of_element[element] = Some(sections.all.len()));
            let expands = given.expansion.is_some();
            sections.all.push(Section { group: set.name.clone(), place: card.place, material: value, expands });
        }
        if let Some(element) = of_element.iter().position(Option::is_none) {
            let number = deck.elements.numbers[element];
            let message = format!("element {number} has no *SOLID SECTION, and therefore no material");
            return Err(deck.source.fault(deck.element_list[element].place, message));
        }
        sections.of_element = of_element.into_iter().flatten().collect();
        Ok(sections)
    }

    fn read_thickness(&mut self, deck: &Deck, card: &Card, space: Space) -> Result<(), Error> {
        let mut value = 1.0;
        let mut place = card.place;
        if let Some(line) = card.lines.first() {
            let mut fields = deck.source.fields(line);
            place = line.place;
            value = fields.finite_or_zero("the thickness")?;
            fields.end()?;
            if value == 0.0 {
                value = 1.0;
            }
        }
        if let Some(line) = card.lines.get(1) {
            return Err(deck.source.fault(line.place, "a section has one line, with its thickness"));
        }
        if !matches!(space, Space::PlaneStress | Space::PlaneStrain) {
            return Ok(());
        }
        match self.thickness {
            Some((other, at)) if other != value => {
                let message = format!(
                    "the thickness is {value}, but that of {} is {other}; a plane model has one thickness",
                    deck.source.named(at)
                );
                Err(deck.source.fault(place, message))
            }
            _ => {
                self.thickness = Some((value, place));
                Ok(())
            }
        }
    }
}

impl Given {
    /// As a scene has it; `None` without elasticity.
    ///
    /// # Errors
    /// A sentence for an isotropic material that expands by different amounts.
    fn value(&self) -> Result<Option<Value>, String> {
        let Some(elastic) = &self.elastic else { return Ok(None) };
        let mut value = match elastic {
            Elastic::Isotropic { young, poisson } => json!({"young": young, "poisson": poisson}),
            Elastic::Constants([e1, e2, e3, nu12, nu13, nu23, g12, g13, g23]) => json!({"orthotropic": {
                "young": [e1, e2, e3], "poisson": [nu12, nu23, nu13], "shear": [g12, g23, g13]}}),
        };
        if let Some(density) = self.density {
            value["density"] = density.into();
        }
        match (self.expansion, value.get_mut("orthotropic")) {
            (Some(expansion), Some(orthotropic)) => orthotropic["expansion"] = json!(expansion),
            (Some([x, y, z]), None) if x == y && y == z => value["expansion"] = x.into(),
            (Some(_), None) => {
                return Err(
                    "an isotropic material has one expansion; write ENGINEERING CONSTANTS for one with three".into()
                );
            }
            (None, _) => {}
        }
        Ok(Some(value))
    }
}

/// Material axes.
enum Orientation {
    /// A vector along axis 1, and one in the plane of axes 1 and 2.
    Rectangular([[f64; 3]; 2]),
    /// Two points on the line around which the axes turn.
    Cylindrical([[f64; 3]; 2]),
}

impl Orientation {
    /// Turns an orthotropic material, as a scene has it; an isotropic one has no axes.
    fn turn(&self, material: &mut Value, space: Space) -> Result<(), String> {
        let Some(orthotropic) = material.get_mut("orthotropic") else { return Ok(()) };
        match (self, space) {
            (Orientation::Rectangular(axes), Space::Solid) => orthotropic["axes"] = json!(axes),
            (Orientation::Rectangular([[x, y, z], second]), _) => {
                if *z != 0.0 || x * second[1] - y * second[0] <= 0.0 {
                    return Err(
                        "in a plane model axis 2 lies a quarter turn from axis 1, counterclockwise from x to y".into(),
                    );
                }
                orthotropic["angle"] = y.atan2(*x).to_degrees().into();
            }
            (Orientation::Cylindrical(_), Space::Axisymmetric) => {
                return Err(
                    "in an axisymmetric model the axes of the material turn with the section anyway; use RECTANGULAR"
                        .into(),
                );
            }
            (Orientation::Cylindrical([from, to]), _) => {
                let along = minus(*to, *from);
                if along == [0.0; 3] {
                    return Err("the two points of the axis are one".into());
                }
                orthotropic["around"] = match space {
                    Space::Solid => json!({"point": from, "along": along}),
                    _ if along[0] == 0.0 && along[1] == 0.0 => json!({"point": from[..2]}),
                    _ => return Err("the axis of a cylinder is across the plane of a plane model".into()),
                };
            }
        }
        Ok(())
    }
}

/// The orientations by their names in capitals.
fn orientations(deck: &Deck) -> Result<HashMap<String, Orientation>, Error> {
    let mut all = HashMap::new();
    for card in deck.source.cards.iter().filter(|card| card.is("ORIENTATION")) {
        let Some(name) = card.value("NAME") else {
            return Err(deck.source.fault(card.place, "*ORIENTATION has no name; write NAME=NAME"));
        };
        let mut fields = only_line(deck, card)?;
        let mut axes = [[0.0; 3]; 2];
        for (part, what) in axes.as_flattened_mut().iter_mut().zip(["Xa", "Ya", "Za", "Xb", "Yb", "Zb"]) {
            *part = fields.finite_or_zero(what)?;
        }
        fields.end()?;
        let orientation = match card.value("SYSTEM").map_or_else(|| "RECTANGULAR".into(), key).as_str() {
            "RECTANGULAR" => Orientation::Rectangular(axes),
            "CYLINDRICAL" => Orientation::Cylindrical(axes),
            other => {
                let message = format!("SYSTEM={other} is not read; there are RECTANGULAR and CYLINDRICAL");
                return Err(deck.source.fault(card.place, message));
            }
        };
        if all.insert(key(name), orientation).is_some() {
            return Err(deck.source.fault(card.place, format!("there are two orientations `{name}`")));
        }
    }
    Ok(all)
}

/// The materials by their names in capitals.
fn materials(deck: &Deck, noted: &mut Vec<(Place, String)>) -> Result<HashMap<String, Given>, Error> {
    let mut materials: HashMap<String, Given> = HashMap::new();
    let mut current: Option<String> = None;
    for card in &deck.source.cards {
        let fault = |message: String| Err(deck.source.fault(card.place, message));
        if card.is("MATERIAL") {
            let Some(name) = card.value("NAME") else { return fault("*MATERIAL has no name; write NAME=NAME".into()) };
            if materials.insert(key(name), Given::default()).is_some() {
                return fault(format!("there are two materials `{name}`"));
            }
            current = Some(key(name));
            continue;
        }
        if !["ELASTIC", "DENSITY", "EXPANSION"].iter().any(|keyword| card.is(keyword)) {
            continue;
        }
        let Some(material) = current.as_ref().and_then(|name| materials.get_mut(name)) else {
            return fault(format!("{} follows no *MATERIAL", card.name));
        };
        let is_twice = if card.is("ELASTIC") {
            material.elastic.replace(elastic(deck, card)?).is_some()
        } else if card.is("DENSITY") {
            material.density.replace(one(deck, card, "the density")?).is_some()
        } else {
            let expansion = match card.value("TYPE").map(key).as_deref() {
                None | Some("ISO" | "ISOTROPIC") => [one(deck, card, "the expansion")?; 3],
                Some("ORTHO" | "ORTHOTROPIC") => {
                    let mut fields = only_line(deck, card)?;
                    let mut along = [0.0; 3];
                    for (value, axis) in along.iter_mut().zip(1..) {
                        *value = fields.finite(format_args!("the expansion along axis {axis}"))?;
                    }
                    without_temperature(&mut fields)?;
                    along
                }
                Some(_) => {
                    return fault(
                        "*EXPANSION is read with TYPE=ISO or TYPE=ORTHO, along the axes of the material".into(),
                    );
                }
            };
            material.expansion.replace(expansion).is_some()
        };
        if is_twice {
            let message = format!("the material has {} twice; the last one counts, as in CalculiX", card.name);
            noted.push((card.place, message));
        }
    }
    Ok(materials)
}

fn elastic(deck: &Deck, card: &Card) -> Result<Elastic, Error> {
    let of_type = card.value("TYPE").map_or_else(|| "ISO".into(), key);
    match of_type.as_str() {
        "ISO" | "ISOTROPIC" => {
            let mut fields = only_line(deck, card)?;
            let (young, poisson) = (fields.finite("Young's modulus")?, fields.finite("Poisson's ratio")?);
            without_temperature(&mut fields)?;
            Ok(Elastic::Isotropic { young, poisson })
        }
        "ENGINEERINGCONSTANTS" => {
            const NAMES: [&str; 9] = ["E1", "E2", "E3", "nu12", "nu13", "nu23", "G12", "G13", "G23"];
            let (Some(first), Some(second), None) = (card.lines.first(), card.lines.get(1), card.lines.get(2)) else {
                let message = "nine constants are read: eight in the first line, G23 in the second; none may depend on a temperature";
                return Err(deck.source.fault(card.place, message));
            };
            let mut constants = [0.0; 9];
            let mut fields = deck.source.fields(first);
            for (constant, name) in constants.iter_mut().zip(NAMES).take(8) {
                *constant = fields.finite(name)?;
            }
            fields.end()?;
            let mut fields = deck.source.fields(second);
            constants[8] = fields.finite(NAMES[8])?;
            without_temperature(&mut fields)?;
            Ok(Elastic::Constants(constants))
        }
        _ => {
            let message = "this type of *ELASTIC is not read; there are ISO and ENGINEERING CONSTANTS";
            Err(deck.source.fault(card.place, message))
        }
    }
}

/// The one number of a card that does not depend on a temperature.
fn one(deck: &Deck, card: &Card, what: &str) -> Result<f64, Error> {
    let mut fields = only_line(deck, card)?;
    let value = fields.finite(what)?;
    without_temperature(&mut fields)?;
    Ok(value)
}

fn only_line<'a>(deck: &'a Deck, card: &Card) -> Result<Fields<'a>, Error> {
    match &card.lines[..] {
        [line] => Ok(deck.source.fields(line)),
        [] => Err(deck.source.fault(card.place, format!("{} has no values", card.name))),
        [_, second, ..] => {
            let message =
                format!("{} has a second line: values that depend on the temperature are not read", card.name);
            Err(deck.source.fault(second.place, message))
        }
    }
}

/// Passes over the temperature of the only values: they hold at any.
fn without_temperature(fields: &mut Fields) -> Result<(), Error> {
    fields.finite_or_zero("the temperature")?;
    fields.end()
}
