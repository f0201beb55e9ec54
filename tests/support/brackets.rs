//! The properties that the brackets of a guaranteed bound must have on the meshes of a scene.

use serde_json::{Value, json};
use signorini::study::Examined;
use signorini::{Error, Scene};

/// Energies and forces are compared up to this share of the largest: stresses near incompressibility are rounded by
/// this much.
const ROUNDING: f64 = 1e-8;

/// The distance between v and the answer by finite elements on the same mesh, over the bound, is below this.
const OF_ELEMENTS: f64 = 1.5;

/// A scene with the name of its element, and the exact energy and force of its answer.
pub type Column = (Scene, &'static str, [f64; 2]);

/// Random numbers between 0 and 1 from a seed.
pub struct Draws(u64);

impl Draws {
    /// The numbers of a seed.
    pub fn new(seed: u64) -> Self {
        let mut draws = Draws(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
        (0..8).for_each(|_| {
            draws.next();
        });
        draws
    }

    /// The next number.
    #[allow(clippy::should_implement_trait)]
    pub fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A number between two.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    /// One of some.
    pub fn of<'a, T>(&mut self, all: &'a [T]) -> &'a T {
        &all[((self.next() * all.len() as f64) as usize).min(all.len() - 1)]
    }

    /// Lines from 0 to `length` with two or three cells of uneven widths.
    pub fn few_lines(&mut self, length: f64) -> Value {
        let inner = length * self.between(0.3, 0.7);
        json!({"points": [0.0, inner, length], "divisions": [1, 1 + (self.next() * 2.0) as usize]})
    }

    /// Lines from 0 to `length` with cells of uneven widths.
    pub fn lines(&mut self, length: f64) -> Value {
        let inner = length * self.between(0.25, 0.75);
        let divisions: Vec<usize> = (0..2).map(|_| 1 + (self.next() * 3.0) as usize).collect();
        json!({"points": [0.0, inner, length], "divisions": divisions})
    }
}

/// The exact energy and force of a column of this height under a body force, whose head meets a plane after `gap`, with
/// the modulus of a column that cannot bulge.
///
/// The pressure q at the head is such that the head moves by `b h^2/2M - q h/M`, which equals the gap; the stress at y
/// is `b (h - y) - q`.
pub fn of_pressed_column([height, gap, force]: [f64; 3], modulus: f64, area: f64) -> [f64; 2] {
    let pressure = force * height / 2.0 - modulus * gap / height;
    let stored = (force * force * height.powi(3) / 3.0 - pressure * force * height * height
        + pressure * pressure * height)
        / (2.0 * modulus);
    let work = force * (force * height.powi(3) / 3.0 - pressure * height * height / 2.0) / modulus;
    [area * (stored - work), area * pressure]
}

/// Compares the brackets of a column with the exact energy and force, whose energies differ by `width` times the square
/// of the energy norm. Returns the violations of the guarantee.
///
/// # Errors
/// Those of the total error.
pub fn of_column((scene, element, [energy, force]): Column, levels: usize, width: f64) -> Result<Vec<String>, Error> {
    let mut violations = Vec::new();
    for (number, one) in Examined::of(&scene, levels)?.iter().enumerate() {
        // Both sides contain the quadratic displacement: only rounding of their energies is left, and its root in the
        // distance.
        let size = ROUNDING * one.norm.powi(2).max(energy.abs());
        let [low, high] = one.energies;
        let [least, most] = one.force_interval.unwrap_or([f64::NAN; 2]);
        let slack = ROUNDING.sqrt() * force;
        let is_held = low <= energy + size && energy <= high + size && high - low <= size + width * one.norm.powi(2);
        if !(is_held && least <= force + slack && force <= most + slack && most - least <= 2.0 * slack) {
            violations.push(format!("column, {element}, mesh {number}: {energy} and {force}: {one:?}"));
        }
    }
    Ok(violations)
}

/// Findings about the brackets of one scene.
#[derive(Clone, Debug)]
pub struct Shown {
    pub element: &'static str,
    /// Violations of the guarantee, in words.
    pub violations: Vec<String>,
    /// Bound divided by true error of v, on the meshes whose error is many times that of the last mesh.
    pub of_displacement: Vec<f64>,
    /// Bound divided by true error on the scene's original mesh, judged by the last bracket.
    pub of_own: Option<f64>,
    /// Half the width of the interval of the force divided by the bound, both relative.
    pub of_force: Vec<f64>,
}

/// Compares the brackets on the mesh of a scene and on `levels` finer ones with each other. Ratios of bound and error
/// are those of meshes whose bound is `clear` times that of the last mesh, or more.
///
/// # Errors
/// Those of the total error.
pub fn shown((scene, element): (Scene, &'static str), levels: usize, clear: f64) -> Result<Shown, Error> {
    let found = Examined::of(&scene, levels)?;
    let last = found.last().unwrap();
    let size = found.iter().flat_map(|one| one.energies).fold(0.0, |size: f64, energy| size.max(energy.abs()));
    let mut violations = Vec::new();
    for (number, one) in found.iter().enumerate() {
        let mut hold = |what: &str, is_held: bool| {
            if !is_held {
                violations.push(format!("{element}, mesh {number}: {what}: {one:?}, {last:?}"));
            }
        };
        // The exact energy is between the energies of every mesh; so all intervals overlap.
        hold(
            "the energies do not overlap those of the last mesh",
            one.energies[0] <= last.energies[1] + ROUNDING * size,
        );
        hold(
            "the energies do not overlap those of the last mesh",
            last.energies[0] <= one.energies[1] + ROUNDING * size,
        );
        let least = one.own[1].max(last.own[1] - last.bound);
        // |u - w| is at least |w - v| - |u - v|, with v of the last mesh.
        hold(
            "the original mesh has a larger error than its bound",
            one.own[0] + ROUNDING * one.norm >= last.own[1] - last.bound,
        );
        hold("the original mesh has no bound", one.own[0].is_finite() && least.is_finite());
        if let (Some(one), Some(last)) = (one.force_interval, last.force_interval) {
            let size = ROUNDING * last[1].abs();
            hold(
                "the forces do not overlap those of the last mesh",
                one[0] <= last[1] + size && last[0] <= one[1] + size,
            );
            hold("the interval is empty", one[0] <= one[1] + size);
        }
    }
    // Finite elements on the same mesh err as much, unless they solve another problem.
    let from_elements = last.from_elements.unwrap_or(f64::NAN);
    if from_elements.is_nan() || from_elements > OF_ELEMENTS * last.bound + ROUNDING * last.norm {
        violations.push(format!("{element}: finite elements are {from_elements} away from v: {last:?}"));
    }
    let (of_displacement, of_own, of_force) = effectivities(&found, clear);
    Ok(Shown { element, violations, of_displacement, of_own, of_force })
}

/// Bounds divided by errors.
fn effectivities(found: &[Examined], clear: f64) -> (Vec<f64>, Option<f64>, Vec<f64>) {
    let last = found.last().unwrap();
    let exact = (last.energies[0] + last.energies[1]) / 2.0;
    let is_clear = |one: &&Examined| one.bound > clear * last.bound;
    let of_displacement =
        found.iter().filter(is_clear).map(|one| one.bound / (2.0 * (one.energies[1] - exact)).sqrt()).collect();
    let of_own = (last.own[1] > clear * last.bound).then(|| last.own[0] / last.own[1]);
    let of_force = found.iter().filter_map(|one| {
        let [low, high] = one.force_interval?;
        Some((high - low) / 2.0 / one.force / (one.bound / one.norm))
    });
    (of_displacement, of_own, of_force.filter(|ratio| ratio.is_finite()).collect())
}
