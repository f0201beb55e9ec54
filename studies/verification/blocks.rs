//! Blocks with a known displacement at every point: errors in norms, convergence rates, and plots over the cell size.

use signorini::Error;
use signorini::fem::{ElementKind, Integration};
use signorini::output::{Drawing, Plot, Quantity, Scale, Series, line_plots};
use support::closed_forms::manufactured::{ContactSolution, GenericEdge, HertzBlock, PlaneElasticity, Smooth};
use support::manufactured::solve_block;
use support::norms::ErrorNorms;

use support::verification::answer::Answer;
use support::verification::reference_errors::{REFERENCE, reference_rule};

/// Errors of one element on one block, from the coarsest mesh to the finest.
pub struct Family {
    pub block: &'static str,
    pub kind: ElementKind,
    pub steps: Vec<Step>,
}

/// One mesh of a family.
pub struct Step {
    /// Number of cells along a side.
    cells: usize,
    unknowns: usize,
    errors: ErrorNorms,
    /// The errors by the quadrature of the reference.
    as_reference: ErrorNorms,
    /// Our value and the exact value.
    peak_pressure: [f64; 2],
    seconds: f64,
}

pub const BLOCKS: [&str; 3] = ["smooth", "generic edge", "Hertz"];

/// Solves every block by every element, with these numbers of cells along a side.
pub fn families(cells: &[usize]) -> Result<Vec<Family>, Error> {
    let elasticity = PlaneElasticity::plane_strain(1.0, 0.3);
    let smooth = Smooth { elasticity, opening: 1.0, pressure: 1.0, edge: 0.5, power: 3 };
    let edge = GenericEdge { elasticity, edge: 0.53, pressure: 1.0 };
    let hertz = HertzBlock { elasticity, half_width: 0.53, peak_pressure: 1.0 };
    let exact: [&dyn ContactSolution; 3] = [&smooth, &edge, &hertz];
    let mut families = Vec::new();
    for (block, exact) in BLOCKS.into_iter().zip(exact) {
        for kind in [ElementKind::T3, ElementKind::Q4, ElementKind::T6, ElementKind::Q8] {
            let step = |cells: usize| {
                let solved = solve_block(exact, kind, Integration::Standard, cells)?;
                Ok(Step {
                    cells,
                    unknowns: solved.unknowns,
                    errors: solved.errors(),
                    as_reference: solved.errors_by(&reference_rule(kind)),
                    peak_pressure: solved.peak_pressure(),
                    seconds: solved.seconds,
                })
            };
            let steps = cells.iter().copied().map(step).collect::<Result<_, Error>>()?;
            families.push(Family { block, kind, steps });
        }
    }
    Ok(families)
}

pub const ERRORS: &str = "block | element | cells | unknowns | energy error | rate | L2 error | rate | peak pressure, ours | exact | seconds";

pub fn error_rows(families: &[Family]) -> Vec<String> {
    let mut rows = Vec::new();
    for Family { block, kind, steps } in families {
        for (index, step) in steps.iter().enumerate() {
            let rate = |value: fn(&Step) -> f64| match index {
                0 => String::new(),
                _ => format!("{:.2}", (value(&steps[index - 1]) / value(step)).log2()),
            };
            let Step { cells, unknowns, errors: ErrorNorms { energy, l2 }, peak_pressure: [ours, exact], .. } = step;
            let [energy_rate, l2_rate] = [rate(|step| step.errors.energy), rate(|step| step.errors.l2)];
            let (name, seconds) = (kind.name(), step.seconds);
            rows.push(format!(
                "{block} | {name} | {cells} | {unknowns} | {energy:.3e} | {energy_rate} | {l2:.3e} | {l2_rate} | \
                 {ours:.5} | {exact:.5} | {seconds:.3}"
            ));
        }
    }
    rows
}

pub const AGAINST_REFERENCE: &str =
    "block | cells | element | energy error by its quadrature | reference | L2 error by its quadrature | reference";

pub fn reference_rows(families: &[Family]) -> Vec<String> {
    let mut rows = Vec::new();
    for reference in &REFERENCE {
        let family = families.iter().find(|family| family.block == reference.block && family.kind == reference.kind);
        for step in family.iter().flat_map(|family| &family.steps).filter(|step| step.cells == reference.cells) {
            let (block, cells, element) = (reference.block, reference.cells, reference.kind.name());
            let ErrorNorms { energy, l2 } = step.as_reference;
            let (its_energy, its_l2) = (reference.energy, reference.l2);
            rows.push(format!(
                "{block} | {cells} | {element} | {energy:.3e} | {its_energy:.3e} | {l2:.3e} | {its_l2:.2e}"
            ));
        }
    }
    rows
}

/// Draws the errors in energy and L2 over the cell size, with the slopes that theory predicts.
pub fn error_plots(block: &str, families: &[Family]) -> Drawing {
    let smooth = block == BLOCKS[0];
    let panel = |title: &str, value: fn(&Step) -> f64, slopes: &[f64]| {
        let mut series: Vec<Series> = Vec::new();
        let mut ends: Vec<[f64; 2]> = Vec::new();
        for family in families.iter().filter(|family| family.block == block) {
            let points: Vec<_> = family.steps.iter().map(|step| [1.0 / step.cells as f64, value(step)]).collect();
            ends.extend(points.first());
            series.push(Series::new(family.kind.name(), points));
        }
        for (index, slope) in slopes.iter().enumerate() {
            // The line of the expected slope is drawn slightly below that of Q4 or Q8.
            let [h, error] = ends[2 * index + 1];
            let at = |n: f64| [1.0 / n, 0.6 * error * (1.0 / n / h).powf(*slope)];
            series.push(Series::new(format!("expected slope {slope}"), vec![at(8.0), at(128.0)]));
        }
        let plot = Plot::new(Quantity::new("cell size h", ""), Quantity::new("relative error", ""), series);
        Plot { title: title.into(), scales: [Scale::Logarithmic; 2], ..plot }
    };
    let panels = [
        panel("energy norm", |step| step.errors.energy, &[1.0, if smooth { 2.0 } else { 1.5 }]),
        panel("L2 norm", |step| step.errors.l2, if smooth { &[2.0, 3.0] } else { &[2.0] }),
    ];
    line_plots(&format!("Manufactured block: {block}"), &panels)
}

/// The peak pressure of the Hertz block at nu = 0.4999, with mean dilatation and with the standard element, which
/// locks.
pub fn near_incompressibility() -> Result<Vec<Answer>, Error> {
    let elasticity = PlaneElasticity::plane_strain(1.0, 0.4999);
    let hertz = HertzBlock { elasticity, half_width: 0.53, peak_pressure: 1.0 };
    let mut answers = Vec::new();
    for (integration, name) in
        [(Integration::MeanDilatation, "mean dilatation"), (Integration::Standard, "standard, locks")]
    {
        for cells in [16, 32, 64] {
            let solved = solve_block(&hertz, ElementKind::Q4, integration, cells)?;
            answers.push(Answer {
                case: format!("Hertz block, nu = 0.4999, {name}"),
                element: ElementKind::Q4.name(),
                unknowns: solved.unknowns,
                quantity: "largest pressure".into(),
                ours: solved.peak_pressure()[0],
                exact: 1.0,
                seconds: solved.seconds,
            });
        }
    }
    Ok(answers)
}
