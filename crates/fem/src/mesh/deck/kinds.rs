//! The elements of decks by name, with the nearest element of this library.
//!
//! # Source
//! G. Dhondt, *CalculiX CrunchiX User's Manual*, chapter "Element types": nodes and faces have the order of this
//! library.

use super::source::DeckPlace;
use crate::element::ElementKind;

/// The space that the elements of a deck are made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Space {
    PlaneStress,
    PlaneStrain,
    Axisymmetric,
    Solid,
    /// Lines and sheets, which mesh generators write beside a body: they are left out where they lie on it.
    Line,
    Sheet,
}

/// An element type of decks, with the element of this library for it.
#[derive(Debug, PartialEq)]
pub struct DeckElementType {
    /// Its name, as `C3D8I`.
    pub name: &'static str,
    pub space: Space,
    /// Number of nodes that the deck lists for such an element.
    pub nodes: usize,
    /// How the nearest element of this library differs; empty if it does not.
    pub differs: &'static [&'static str],
}

const fn element(name: &'static str, space: Space, nodes: usize, differs: &'static [&'static str]) -> DeckElementType {
    DeckElementType { name, space, nodes, differs }
}

const INCOMPATIBLE: &str = "without incompatible modes, and therefore stiffer in bending";
const REDUCED: &str = "with full instead of reduced integration, and therefore stiffer in bending";
const REDUCED_QUADRATIC: &str = "with full instead of reduced integration, and therefore a little stiffer";

const EXPANDED: &str = "with no stress across the plane at any point; CalculiX takes solid elements, which are a little stiffer near supports";
const WEDGE: &str = "of a full circle; CalculiX takes a wedge of two degrees with flat sides, so that forces of pressures differ by 2e-4";

/// All elements that are read, and those that are left out where they lie on a body.
pub static TYPES: [DeckElementType; 38] = {
    use Space::{Axisymmetric, Line, PlaneStrain, PlaneStress, Sheet, Solid};
    [
        element("C3D4", Solid, 4, &[]),
        element("C3D8", Solid, 8, &[]),
        element("C3D8I", Solid, 8, &[INCOMPATIBLE]),
        element("C3D8R", Solid, 8, &[REDUCED]),
        element("C3D10", Solid, 10, &[]),
        element("C3D20", Solid, 20, &[]),
        element("C3D20R", Solid, 20, &[REDUCED_QUADRATIC]),
        element("CPS3", PlaneStress, 3, &[EXPANDED]),
        element("CPS4", PlaneStress, 4, &[EXPANDED]),
        element("CPS4R", PlaneStress, 4, &[REDUCED, EXPANDED]),
        element("CPS6", PlaneStress, 6, &[EXPANDED]),
        element("CPS8", PlaneStress, 8, &[EXPANDED]),
        element("CPS8R", PlaneStress, 8, &[REDUCED_QUADRATIC, EXPANDED]),
        element("CPE3", PlaneStrain, 3, &[]),
        element("CPE4", PlaneStrain, 4, &[]),
        element("CPE4R", PlaneStrain, 4, &[REDUCED]),
        element("CPE6", PlaneStrain, 6, &[]),
        element("CPE8", PlaneStrain, 8, &[]),
        element("CPE8R", PlaneStrain, 8, &[REDUCED_QUADRATIC]),
        element("CAX3", Axisymmetric, 3, &[WEDGE]),
        element("CAX4", Axisymmetric, 4, &[WEDGE]),
        element("CAX4R", Axisymmetric, 4, &[REDUCED, WEDGE]),
        element("CAX6", Axisymmetric, 6, &[WEDGE]),
        element("CAX8", Axisymmetric, 8, &[WEDGE]),
        element("CAX8R", Axisymmetric, 8, &[REDUCED_QUADRATIC, WEDGE]),
        element("T2D2", Line, 2, &[]),
        element("T3D2", Line, 2, &[]),
        element("T3D3", Line, 3, &[]),
        element("B31", Line, 2, &[]),
        element("B32", Line, 3, &[]),
        element("S3", Sheet, 3, &[]),
        element("S4", Sheet, 4, &[]),
        element("S4R", Sheet, 4, &[]),
        element("S6", Sheet, 6, &[]),
        element("S8", Sheet, 8, &[]),
        element("S8R", Sheet, 8, &[]),
        element("M3D3", Sheet, 3, &[]),
        element("M3D4", Sheet, 4, &[]),
    ]
};

impl DeckElementType {
    /// Number of dimensions of the element itself.
    pub fn dimension(&self) -> usize {
        match self.space {
            Space::Solid => 3,
            Space::Line => 1,
            _ => 2,
        }
    }

    /// The nearest element of this library: the one with as many nodes and dimensions; `None` for what is left out.
    pub fn kind(&self) -> Option<ElementKind> {
        let is_read = !matches!(self.space, Space::Line | Space::Sheet);
        let is_near = |kind: &ElementKind| kind.nodes() == self.nodes && kind.dimension() == self.dimension();
        ElementKind::ALL.into_iter().find(|kind| is_read && is_near(kind))
    }
}

/// The element of this name in capitals.
pub(super) fn element_type(name: &str) -> Result<&'static DeckElementType, String> {
    TYPES.iter().find(|element| element.name == name).ok_or_else(|| refusal(name))
}

/// A sentence that names what an element is that is not read, and what is read.
pub(super) fn refusal(name: &str) -> String {
    let family = match name {
        _ if name.starts_with("C3D6") || name.starts_with("C3D15") => "wedges",
        _ if name.starts_with("C3D") => "elements in space of another form",
        _ if name.starts_with("SPRING") => "springs",
        _ if name.starts_with("DASHPOT") => "dampers",
        _ if name.starts_with("SC") || name.starts_with("STRI") => "shells",
        _ if name.starts_with('S') => "shells",
        _ if name.starts_with('B') => "beams",
        _ if name.starts_with("T2D") || name.starts_with("T3D") => "trusses",
        _ if name.starts_with('M') => "membranes or masses",
        _ => "elements of this type",
    };
    let read = TYPES.iter().filter(|element| element.kind().is_some());
    let names: Vec<&str> = read.map(|element| element.name).collect();
    format!("the element type {name} is not read: {family} are not modelled; there are {}", names.join(", "))
}

/// The kinds of spring elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpringType {
    /// Between two nodes, along the line through them.
    Along,
    /// Between a displacement of a node and the ground.
    ToGround,
    /// Between displacements of two nodes.
    Between,
}

impl SpringType {
    /// The kind of this name in capitals.
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "SPRINGA" => Some(SpringType::Along),
            "SPRING1" => Some(SpringType::ToGround),
            "SPRING2" => Some(SpringType::Between),
            _ => None,
        }
    }

    /// Number of nodes of a spring element of this type: 1 or 2.
    pub fn nodes(self) -> usize {
        if self == SpringType::ToGround { 1 } else { 2 }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct SpringElement {
    pub of_type: SpringType,
    /// Its nodes, by their places; one or two.
    pub nodes: Vec<usize>,
    pub place: DeckPlace,
}
