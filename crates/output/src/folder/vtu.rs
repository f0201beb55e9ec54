//! `.vtu` files (ASCII XML, unstructured grid) for ParaView.

use std::fmt::Write;

use crate::text::escape;
use signorini_mechanics::Error;
use signorini_mechanics::fem::ElementKind;
use signorini_qp as qp;

/// Named values in any unit, one entry per point or per cell, in the order of the mesh.
#[derive(Clone, Copy, Debug)]
pub enum Array<'a> {
    /// One number per entry, in any unit, after the name.
    Scalars(&'a str, &'a [f64]),
    /// Three components per entry, order `[x0, y0, z0, x1, ...]`, in any unit, after the name.
    Vectors(&'a str, &'a [f64]),
    /// A symmetric tensor per entry, in any unit: six components in the order xx, yy, zz, xy, yz, xz, after the name.
    Tensors(&'a str, &'a [f64]),
    /// A flag per entry, written as 0 or 1, after the name.
    Flags(&'a str, &'a [bool]),
}

/// A mesh with its data, as plain arrays, to be written as a `.vtu` file for ParaView.
#[derive(Clone, Copy, Debug)]
pub struct Unstructured<'a> {
    /// Coordinates [x, y, z] of each node, in length; zero beyond the dimension.
    pub nodes: &'a [[f64; 3]],
    /// The nodes of every cell in the order of its type, indices from 0.
    pub elements: &'a [Vec<usize>],
    /// The kind of each cell; one entry for each of `elements`, in their order.
    pub cell_types: &'a [ElementKind],
    /// Values at the nodes: named arrays with one entry per node each.
    pub point_data: &'a [Array<'a>],
    /// Values in the elements: named arrays with one entry per element each.
    pub cell_data: &'a [Array<'a>],
}

impl Unstructured<'_> {
    /// The text of the `.vtu` file; every number reads back as the same number.
    ///
    /// # Errors
    /// [`qp::LinearError::Length`] if an array does not fit the nodes or the elements, [`qp::LinearError::NotFinite`]
    /// for a coordinate or value that ASCII readers would stop at, [`qp::LinearError::Setting`] for an element with a
    /// number of nodes that is not that of its type, or that names a node that does not exist.
    pub fn to_vtu(&self) -> Result<String, Error> {
        let mut text = String::from(
            "<?xml version=\"1.0\"?>\n\
             <VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n",
        );
        let (points, cells) = (self.nodes.len(), self.elements.len());
        let _ = writeln!(text, "<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">");
        text.push_str("<Points>\n");
        let coordinates: Vec<f64> = self.nodes.iter().flatten().copied().collect();
        tuples(&mut text, "Points", 3, &coordinates)?;
        text.push_str("</Points>\n");
        self.write_cells(&mut text)?;
        write_data(&mut text, "PointData", self.point_data, points, "nodes")?;
        write_data(&mut text, "CellData", self.cell_data, cells, "elements")?;
        text.push_str("</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
        Ok(text)
    }

    fn write_cells(&self, text: &mut String) -> Result<(), Error> {
        let (mut connectivity, mut offsets, mut types) = (String::new(), String::new(), String::new());
        let mut end = 0;
        if self.cell_types.len() != self.elements.len() {
            let (found, expected) = (self.cell_types.len(), self.elements.len());
            return Err(qp::LinearError::Length {
                name: "the cell types of a .vtu file",
                found,
                expected,
                of: "elements",
            }
            .into());
        }
        for (element, cell_type) in self.elements.iter().zip(self.cell_types) {
            let (kind, nodes) = (cell_type.reference().vtk, cell_type.nodes());
            if element.len() != nodes {
                let name = "number of nodes of an element in a .vtu file";
                let value = element.len() as f64;
                return Err(qp::LinearError::Setting { name, value, allowed: "that of its cell type" }.into());
            }
            if let Some(&node) = element.iter().find(|&&node| node >= self.nodes.len()) {
                let allowed = "smaller than the number of nodes (indices from 0)";
                return Err(qp::LinearError::Setting {
                    name: "node index in a .vtu file",
                    value: node as f64,
                    allowed,
                }
                .into());
            }
            end += element.len();
            for (place, node) in element.iter().enumerate() {
                let _ = write!(connectivity, "{}{node}", if place == 0 { "" } else { " " });
            }
            connectivity.push('\n');
            let _ = writeln!(offsets, "{end}");
            let _ = writeln!(types, "{kind}");
        }
        text.push_str("<Cells>\n");
        for (kind, name, data) in
            [("Int64", "connectivity", connectivity), ("Int64", "offsets", offsets), ("UInt8", "types", types)]
        {
            let _ = write!(text, "<DataArray type=\"{kind}\" Name=\"{name}\" format=\"ascii\">\n{data}</DataArray>\n");
        }
        text.push_str("</Cells>\n");
        Ok(())
    }
}

fn write_data(text: &mut String, tag: &str, arrays: &[Array], expected: usize, of: &'static str) -> Result<(), Error> {
    let _ = writeln!(text, "<{tag}>");
    for array in arrays {
        let (found, components) = match array {
            Array::Scalars(_, values) => (values.len(), 1),
            Array::Vectors(_, values) => (values.len(), 3),
            Array::Tensors(_, values) => (values.len(), 6),
            Array::Flags(_, values) => (values.len(), 1),
        };
        let expected = components * expected;
        if found != expected {
            return Err(qp::LinearError::Length { name: "an array of a .vtu file", found, expected, of }.into());
        }
        match array {
            Array::Scalars(name, values) | Array::Vectors(name, values) | Array::Tensors(name, values) => {
                tuples(text, name, components, values)?;
            }
            Array::Flags(name, values) => {
                begin_array(text, "UInt8", name, 1);
                values.iter().for_each(|&flag| text.push_str(if flag { "1\n" } else { "0\n" }));
                text.push_str("</DataArray>\n");
            }
        }
    }
    let _ = writeln!(text, "</{tag}>");
    Ok(())
}

/// Entries of `components` numbers each; every number is the shortest text that reads back as the same.
fn tuples(text: &mut String, name: &str, components: usize, values: &[f64]) -> Result<(), Error> {
    begin_array(text, "Float64", name, components);
    for (entry, tuple) in values.chunks_exact(components).enumerate() {
        for (component, value) in tuple.iter().enumerate() {
            if !value.is_finite() {
                let at = format!("entry {entry} of `{name}`");
                return Err(qp::LinearError::NotFinite {
                    name: "an array of a .vtu file",
                    at,
                    value: *value,
                    allowed: "finite",
                }
                .into());
            }
            let separator = if component == 0 { "" } else { " " };
            let _ = write!(text, "{separator}{value:e}");
        }
        text.push('\n');
    }
    text.push_str("</DataArray>\n");
    Ok(())
}

fn begin_array(text: &mut String, kind: &str, name: &str, components: usize) {
    let name = escape(name);
    let components = if components > 1 { format!(" NumberOfComponents=\"{components}\"") } else { String::new() };
    let _ = writeln!(text, "<DataArray type=\"{kind}\" Name=\"{name}\"{components} format=\"ascii\">");
}
