//! One row of the table of answers.

use std::time::Instant;

use serde_json::Value;
use signorini::{Error, Model, Scene, Solution, solve_qp};

/// A number that the program computed, and its exact value.
#[derive(Clone)]
pub struct Answer {
    pub case: String,
    pub element: &'static str,
    pub unknowns: usize,
    pub quantity: String,
    pub ours: f64,
    pub exact: f64,
    pub seconds: f64,
}

impl Answer {
    pub const HEADING: &str = "case | element | unknowns | quantity | ours | exact | relative error | seconds";

    /// Returns the cells of its row. If the exact value is zero, the error is the absolute value of our number.
    pub fn row(&self) -> String {
        let Answer { case, element, unknowns, quantity, ours, exact, seconds } = self;
        let value = |value: &f64| if *value == 0.0 { "0".into() } else { format!("{value:.6e}") };
        let error = (ours - exact).abs() / if *exact == 0.0 { 1.0 } else { exact.abs() };
        let (ours, exact) = (value(ours), value(exact));
        format!("{case} | {element} | {unknowns} | {quantity} | {ours} | {exact} | {error:.1e} | {seconds:.3}")
    }
}

/// A scene with its solution.
pub struct Solved {
    pub model: Model,
    pub solution: Solution,
    pub pressure: Vec<f64>,
    /// Seconds of assembly and solve.
    pub seconds: f64,
}

impl Solved {
    pub fn of(scene: &Value) -> Result<Self, Error> {
        let clock = Instant::now();
        let model = Scene::from_json(&scene.to_string(), "verification")?.build()?;
        let solution = solve_qp(model.problem())?;
        let seconds = clock.elapsed().as_secs_f64();
        let pressure = model.pressure(&solution.multiplier)?;
        Ok(Solved { model, solution, pressure, seconds })
    }

    pub fn force(&self) -> f64 {
        self.solution.contact_force()
    }

    pub fn peak_pressure(&self) -> f64 {
        self.pressure.iter().copied().fold(0.0, f64::max)
    }

    /// Returns the coordinates and the pressure of every contact row.
    pub fn pressures(&self) -> impl Iterator<Item = ([f64; 3], f64)> {
        self.model.rows().iter().map(|row| self.model.mesh().nodes()[row.node]).zip(self.pressure.iter().copied())
    }

    /// Returns the coordinate x and the pressure at the contact node nearest to `x`.
    pub fn pressure_near(&self, x: f64) -> [f64; 2] {
        let away = |at: [f64; 3]| (at[0] - x).abs();
        let near = self.pressures().min_by(|a, b| away(a.0).total_cmp(&away(b.0)));
        near.map_or([f64::NAN; 2], |(at, pressure)| [at[0], pressure])
    }

    /// Returns a row of the table.
    pub fn answer(&self, case: &str, quantity: impl Into<String>, ours: f64, exact: f64) -> Answer {
        Answer {
            case: case.into(),
            element: self.model.mesh().kind_of(0).name(),
            unknowns: self.model.problem().dofs(),
            quantity: quantity.into(),
            ours,
            exact,
            seconds: self.seconds,
        }
    }
}
