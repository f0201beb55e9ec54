//! The parameters of a scene: its numbers by name.

use serde_json::Value;

use crate::error::{Error, nearly};
use crate::scene::input::entry::wrong;
use crate::scene::input::schema::Scene;

/// Names that an error lists, at most.
const MOST_LISTED: usize = 40;

/// Numbers of a shape that are no lengths: directions and slopes.
const NO_LENGTHS: [&str; 4] = ["normal", "axis", "slope", "angle"];

/// A number of a scene, or the places of all nodes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Variable {
    /// As `obstacles[0].radius`.
    pub name: String,
    pub kind: Datum,
    /// Its value; zero for the places of the nodes.
    pub value: f64,
    /// The unit of the parameter; empty if it is dimensionless.
    pub unit: String,
}

/// The part of a scene that a parameter is a number of.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Datum {
    Gap,
    GapOf(usize),
    Force(usize),
    /// A factor of a load, which is one.
    Load(usize),
    /// A number of a load, by its place in the text of the load.
    InLoad(usize, String),
    /// A number of the shape of an obstacle, by its place in the text of the shape.
    InShape(usize, String),
    /// Young's modulus of a material, by its place in the text of the scene.
    Young(String),
    /// Poisson's ratio of a material, by its place in the text of the scene.
    Poisson(String),
    /// The temperature at the origin of an entry, by its place.
    Temperature(String),
    Places,
}

pub(crate) fn named(scene: &Scene, name: &str) -> Result<Variable, Error> {
    let all = all(scene);
    if let Some(found) = all.iter().find(|parameter| parameter.name == name) {
        return Ok(found.clone());
    }
    let names = || all.iter().map(|parameter| parameter.name.as_str());
    let listed: Vec<String> = names().take(MOST_LISTED).map(|name| format!("`{name}`")).collect();
    let more = if all.len() > MOST_LISTED { format!(" and {} more", all.len() - MOST_LISTED) } else { String::new() };
    let meant = nearly(name, names());
    Err(wrong("--to", format!("there is no parameter `{name}`; there are {}{more}{meant}", listed.join(", "))))
}

pub(crate) fn all(scene: &Scene) -> Vec<Variable> {
    let (length, force) = (scene.units.length.clone(), scene.units.force.clone());
    let (pressure, none) = (scene.units.pressure(), String::new);
    let mut all = Vec::new();
    let mut add = |name: String, kind: Datum, value: f64, unit: String| all.push(Variable { name, kind, value, unit });
    if !scene.obstacles.is_empty() {
        add("gap".into(), Datum::Gap, scene.gap, length.clone());
    }
    for (index, obstacle) in scene.obstacles.iter().enumerate() {
        let named = |field: &str| format!("obstacles[{index}].{field}");
        match obstacle.force {
            Some(value) => add(named("force"), Datum::Force(index), value, force.clone()),
            None => add(named("gap"), Datum::GapOf(index), obstacle.gap.unwrap_or(0.0), length.clone()),
        }
        if obstacle.shape.shape().other_boundary().is_some() {
            continue;
        }
        for (pointer, value) in numbers_of(&obstacle.shape) {
            let is_length = !NO_LENGTHS.iter().any(|word| pointer.split('/').any(|part| part == *word));
            let unit = if is_length { length.clone() } else { none() };
            add(named(&in_words(&pointer)), Datum::InShape(index, pointer), value, unit);
        }
    }
    for (index, load) in scene.loads.iter().enumerate() {
        add(format!("loads[{index}]"), Datum::Load(index), 1.0, none());
        for (pointer, value) in numbers_of(load) {
            let name = in_words(&pointer);
            let name = if name.starts_with('[') || name.is_empty() { name } else { format!(".{name}") };
            // A load of one number is that number.
            let name = if name.is_empty() { ".value".to_string() } else { name };
            let unit = match pointer.split('/').nth(1) {
                Some("traction" | "pressure") if pointer.contains("/value") => pressure.clone(),
                Some("force") if pointer.contains("/value") => force.clone(),
                Some("nodal-forces") => force.clone(),
                _ => none(),
            };
            add(format!("loads[{index}]{name}"), Datum::InLoad(index, pointer), value, unit);
        }
    }
    let text = serde_json::to_value(scene).unwrap_or_default();
    let number = |pointer: &str| text.pointer(pointer).and_then(Value::as_f64);
    let count = |pointer: String| text.pointer(&pointer).and_then(Value::as_array).map_or(0, Vec::len);
    let further = (0..scene.further_bodies.len())
        .map(|body| (format!("further-bodies[{body}]."), format!("/further-bodies/{body}")));
    let bodies: Vec<(String, String)> = std::iter::once((String::new(), String::new())).chain(further).collect();
    for (name, body) in &bodies {
        let of_part = |part| (format!("{name}materials[{part}]."), format!("{body}/materials/{part}/material"));
        let parts = (0..count(format!("{body}/materials"))).map(of_part);
        for (name, material) in std::iter::once((name.clone(), format!("{body}/material"))).chain(parts) {
            let [young, poisson] = ["young", "poisson"].map(|key| format!("{material}/{key}"));
            if let Some(value) = number(&young) {
                add(format!("{name}young"), Datum::Young(young), value, pressure.clone());
            }
            if let Some(value) = number(&poisson) {
                add(format!("{name}poisson"), Datum::Poisson(poisson), value, none());
            }
        }
    }
    for (name, body) in &bodies {
        for entry in 0..count(format!("{body}/temperature")) {
            let place = format!("{body}/temperature/{entry}/value");
            if let Some(value) = number(&place) {
                let name = format!("{name}temperature[{entry}]");
                add(name, Datum::Temperature(place), value, "degree".into());
            }
        }
    }
    add("nodes".into(), Datum::Places, 0.0, length);
    all
}

/// The scene with a parameter of its shapes, loads, materials or temperatures changed by `by`.
pub(crate) fn varied(scene: &Scene, parameter: &Variable, by: f64) -> Result<Scene, Error> {
    let mut varied = scene.clone();
    let value = parameter.value + by;
    let refused = |error: serde_json::Error| wrong(parameter.name.as_str(), error.to_string());
    match &parameter.kind {
        Datum::Gap => varied.gap = value,
        Datum::GapOf(index) => varied.obstacles[*index].gap = Some(value),
        Datum::Force(index) => varied.obstacles[*index].force = Some(value),
        Datum::InLoad(index, place) => {
            varied.loads[*index] = with_numbers(&scene.loads[*index], [(place, value)]).map_err(refused)?;
        }
        Datum::InShape(index, place) => {
            let shape = &scene.obstacles[*index].shape;
            varied.obstacles[*index].shape = with_numbers(shape, [(place, value)]).map_err(refused)?;
        }
        Datum::Young(place) | Datum::Poisson(place) | Datum::Temperature(place) => {
            let changed: Scene = with_numbers(scene, [(place, value)]).map_err(refused)?;
            let (folder, reads_outside, is_linear) = (scene.folder.clone(), scene.reads_outside, scene.is_linear);
            varied = Scene { folder, reads_outside, is_linear, noted: scene.noted.clone(), ..changed };
        }
        Datum::Load(index) => {
            let numbers = numbers_of(&scene.loads[*index]);
            let times = numbers.iter().filter_map(|(place, number)| match is_linear_in(place) {
                true => Some((place, number * value)),
                false if place.ends_with("/omega") => Some((place, number * value.max(0.0).sqrt())),
                false => None,
            });
            varied.loads[*index] = with_numbers(&scene.loads[*index], times).map_err(refused)?;
        }
        Datum::Places => return Err(wrong("nodes", "the places of all nodes are no single number")),
    }
    Ok(varied)
}

impl Variable {
    /// Returns `true` for a number of a load to which its forces are proportional.
    pub fn is_linear(&self) -> bool {
        matches!(&self.kind, Datum::InLoad(_, pointer) if is_linear_in(pointer))
    }
}

/// The scene with a one in the place of a number to which a load is proportional, and zeros in those of its other
/// components.
pub(crate) fn unit_load(scene: &Scene, parameter: &Variable) -> Result<Scene, Error> {
    let mut unit = scene.clone();
    let Datum::InLoad(index, own) = &parameter.kind else { return Ok(unit) };
    let numbers = numbers_of(&scene.loads[*index]);
    let linear = numbers.iter().map(|(place, _)| place).filter(|place| is_linear_in(place));
    let ones = linear.map(|place| (place, if place == own { 1.0 } else { 0.0 }));
    unit.loads[*index] =
        with_numbers(&scene.loads[*index], ones).map_err(|error| wrong(parameter.name.as_str(), error.to_string()))?;
    Ok(unit)
}

/// Returns `true` for the place of a number to which a load is proportional.
fn is_linear_in(pointer: &str) -> bool {
    match pointer.split('/').nth(1) {
        Some("body-force" | "gravity" | "nodal-forces") => true,
        _ => pointer.contains("/value"),
    }
}

/// All numbers of a part of a scene, with their places in its text.
fn numbers_of(part: &impl serde::Serialize) -> Vec<(String, f64)> {
    fn collect(value: &Value, place: String, found: &mut Vec<(String, f64)>) {
        match value {
            Value::Number(number) => found.extend(number.as_f64().map(|number| (place, number))),
            Value::Array(entries) => {
                entries.iter().enumerate().for_each(|(index, entry)| collect(entry, format!("{place}/{index}"), found));
            }
            Value::Object(fields) => {
                fields.iter().for_each(|(key, field)| collect(field, format!("{place}/{key}"), found));
            }
            Value::Null | Value::Bool(_) | Value::String(_) => {}
        }
    }
    let mut found = Vec::new();
    collect(&serde_json::to_value(part).unwrap_or_default(), String::new(), &mut found);
    found
}

/// The name of a number by its place, without the kind of its part: `apex[0]` of `/circle/apex/0`.
fn in_words(place: &str) -> String {
    let mut name = String::new();
    for part in place.split('/').skip(2) {
        match part.parse::<usize>() {
            Ok(index) => name.push_str(&format!("[{index}]")),
            Err(_) if name.is_empty() => name.push_str(part),
            Err(_) => name.push_str(&format!(".{part}")),
        }
    }
    name
}

/// A part of a scene with numbers at some places of its text.
fn with_numbers<'a, T: serde::Serialize + serde::de::DeserializeOwned>(
    part: &T,
    numbers: impl IntoIterator<Item = (&'a String, f64)>,
) -> Result<T, serde_json::Error> {
    let mut text = serde_json::to_value(part)?;
    for (place, value) in numbers {
        if let Some(entry) = text.pointer_mut(place) {
            *entry = Value::from(value);
        }
    }
    serde_json::from_value(text)
}
