//! `NAME.dat`: tables of nodes, elements and contacts.

use std::collections::HashMap;
use std::io::{self, Write};

use super::content::Content;
use super::numbers::{checked, time, wide};
use signorini_mechanics::Error;
use signorini_mechanics::scene::{ContactRow, RequestedTable};

/// The labels in the order of their tables, with the title of the values and that of their sum.
const TABLES: [(&str, &str, &str); 9] = [
    ("U", "displacements (vx,vy,vz)", ""),
    ("RF", "forces (fx,fy,fz)", "total force (fx,fy,fz)"),
    ("NT", "temperatures", ""),
    ("S", "stresses (elem, integ.pnt.,sxx,syy,szz,sxy,sxz,syz)", ""),
    ("E", "strains (elem, integ.pnt.,exx,eyy,ezz,exy,exz,eyz)", ""),
    ("EVOL", "volume (element, volume)", "total volume"),
    ("ELSE", "internal energy (element, energy)", "total internal energy"),
    ("CDIS", "relative contact displacement (slave node,normal,tang1,tang2)", ""),
    ("CSTR", "contact stress (slave node,press,tang1,tang2)", ""),
];

/// Digits behind the point of a number in a `.dat` file.
const DIGITS: usize = 6;

/// Returns `true` if the file has this table.
pub(super) fn is_given(table: &RequestedTable) -> bool {
    let [title, sum] = titles(table);
    match table.label.as_str() {
        "CF" => table.contact.is_some(),
        _ => !title.is_empty() && (table.parts || !sum.is_empty()),
    }
}

/// A table: its title up to the time, and its lines.
pub(super) struct Table {
    title: String,
    lines: Vec<Line>,
}

/// A line: a beginning, then values.
struct Line {
    head: String,
    values: Vec<f64>,
    /// Along local axes, which a letter at the end says.
    is_local: bool,
}

impl Line {
    fn new(title: &str, head: String, values: Vec<f64>) -> Result<Self, Error> {
        Ok(Line { head, values: checked(title, values)?, is_local: false })
    }
}

impl Table {
    fn new<const N: usize>(title: String, lines: Vec<(String, [f64; N])>) -> Result<Self, Error> {
        let lines = lines.into_iter().map(|(head, values)| Line::new(&title, head, values.to_vec()));
        Ok(Table { lines: lines.collect::<Result<_, Error>>()?, title })
    }

    pub fn write(&self, out: &mut dyn Write, end: f64) -> io::Result<()> {
        writeln!(out, "\n {} {}\n", self.title, time(end, 7))?;
        for Line { head, values, is_local } in &self.lines {
            write!(out, "{head}")?;
            values.iter().try_for_each(|&value| write!(out, " {}", wide(value, DIGITS)))?;
            writeln!(out, "{}", if *is_local { " L" } else { "" })?;
        }
        Ok(())
    }
}

/// The tables that the deck asks for and that the file has, in the order of CalculiX: of nodes, of points, of elements,
/// of contacts.
pub(super) fn tables(content: &Content) -> Result<Vec<Table>, Error> {
    let mut wanted: Vec<&RequestedTable> = content.requests.tables.iter().filter(|table| is_given(table)).collect();
    let rank = |table: &&RequestedTable| match table.label.as_str() {
        "U" | "RF" | "NT" => 0,
        "S" | "E" => 1,
        "EVOL" | "ELSE" => 2,
        _ => 3,
    };
    wanted.sort_by_key(rank);
    let mut tables = Vec::new();
    for table in wanted {
        match table.label.as_str() {
            "U" => {
                let of_mesh = content.displacements();
                let value = |number| content.of_node(number, &of_mesh, |[displacement, _]| first(*displacement));
                tables.extend(content.of_vectors(table, value)?);
            }
            "RF" => {
                let (of_mesh, share) = (content.forces()?, content.share());
                let value = |number| content.of_node(number, &of_mesh, |[_, force]| first(*force));
                tables.extend(content.of_vectors(table, |number| value(number).map(|part| share * part))?);
            }
            "NT" => {
                let given: HashMap<usize, f64> = content.requests.temperatures.iter().copied().collect();
                let value = |number: &usize| (*number, [given.get(number).copied().unwrap_or_default()]);
                tables.extend(with_sum(table, increasing(&table.numbers).iter().map(value).collect())?);
            }
            "S" | "E" => tables.push(content.of_points(table)?),
            "EVOL" | "ELSE" => tables.extend(content.of_elements(table)?),
            "CDIS" | "CSTR" => tables.push(content.of_contacts(table)?),
            _ => tables.extend(content.statistics(table)?),
        }
    }
    Ok(tables)
}

impl Content<'_> {
    /// Vectors of nodes along their local axes if the table asks for it, and their sum along x, y and z.
    fn of_vectors(&self, table: &RequestedTable, vector: impl Fn(usize) -> [f64; 3]) -> Result<Vec<Table>, Error> {
        let numbers = increasing(&table.numbers);
        let mut tables = with_sum(table, numbers.iter().map(|&number| (number, vector(number))).collect())?;
        if table.parts && table.is_local {
            for (line, number) in tables.iter_mut().take(1).flat_map(|values| &mut values.lines).zip(numbers) {
                if let Some(axes) = self.requests.axes.get(&number) {
                    line.values = axes.map(|axis| dot(axis, vector(number))).to_vec();
                    line.is_local = true;
                }
            }
        }
        Ok(tables)
    }

    fn of_elements(&self, table: &RequestedTable) -> Result<Vec<Table>, Error> {
        let values = self.answer.volume_and_energy()?;
        let which = usize::from(table.label == "ELSE");
        let found = placed(&table.numbers, &self.elements);
        let lines = found.into_iter().map(|(number, element)| (number, [self.share() * values[element][which]]));
        with_sum(table, lines.collect())
    }

    fn of_points(&self, table: &RequestedTable) -> Result<Table, Error> {
        let found = placed(&table.numbers, &self.elements);
        let elements: Vec<usize> = found.iter().map(|&(_, element)| element).collect();
        let which = usize::from(table.label == "S");
        let mut lines = Vec::new();
        for ((number, _), at_points) in found.iter().zip(self.answer.strain_and_stress(&elements)?) {
            for (point, values) in at_points.iter().enumerate() {
                let [xx, yy, zz, xy, yz, zx] = values[which];
                lines.push((format!("{number:>10} {:>3}", point + 1), [xx, yy, zz, xy, zx, yz]));
            }
        }
        Table::new(format!("{} for set {} and time ", titles(table)[0], table.set), lines)
    }

    /// The opening or the pressure of each contact row at its node, by increasing number.
    fn of_contacts(&self, table: &RequestedTable) -> Result<Table, Error> {
        let of_row = |(row, gap, pressure): (&ContactRow, f64, f64)| {
            (self.numbers[row.node], if table.label == "CDIS" { gap } else { pressure })
        };
        let mut rows: Vec<(usize, f64)> = self.contacts().map(of_row).collect();
        rows.sort_by_key(|&(number, _)| number);
        let lines = rows.into_iter().map(|(number, value)| (format!("{number:>10}"), [value, 0.0, 0.0]));
        Table::new(format!("{} for all contact elements and time", titles(table)[0]), lines.collect())
    }

    /// The force of the contacts of two surfaces on the slave, its moments, and the closed area.
    fn statistics(&self, table: &RequestedTable) -> Result<Option<Table>, Error> {
        let Some([slave, master]) = &table.contact else { return Ok(None) };
        let (model, displacements, share) = (self.answer.model(), self.displacements(), self.share());
        let (mut force, mut moment, mut area, mut along) = ([0.0; 3], [0.0; 3], 0.0, 0.0);
        let (mut centre, mut normal) = ([0.0; 3], [0.0; 3]);
        for row in self.answer.contact_set() {
            let (row, size) = (&model.rows()[row], share * self.answer.multiplier()[row]);
            let obstacle = &model.obstacles()[row.obstacle];
            // The rows stand on the finer surface, which may be the master: the force on the slave is then the opposite
            // one.
            let Some((other, _)) = obstacle.other_body() else { continue };
            let is_between = |one: &str, two: &str| is_named(obstacle.boundary(), one) && is_named(other, two);
            let sense = match () {
                () if is_between(slave, master) => 1.0,
                () if is_between(master, slave) => -1.0,
                () => continue,
            };
            let own = share * row.tributary_area;
            let at = [0, 1, 2].map(|axis| model.mesh().nodes()[row.node][axis] + displacements[row.node][axis]);
            let acting = row.normal.map(|part| sense * size * part);
            add(&mut force, acting, 1.0);
            add(&mut moment, cross(at, acting), 1.0);
            add(&mut centre, at, own);
            add(&mut normal, row.outward, sense * own);
            (area, along) = (area + own, along + size);
        }
        let mean = |sum: [f64; 3]| sum.map(|part| if area > 0.0 { part / area } else { 0.0 });
        let lever = cross(mean(centre), force);
        let about_centre = [0, 1, 2].map(|axis| moment[axis] - lever[axis]);
        let names = format!("slave set {}, master set {}", slave.to_uppercase(), master.to_uppercase());
        let title = format!("statistics for {names} and time ");
        let lines = [
            ("   total surface force (fx,fy,fz) and moment about the origin (mx,my,mz)", [force, moment].concat()),
            ("\n   center of gravity and mean normal", [mean(centre), mean(normal)].concat()),
            ("\n   moment about the center of gravity(mx,my,mz)", about_centre.to_vec()),
            ("\n   area,  normal force (+ = tension) and shear force (size)", vec![area, along, 0.0]),
        ];
        let lines = lines.into_iter().map(|(words, values)| Line::new(&title, format!("{words}\n\n  "), values));
        Ok(Some(Table { lines: lines.collect::<Result<_, Error>>()?, title }))
    }
}

/// The titles of a table and of its sum.
fn titles(table: &RequestedTable) -> [&'static str; 2] {
    let found = TABLES.iter().find(|(label, ..)| *label == table.label);
    found.map_or([""; 2], |&(_, title, sum)| [title, sum])
}

/// The values of nodes or elements, given with their numbers, and their sum, as the deck asks for them.
fn with_sum<const N: usize>(table: &RequestedTable, values: Vec<(usize, [f64; N])>) -> Result<Vec<Table>, Error> {
    let [title, of_sum] = titles(table).map(|title| format!("{title} for set {} and time ", table.set));
    let mut sum = [0.0; N];
    values.iter().for_each(|(_, own)| sum.iter_mut().zip(own).for_each(|(sum, value)| *sum += value));
    let mut tables = Vec::new();
    if table.parts {
        let lines = values.into_iter().map(|(number, values)| (format!("{number:>10}"), values));
        tables.push(Table::new(title, lines.collect())?);
    }
    if table.totals && !titles(table)[1].is_empty() {
        tables.push(Table::new(of_sum, vec![("      ".into(), sum)])?);
    }
    Ok(tables)
}

fn increasing(numbers: &[usize]) -> Vec<usize> {
    let mut numbers = numbers.to_vec();
    numbers.sort_unstable();
    numbers
}

/// The displacement or the force of a reference node, without its rotation or moment.
fn first([x, y, z, ..]: [f64; 6]) -> [f64; 3] {
    [x, y, z]
}

/// Those of the numbers that are in the mesh, increasing, each with its place there.
fn placed(numbers: &[usize], all: &[(usize, usize)]) -> Vec<(usize, usize)> {
    let place = |number: &usize| all.binary_search_by_key(number, |own| own.0).ok().map(|found| all[found]);
    let mut found: Vec<(usize, usize)> = numbers.iter().filter_map(place).collect();
    found.sort_unstable();
    found
}

/// Returns `true` for a boundary of the scene that is a surface of the deck: that of a further body begins with the
/// name of the body.
fn is_named(boundary: &str, surface: &str) -> bool {
    let own =
        boundary.len().checked_sub(surface.len()).and_then(|start| Some((boundary.get(..start)?, &boundary[start..])));
    own.is_some_and(|(body, own)| own.eq_ignore_ascii_case(surface) && (body.is_empty() || body.ends_with('.')))
}

fn add(sum: &mut [f64; 3], vector: [f64; 3], factor: f64) {
    sum.iter_mut().zip(vector).for_each(|(sum, part)| *sum += factor * part);
}

fn cross([a, b, c]: [f64; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
    [b * z - c * y, c * x - a * z, a * y - b * x]
}

fn dot(one: [f64; 3], other: [f64; 3]) -> f64 {
    one.iter().zip(other).map(|(a, b)| a * b).sum()
}
