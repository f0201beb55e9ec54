//! What the reports have in common: a text for reading, and for measurements a table and plots.

use super::modes::modes_text;
use super::motion_tradeoff::{motion_tradeoff_csv, motion_tradeoff_plot, motion_tradeoff_text};
use super::report::{compare_text, solve_text, sweep_text, verify_text};
use super::sensitivity::{kink_text, places_csv, sensitivity_text};
use super::tradeoff::{tradeoff_csv, tradeoff_text};
use super::tradeoff_plot::{OF_ROUNDING, total_error_plot, tradeoff_plot};
use crate::draw::drawing::Drawing;
use crate::plots::medium::Medium;
use signorini_mechanics::scene::{ModalAnalysis, Sensitivities, Units};
use signorini_study::{Agreement, MotionTradeoff, Summary, Sweep, Tradeoff, Verification};

/// A result that is reported as a text for reading.
pub trait InWords {
    /// The report under a title, with the units of a scene; those of a problem directory are empty.
    fn text(&self, title: &str, units: &Units) -> String;
}

/// Measurements of many ways to an answer.
pub trait Measured: InWords {
    /// The measurements as comma-separated values, a line each below the line of their names.
    fn csv(&self) -> String;

    /// The names of the pictures, and the pictures, for a medium.
    fn plots(&self, medium: Medium, title: &str) -> Vec<(&'static str, Drawing)>;
}

impl InWords for Summary {
    fn text(&self, title: &str, units: &Units) -> String {
        solve_text(title, self, units)
    }
}

impl InWords for (&[Summary; 3], &Agreement) {
    fn text(&self, title: &str, units: &Units) -> String {
        compare_text(title, self.0, self.1, units)
    }
}

impl InWords for Sensitivities {
    fn text(&self, title: &str, _: &Units) -> String {
        sensitivity_text(title, self)
    }
}

impl InWords for ModalAnalysis {
    fn text(&self, title: &str, units: &Units) -> String {
        modes_text(title, self, units)
    }
}

/// The rows at a kink, or undecided by the proof, in words; empty without any.
pub fn rows_at_kink(found: &Sensitivities) -> String {
    kink_text(found)
}

/// For each output with known derivatives with respect to the places of all nodes their table: the name of its file and
/// its text.
pub fn tables_of_places(found: &Sensitivities) -> Vec<(String, String)> {
    let of_output = |(index, output)| Some((format!("nodes-{index}.csv"), places_csv(found.answer.model(), output)?));
    found.outputs.iter().enumerate().filter_map(of_output).collect()
}

impl InWords for Sweep {
    fn text(&self, title: &str, units: &Units) -> String {
        sweep_text(title, self, units)
    }
}

impl InWords for Verification {
    fn text(&self, title: &str, _: &Units) -> String {
        verify_text(title, self)
    }
}

impl InWords for Tradeoff {
    fn text(&self, title: &str, _: &Units) -> String {
        tradeoff_text(title, self)
    }
}

impl InWords for MotionTradeoff {
    fn text(&self, title: &str, _: &Units) -> String {
        motion_tradeoff_text(title, self)
    }
}

impl Measured for Tradeoff {
    fn csv(&self) -> String {
        tradeoff_csv(self)
    }

    fn plots(&self, medium: Medium, title: &str) -> Vec<(&'static str, Drawing)> {
        let mut plots = vec![("tradeoff", tradeoff_plot(medium, title, self))];
        // A problem directory has no mesh, and so no total error; that of an exact mesh is rounding.
        if self.points.iter().any(|point| point.total_error.is_some_and(|error| error > OF_ROUNDING)) {
            plots.push(("total-error", total_error_plot(medium, title, self)));
        }
        plots
    }
}

impl Measured for MotionTradeoff {
    fn csv(&self) -> String {
        motion_tradeoff_csv(self)
    }

    fn plots(&self, medium: Medium, title: &str) -> Vec<(&'static str, Drawing)> {
        vec![("tradeoff", motion_tradeoff_plot(medium, title, self))]
    }
}
