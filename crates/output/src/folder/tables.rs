//! Tables beside the numbers of an answer: the meaning of each unknown and each row, and the state of the contact.

use std::fmt::Write as _;
use std::io::{self, Write};

use crate::view::along::Along;
use signorini_mechanics::scene::{Answer, Meaning, Model};
use signorini_qp::file::Streamed;

/// `dofs.csv` and `rows.csv`: the meaning of the entries of `u.mtx` and `lambda.mtx`, in their order, from 0.
pub fn of_model(model: &Model) -> [Streamed<'_>; 2] {
    [Streamed::new("dofs.csv", |out| dofs(model, out)), Streamed::new("rows.csv", |out| rows(model, out))]
}

/// A line for each unknown. A rigid face has no node: its rotations are given as the displacement of its farthest node;
/// `unit` times the value is in radians.
fn dofs(model: &Model, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "dof,quantity,of,x,y,z,direction_x,direction_y,direction_z,unit")?;
    for (dof, meaning) in model.meanings().enumerate() {
        let (quantity, of, at, direction, unit) = match meaning {
            Meaning::Node { node, direction, quantity } => {
                (quantity, format!("node {node}"), model.mesh().nodes().get(node), Some(direction), 1.0)
            }
            Meaning::Face { face, motion, unit } => (motion, format!("rigid-faces[{face}]"), None, None, unit),
            Meaning::Travel { obstacle } => {
                let against = model.obstacles()[obstacle].approach().map(|part| 0.0 - part);
                ("travel", format!("obstacles[{obstacle}]"), None, Some(against), 1.0)
            }
        };
        writeln!(out, "{dof},{quantity},{of},{},{},{unit:e}", vector(at.copied()), vector(direction))?;
    }
    Ok(())
}

/// A line for each contact row: `normal . (u - u_partner) <= gap`, or, with all its nodes as `node:share`,
/// `normal . sum(share * u) <= gap`.
fn rows(model: &Model, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "row,obstacle,node,partner,x,y,z,normal_x,normal_y,normal_z,gap,tributary_area")?;
    for (index, row) in model.rows().iter().enumerate() {
        let ends = || row.ends.iter().map(|(node, share)| format!("{node}:{share}")).collect::<Vec<_>>().join(" ");
        let partner = row.partner().map_or_else(ends, |partner| partner.to_string());
        let at = vector(model.mesh().nodes().get(row.node).copied());
        let (normal, gap, area) = (vector(Some(row.normal)), row.gap, row.tributary_area);
        writeln!(out, "{index},{},{},{partner},{at},{normal},{gap:e},{area:e}", row.obstacle, row.node)?;
    }
    Ok(())
}

/// `contact.csv`: force, pressure and remaining gap of each row, with the place of its node in the displaced body.
pub(crate) fn contact(answer: &Answer) -> String {
    let (model, remaining) = (answer.model(), answer.remaining_gaps());
    let dimension = model.mesh().dimension();
    let mut text = String::from("row,obstacle,node,x,y,z,closed,force,pressure,remaining_gap\n");
    for (index, row) in model.rows().iter().enumerate() {
        let mut at = model.mesh().nodes()[row.node];
        (0..dimension).for_each(|axis| at[axis] += answer.displacement()[dimension * row.node + axis]);
        let (force, pressure) = (0.0 - answer.multiplier()[index], 0.0 + answer.pressure()[index]);
        let closed = u8::from(answer.contact_set().contains(index));
        let (place, left) = (vector(Some(at)), remaining[index]);
        let _ =
            writeln!(text, "{index},{},{},{place},{closed},{force:e},{pressure:e},{left:e}", row.obstacle, row.node);
    }
    text
}

/// Three cells; empty ones if there is no vector.
fn vector(vector: Option<[f64; 3]>) -> String {
    vector.map_or_else(|| ",,".to_string(), |[x, y, z]| format!("{x:e},{y:e},{z:e}"))
}

impl Along {
    /// `along.csv`: an answer along lines, piece by piece. A row with the number of the line alone stands before
    /// the next body, and where the line leaves a body and enters it again.
    pub fn table(lines: &[Along]) -> String {
        let columns = lines.first().map_or(&[][..], |line| &line.columns);
        let mut text = String::from("line,body,element");
        for column in columns {
            let _ = write!(text, ",{}", column.in_brackets());
        }
        text.push('\n');
        for (number, line) in lines.iter().enumerate() {
            for (index, piece) in line.pieces.iter().enumerate() {
                if index > 0 && piece.is_apart {
                    let _ = writeln!(text, "{number},,{}", ",".repeat(columns.len()));
                }
                for point in &piece.points {
                    let _ = write!(text, "{number},{},{}", piece.body, piece.element);
                    for &value in point {
                        let _ = if value.is_nan() { write!(text, ",") } else { write!(text, ",{:e}", 0.0 + value) };
                    }
                    text.push('\n');
                }
            }
        }
        text
    }
}
