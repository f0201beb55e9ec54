//! Materials of a deck, and the sections that give them to elements.

use std::collections::HashMap;

use serde_json::{Value, json};

use signorini_fem::geometry::minus;
use signorini_fem::mesh::deck::{DataFields, Deck, DeckCard, DeckPlace, Space, key};
use signorini_fem::{Error, nearly};

#[derive(Clone, Debug, Default)]
struct GivenMaterial {
    /// As a scene has it.
    elastic: Option<Value>,
    density: Option<f64>,
    /// Along the axes of the material.
    expansion: Option<[f64; 3]>,
}

/// A section: a set of elements with a material.
pub(super) struct Section {
    /// The name of the set.
    pub group: String,
    pub place: DeckPlace,
    /// The material as a scene has it.
    pub material: Value,
    pub expands: bool,
}

/// The sections of a deck, and the number of the section of each element.
pub(super) struct Sections {
    pub all: Vec<Section>,
    pub of_element: Vec<usize>,
    /// What is read, but may not be meant.
    pub noted: Vec<(DeckPlace, String)>,
    /// The one thickness of a plane model.
    pub thickness: Option<(f64, DeckPlace)>,
}

impl Sections {
    pub fn of(deck: &Deck, space: Space) -> Result<Self, Error> {
        let mut noted = Vec::new();
        let (materials, orientations) = (materials(deck, &mut noted)?, orientations(deck)?);
        let names: Vec<&str> = materials.keys().map(String::as_str).collect();
        let mut sections = Sections { all: Vec::new(), of_element: Vec::new(), noted, thickness: None };
        let mut of_element: Vec<Option<usize>> = vec![None; deck.elements.len()];
        for card in deck.source.cards_of("SOLIDSECTION") {
            let (Some(group), Some(material)) = (card.value("ELSET"), card.value("MATERIAL")) else {
                return Err(card.fault("*SOLID SECTION needs ELSET=NAME and MATERIAL=NAME"));
            };
            let Some(set) = deck.elements.sets.named(group) else {
                return Err(card.fault(format!("there is no set of elements `{group}`")));
            };
            let Some(given) = materials.get(&key(material)) else {
                let meant = nearly(&key(material), names.iter().copied());
                return Err(card.fault(format!("there is no material `{material}`{meant}")));
            };
            let value = card.placed(given.value())?;
            let Some(mut value) = value else {
                return Err(card.fault(format!("the material `{material}` has no *ELASTIC")));
            };
            sections.read_thickness(card, space)?;
            if let Some(name) = card.value("ORIENTATION") {
                let orientation = orientations.get(&key(name));
                let orientation = orientation.ok_or_else(|| format!("there is no *ORIENTATION `{name}`"));
                card.placed(orientation.and_then(|orientation| orientation.turn(&mut value, space)))?;
            }
            set.members.iter().for_each(|&element| of_element[element] = Some(sections.all.len()));
            let expands = given.expansion.is_some();
            sections.all.push(Section { group: set.name.clone(), place: card.place, material: value, expands });
        }
        if let Some(element) = of_element.iter().position(Option::is_none) {
            let number = deck.elements.numbers[element];
            let message = format!("element {number} has no *SOLID SECTION, and therefore no material");
            return Err(deck.fault(deck.element_list[element].place, message));
        }
        sections.of_element = of_element.into_iter().flatten().collect();
        Ok(sections)
    }

    fn read_thickness(&mut self, card: DeckCard, space: Space) -> Result<(), Error> {
        let (mut value, mut place) = (0.0, card.place);
        if let Some(mut fields) = card.fields().next() {
            place = fields.place;
            value = fields.finite_or_zero("the thickness")?;
            fields.end()?;
        }
        if let Some(second) = card.fields().nth(1) {
            return Err(second.fault("a section has one line, with its thickness"));
        }
        let value = if value == 0.0 { 1.0 } else { value };
        if !matches!(space, Space::PlaneStress | Space::PlaneStrain) {
            return Ok(());
        }
        match self.thickness {
            Some((other, at)) if other != value => {
                let message = format!(
                    "the thickness is {value}, but that of {} is {other}; a plane model has one thickness",
                    card.source.named(at)
                );
                Err(card.source.fault(place, message))
            }
            _ => {
                self.thickness = Some((value, place));
                Ok(())
            }
        }
    }
}

impl GivenMaterial {
    /// As a scene has it; `None` without elasticity.
    ///
    /// # Errors
    /// A sentence for an isotropic material that expands by different amounts.
    fn value(&self) -> Result<Option<Value>, String> {
        let Some(mut value) = self.elastic.clone() else { return Ok(None) };
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

/// The six numbers of a line: two points, or two vectors.
pub(super) fn two_points(mut fields: DataFields) -> Result<[[f64; 3]; 2], Error> {
    let mut points = [[0.0; 3]; 2];
    for (part, what) in points.as_flattened_mut().iter_mut().zip(["Xa", "Ya", "Za", "Xb", "Yb", "Zb"]) {
        *part = fields.finite_or_zero(what)?;
    }
    fields.end()?;
    Ok(points)
}

/// The orientations by their names in capitals.
fn orientations(deck: &Deck) -> Result<HashMap<String, Orientation>, Error> {
    let mut all = HashMap::new();
    for card in deck.source.cards_of("ORIENTATION") {
        let name = card.named()?;
        let axes = two_points(only_line(card)?)?;
        let orientation = match card.value("SYSTEM").map_or_else(|| "RECTANGULAR".into(), key).as_str() {
            "RECTANGULAR" => Orientation::Rectangular(axes),
            "CYLINDRICAL" => Orientation::Cylindrical(axes),
            other => {
                let message = format!("SYSTEM={other} is not read; there are RECTANGULAR and CYLINDRICAL");
                return Err(card.fault(message));
            }
        };
        if all.insert(key(name), orientation).is_some() {
            return Err(card.fault(format!("there are two orientations `{name}`")));
        }
    }
    Ok(all)
}

/// The materials by their names in capitals.
fn materials(deck: &Deck, noted: &mut Vec<(DeckPlace, String)>) -> Result<HashMap<String, GivenMaterial>, Error> {
    let mut materials: HashMap<String, GivenMaterial> = HashMap::new();
    let mut current: Option<String> = None;
    for card in deck.source.cards() {
        let fault = |message: String| Err(card.fault(message));
        if card.is("MATERIAL") {
            let name = card.named()?;
            if materials.insert(key(name), GivenMaterial::default()).is_some() {
                return fault(format!("there are two materials `{name}`"));
            }
            current = Some(key(name));
            continue;
        }
        if !card.is_any(&["ELASTIC", "DENSITY", "EXPANSION"]) {
            continue;
        }
        let Some(material) = current.as_ref().and_then(|name| materials.get_mut(name)) else {
            return fault(format!("{} follows no *MATERIAL", card.name));
        };
        let is_twice = if card.is("ELASTIC") {
            material.elastic.replace(elastic(card)?).is_some()
        } else if card.is("DENSITY") {
            material.density.replace(one(card, "the density")?).is_some()
        } else {
            let expansion = match card.value("TYPE").map(key).as_deref() {
                None | Some("ISO" | "ISOTROPIC") => [one(card, "the expansion")?; 3],
                Some("ORTHO" | "ORTHOTROPIC") => {
                    let mut fields = only_line(card)?;
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

/// The elasticity of a card, as a scene has it.
fn elastic(card: DeckCard) -> Result<Value, Error> {
    let of_type = card.value("TYPE").map_or_else(|| "ISO".into(), key);
    match of_type.as_str() {
        "ISO" | "ISOTROPIC" => {
            let mut fields = only_line(card)?;
            let (young, poisson) = (fields.finite("Young's modulus")?, fields.finite("Poisson's ratio")?);
            without_temperature(&mut fields)?;
            Ok(json!({"young": young, "poisson": poisson}))
        }
        "ENGINEERINGCONSTANTS" => {
            const NAMES: [&str; 9] = ["E1", "E2", "E3", "nu12", "nu13", "nu23", "G12", "G13", "G23"];
            let mut lines = card.fields();
            let (Some(mut fields), Some(mut second), None) = (lines.next(), lines.next(), lines.next()) else {
                let message = "nine constants are read: eight in the first line, G23 in the second; none may depend on a temperature";
                return Err(card.fault(message));
            };
            let mut constants = [0.0; 9];
            for (constant, name) in constants.iter_mut().zip(NAMES).take(8) {
                *constant = fields.finite(name)?;
            }
            fields.end()?;
            constants[8] = second.finite(NAMES[8])?;
            without_temperature(&mut second)?;
            let [e1, e2, e3, nu12, nu13, nu23, g12, g13, g23] = constants;
            Ok(json!({"orthotropic": {
                "young": [e1, e2, e3], "poisson": [nu12, nu23, nu13], "shear": [g12, g23, g13]}}))
        }
        _ => {
            let message = "this type of *ELASTIC is not read; there are ISO and ENGINEERING CONSTANTS";
            Err(card.fault(message))
        }
    }
}

/// The one number of a card that does not depend on a temperature.
fn one(card: DeckCard, what: &str) -> Result<f64, Error> {
    let mut fields = only_line(card)?;
    let value = fields.finite(what)?;
    without_temperature(&mut fields)?;
    Ok(value)
}

fn only_line(card: DeckCard<'_>) -> Result<DataFields<'_>, Error> {
    match &card.lines[..] {
        [line] => Ok(card.source.fields(line)),
        [] => Err(card.fault(format!("{} has no values", card.name))),
        [_, second, ..] => {
            let message =
                format!("{} has a second line: values that depend on the temperature are not read", card.name);
            Err(card.source.fault(second.place, message))
        }
    }
}

/// Passes over the temperature of the only values: they hold at any.
fn without_temperature(fields: &mut DataFields) -> Result<(), Error> {
    fields.finite_or_zero("the temperature")?;
    fields.end()
}
