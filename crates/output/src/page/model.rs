//! The whole content of a page, in the form that is serialised into it.

use serde::Serialize;
use serde_json::Value;

use super::about::About;
use super::along::AlongShown;
use super::body::{Body, Shape};
use super::modes::ModeShown;
use super::motion::MotionShown;
use super::packed::{Packed, Packer};
use super::plots::PlotShown;
use super::question::Question;
use super::rows::{Contact, Rows};
use super::search::Search;
use super::state::State;
use super::sweep::SweepShown;
use crate::draw::colour::{Colour, PALETTE, field_colour};
use crate::reports::certificate::CertificateWords;
use crate::view::field::{self, FIELDS, Field};
use signorini_mechanics::scene::{Model, Units};

/// Colours of a field, from its lowest value to its highest.
const FIELD_COLOURS: usize = 17;

/// A page; missing fields do not belong to its command.
#[derive(Debug, Serialize)]
pub(super) struct Page<'a> {
    pub about: &'a About,
    pub units: PageUnits,
    pub colours: Colours,
    /// The fields that colour a body.
    pub fields: Vec<FieldShown>,
    /// The object of `report.json`, without seconds except for a trade-off; null for a sweep, which has its points in
    /// `sweep`.
    #[serde(skip_serializing_if = "Value::is_null")]
    pub report: Value,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub certificate: Option<CertificateWords>,
    /// The proven part of the contact set, in words.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub proven: Option<String>,
    /// What closed and open mean for rows between meshes that do not match.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub means: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub body: Option<Body>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub question: Option<Question>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rows: Option<Rows>,
    /// The answer, the corners of a sweep, or the frames of a motion.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub states: Vec<State>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contact: Option<Contact>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub search: Option<Search>,
    /// The pressure of each method at every row.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub pressures: Vec<Packed>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub along: Vec<AlongShown>,
    /// The curves of a sweep, of a motion or of a search for an error.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub plots: Vec<PlotShown>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sweep: Option<SweepShown<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<MotionShown>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub modes: Vec<ModeShown>,
}

#[derive(Debug, Serialize)]
pub(super) struct PageUnits {
    length: String,
    force: String,
    pressure: String,
}

/// A field that colours a body; displacement and pressure are not among them.
#[derive(Debug, Serialize)]
pub(super) struct FieldShown {
    name: &'static str,
    words: &'static str,
    symbol: &'static str,
    unit: String,
}

#[derive(Debug, Serialize)]
pub(super) struct Colours {
    /// Of a field, evenly from its lowest value to its highest.
    field: Vec<String>,
    /// Of lines in plots.
    lines: Vec<String>,
}

impl FieldShown {
    fn of(field: &Field, units: &Units) -> Option<Self> {
        let field::Colours { words, symbol, .. } = field.colours?;
        Some(FieldShown { name: field.name, words, symbol, unit: (field.unit)(units) })
    }
}

impl<'a> Page<'a> {
    /// A page without anything to draw.
    pub fn new(about: &'a About, units: &Units) -> Self {
        let hex = |Colour(red, green, blue): Colour| format!("#{red:02x}{green:02x}{blue:02x}");
        let share = |index: usize| index as f64 / (FIELD_COLOURS - 1) as f64;
        Page {
            about,
            units: PageUnits { length: units.length.clone(), force: units.force.clone(), pressure: units.pressure() },
            colours: Colours {
                field: (0..FIELD_COLOURS).map(|index| hex(field_colour(share(index)))).collect(),
                lines: PALETTE.into_iter().map(hex).collect(),
            },
            fields: FIELDS.iter().filter_map(|field| FieldShown::of(field, units)).collect(),
            report: Value::Null,
            certificate: None,
            proven: None,
            means: None,
            body: None,
            question: None,
            rows: None,
            states: Vec::new(),
            contact: None,
            search: None,
            pressures: Vec::new(),
            along: Vec::new(),
            plots: Vec::new(),
            sweep: None,
            motion: None,
            modes: Vec::new(),
        }
    }

    /// The same with the body and its question (supports, loads, obstacles).
    pub fn of_model(about: &'a About, model: &Model, shape: &Shape, packer: &mut Packer) -> Self {
        Page {
            body: Some(shape.packed(model, packer)),
            question: Some(Question::of(model, shape, packer)),
            rows: Some(Rows::of(model, shape, packer)),
            ..Page::new(about, model.units())
        }
    }

    /// The title that [`About`] gives the page.
    pub fn title(&self) -> &str {
        &self.about.title
    }
}
