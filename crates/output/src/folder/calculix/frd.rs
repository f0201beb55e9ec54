//! `NAME.frd`: nodes, elements and nodal fields.

use std::io::{self, Write};

use super::content::Content;
use super::numbers::{checked, wide};
use signorini_mechanics::Error;

/// The labels of fields that the file has.
pub(super) const GIVEN: [&str; 7] = ["U", "S", "E", "RF", "NT", "CDIS", "CSTR"];

/// Most letters of the title.
const TITLE: usize = 66;

/// Nodes of an element on a line.
const ON_A_LINE: usize = 10;

/// Digits behind the point of a number in a `.frd` file.
const DIGITS: usize = 5;

/// A component: its name and its kind, as scalar, vector or tensor, with its places in it.
type Component = (&'static str, [usize; 3]);

const DISPLACEMENT: [Component; 3] = [("D1", [2, 1, 0]), ("D2", [2, 2, 0]), ("D3", [2, 3, 0])];
const FORCE: [Component; 3] = [("F1", [2, 1, 0]), ("F2", [2, 2, 0]), ("F3", [2, 3, 0])];
const TEMPERATURE: [Component; 1] = [("T", [1, 0, 0])];
const STRESS: [Component; 6] = tensor(["SXX", "SYY", "SZZ", "SXY", "SYZ", "SZX"]);
const STRAIN: [Component; 6] = tensor(["EXX", "EYY", "EZZ", "EXY", "EYZ", "EZX"]);
const CONTACT: [Component; 6] = tensor(["COPEN", "CSLIP1", "CSLIP2", "CPRESS", "CSHEAR1", "CSHEAR2"]);

const fn tensor([xx, yy, zz, xy, yz, zx]: [&'static str; 6]) -> [Component; 6] {
    [(xx, [4, 1, 1]), (yy, [4, 2, 2]), (zz, [4, 3, 3]), (xy, [4, 1, 2]), (yz, [4, 2, 3]), (zx, [4, 3, 1])]
}

/// A field at the nodes, in the order of the mesh.
struct Field {
    name: &'static str,
    components: &'static [Component],
    values: Vec<f64>,
}

impl Field {
    fn new<const N: usize>(
        name: &'static str,
        components: &'static [Component; N],
        values: Vec<[f64; N]>,
    ) -> Result<Self, Error> {
        Ok(Field { name, components, values: checked(name, values.into_flattened())? })
    }
}

/// The fields of an answer to a deck.
pub(super) struct Fields<'a> {
    content: &'a Content<'a>,
    coordinates: Vec<f64>,
    fields: Vec<Field>,
}

impl<'a> Fields<'a> {
    /// The fields in the order of CalculiX: displacement and stress, contact if there is a row, and the others if the
    /// deck asks for them.
    pub fn of(content: &'a Content<'a>) -> Result<Self, Error> {
        let asks = |label: &str| content.requests.fields.contains(label);
        let (answer, mesh) = (content.answer, content.answer.model().mesh());
        let mut fields = vec![Field::new("DISP", &DISPLACEMENT, content.displacements())?];
        if asks("NT") {
            fields.push(Field::new("NDTEMP", &TEMPERATURE, content.temperatures())?);
        }
        let stress = &answer.stress()?.nodes;
        fields.push(Field::new("STRESS", &STRESS, stress.iter().map(|stress| stress.components()).collect())?);
        if asks("E") {
            fields.push(Field::new("TOSTRAIN", &STRAIN, answer.strain()?)?);
        }
        if asks("RF") {
            fields.push(Field::new("FORC", &FORCE, content.forces()?)?);
        }
        if !answer.model().rows().is_empty() {
            let mut values = vec![[0.0; 6]; mesh.nodes().len()];
            for (row, gap, pressure) in content.contacts() {
                // Of several contacts of a node the one with the largest pressure.
                let [open, _, _, pressed, ..] = &mut values[row.node];
                if pressure >= *pressed {
                    (*open, *pressed) = (gap, pressure);
                }
            }
            fields.push(Field::new("CONTACT", &CONTACT, values)?);
        }
        let coordinates = checked("the nodes", mesh.nodes().as_flattened().to_vec())?;
        Ok(Fields { content, coordinates, fields })
    }

    /// Writes nodes and elements.
    pub fn write_mesh(&self, out: &mut dyn Write) -> io::Result<()> {
        let Content { answer, nodes, elements, numbers, .. } = self.content;
        let mesh = answer.model().mesh();
        let title: String = answer.model().title().chars().take(TITLE).map(ascii).collect();
        writeln!(out, "    1C\n    1U{title:<TITLE$}")?;
        writeln!(out, "    1UPGM               signorini\n    1UVERSION           {}", env!("CARGO_PKG_VERSION"))?;
        writeln!(out, "    2C{:>30}{:>38}", nodes.len(), 1)?;
        self.lines(out, &self.coordinates, 3)?;
        writeln!(out, " -3\n    3C{:>30}{:>38}", elements.len(), 1)?;
        for &(number, element) in elements {
            let cell = &mesh.kind_of(element).reference().calculix;
            writeln!(out, " -1{number:>10}{:>5}{:>5}{:>5}", cell.number, 0, 1)?;
            let own = mesh.element(element);
            for locals in cell.order.chunks(ON_A_LINE) {
                let line: String = locals.iter().map(|&local| format!("{:>10}", numbers[own[local]])).collect();
                writeln!(out, " -2{line}")?;
            }
        }
        writeln!(out, " -3")
    }

    /// Writes the fields; `written` counts those of all steps.
    pub fn write(&self, out: &mut dyn Write, written: &mut usize) -> io::Result<()> {
        for field in &self.fields {
            *written += 1;
            self.field(out, *written, field)?;
        }
        Ok(())
    }

    fn field(&self, out: &mut dyn Write, index: usize, field: &Field) -> io::Result<()> {
        let (count, step) = (self.content.nodes.len(), self.content.requests.step);
        let time = self.content.requests.time;
        let time = if (1.0..1e9).contains(&time) { format!("{time:.9}") } else { wide(time, DIGITS) };
        writeln!(out, "    1PSTEP{index:>26}{:>12}{step:>12}          ", 1)?;
        writeln!(out, "  100CL{:>5}{:>12.12}{count:>12}{:>22}{step:>5}{:>12}", 100 + step, &time, 0, 1)?;
        let is_vector = field.components[0].1[0] == 2;
        writeln!(out, " -4  {:<8}{:>5}{:>5}", field.name, field.components.len() + usize::from(is_vector), 1)?;
        for (name, [kind, row, column]) in field.components {
            writeln!(out, " -5  {name:<8}{:>5}{kind:>5}{row:>5}{column:>5}", 1)?;
        }
        if is_vector {
            // The size of the vector, which the reader computes.
            writeln!(out, " -5  {:<8}{:>5}{:>5}{:>5}{:>5}{:>5}ALL", "ALL", 1, 2, 0, 0, 1)?;
        }
        self.lines(out, &field.values, field.components.len())?;
        writeln!(out, " -3")
    }

    /// A line for each node, with `count` values.
    fn lines(&self, out: &mut dyn Write, values: &[f64], count: usize) -> io::Result<()> {
        for &(number, node) in &self.content.nodes {
            write!(out, " -1{number:>10}")?;
            let own = &values[count * node..count * (node + 1)];
            own.iter().try_for_each(|&value| write!(out, "{}", wide(value, DIGITS)))?;
            writeln!(out)?;
        }
        Ok(())
    }
}

/// A letter that every reader knows.
fn ascii(letter: char) -> char {
    if letter.is_ascii_graphic() || letter == ' ' { letter } else { '?' }
}
