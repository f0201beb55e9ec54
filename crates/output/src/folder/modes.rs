//! Natural vibrations as tables and fields.

use super::vtu::{Array, Unstructured};
use crate::reports::modes::AXES;
use crate::reports::report::comma_separated;
use signorini_mechanics::Error;
use signorini_mechanics::scene::ModalAnalysis;

/// The output of modes in a folder.
pub trait ModesShown {
    /// The modes as comma-separated values, a line each below the line of their names.
    fn table(&self) -> String;

    /// The text of a `.vtu` file with the displacement of each mode, its largest displacement one.
    ///
    /// # Errors
    /// None for modes of one mesh.
    fn vtu(&self) -> Result<String, Error>;
}

impl ModesShown for ModalAnalysis {
    fn table(&self) -> String {
        let axes = &AXES[..self.answer.model().body().dimension()];
        let mut names = ["mode", "frequency", "frequency_open", "residual"].map(String::from).to_vec();
        names.extend(axes.iter().map(|axis| format!("participation_{axis}")));
        names.extend(axes.iter().map(|axis| format!("effective_mass_{axis}")));
        names.extend(["opens_at", "opens_row", "closes_at", "closes_row"].map(String::from));
        let mut rows = vec![names];
        for (number, mode) in self.modes.iter().enumerate() {
            let open = mode.frequency_open.map_or_else(String::new, |value| format!("{value:e}"));
            let mut row =
                vec![(number + 1).to_string(), format!("{:e}", mode.frequency), open, format!("{:e}", mode.residual)];
            row.extend(mode.participation.iter().chain(&mode.effective_mass).map(|value| format!("{value:e}")));
            for limit in [mode.opens, mode.closes] {
                let of_limit = limit.map(|limit| [format!("{:e}", limit.amplitude), limit.row.to_string()]);
                row.extend(of_limit.unwrap_or_default());
            }
            rows.push(row);
        }
        comma_separated(&rows)
    }

    fn vtu(&self) -> Result<String, Error> {
        let mesh = self.answer.model().mesh();
        let dimension = mesh.dimension();
        let elements: Vec<Vec<usize>> = mesh.elements().map(<[usize]>::to_vec).collect();
        let named: Vec<(String, Vec<f64>)> = (self.modes.iter().enumerate())
            .map(|(number, mode)| {
                let scale = 1.0 / mode.largest(dimension);
                let padded = mode.displacement.chunks(dimension).flat_map(|moved| {
                    (0..3).map(|axis| moved.get(axis).map_or(0.0, |value| scale * value)).collect::<Vec<f64>>()
                });
                (format!("mode_{}", number + 1), padded.collect())
            })
            .collect();
        let arrays: Vec<Array> = named.iter().map(|(name, values)| Array::Vectors(name, values)).collect();
        Unstructured {
            nodes: mesh.nodes(),
            cell_types: &(0..elements.len()).map(|element| mesh.kind_of(element)).collect::<Vec<_>>(),
            elements: &elements,
            point_data: &arrays,
            cell_data: &[],
        }
        .to_vtu()
    }
}
