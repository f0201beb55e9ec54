//! Random scenes in the plane that have a guaranteed bound, and the properties that the brackets on their meshes must
//! have.

use serde_json::{Value, json};
use signorini::study::Examined;
use signorini::{Error, Scene};

/// Elements of the scene's own mesh.
pub const ELEMENTS: [&str; 4] = ["t3", "t6", "q4", "q8"];

/// Energies and forces are compared up to this share of the largest: stresses near incompressibility are rounded by
/// this much.
const ROUNDING: f64 = 1e-8;

/// Random numbers between 0 and 1 from a seed.
struct Draws(u64);

impl Draws {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    fn of<'a, T>(&mut self, all: &'a [T]) -> &'a T {
        &all[((self.next() * all.len() as f64) as usize).min(all.len() - 1)]
    }

    /// Lines from 0 to `length` with cells of uneven widths.
    fn lines(&mut self, length: f64) -> Value {
        let inner = length * self.between(0.25, 0.75);
        let divisions: Vec<usize> = (0..2).map(|_| 1 + (self.next() * 3.0) as usize).collect();
        json!({"points": [0.0, inner, length], "divisions": divisions})
    }
}

/// A block under a rigid obstacle, and the name of its element.
pub fn scene(seed: u64) -> (Scene, &'static str) {
    let mut draws = Draws(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
    (0..8).for_each(|_| {
        draws.next();
    });
    let (width, height) = (draws.between(0.5, 2.0), draws.between(0.3, 1.2));
    let young = 10_f64.powf(draws.between(3.0, 11.0));
    let element = *draws.of(&ELEMENTS);
    let depth = height * 10_f64.powf(draws.between(-3.5, -1.0));
    let apex = [width * draws.between(0.1, 0.9), height - depth];
    let shape = match (draws.next() * 5.0) as usize {
        0 => json!({"plane": {"point": apex, "normal": [draws.between(-0.2, 0.2), 1.0]}}),
        1 => json!({"wedge": {"apex": apex, "slope": draws.between(0.02, 0.5)}}),
        2 => json!({"circle": {"apex": apex, "radius": draws.between(0.3, 3.0)}}),
        3 => json!({"table": {"points": [
            [-1.0, height + 0.5], [apex[0] - 0.1 * width, apex[1]], [apex[0] + 0.1 * width, apex[1]], [4.0, height + 0.5]
        ]}}),
        _ => json!({"parabola": {"apex": apex, "radius": draws.between(0.3, 3.0)}}),
    };
    let mut obstacles = vec![json!({"boundary": "top", "approach": "+y", "shape": shape})];
    let mut loads = Vec::new();
    let size = young * depth / height;
    if draws.next() < 0.4 {
        let push = size * draws.between(-0.3, 0.3);
        loads.push(json!({"traction": {"boundary": "left", "value": [push, size * draws.between(-0.2, 0.2)]}}));
    }
    if draws.next() < 0.4 {
        let force = size / height;
        loads.push(json!({"body-force": [force * draws.between(-0.3, 0.3), force * draws.between(-0.3, 0.6)]}));
    }
    let supports = match (draws.next() * 3.0) as usize {
        0 => vec![json!({"on": {"boundary": "bottom"}, "x": 0, "y": 0})],
        1 => vec![json!({"on": {"boundary": "bottom"}, "y": 0}), json!({"on": {"boundary": "left"}, "x": 0})],
        _ => vec![json!({"on": {"boundary": "bottom"}, "x": 0, "y": depth * draws.between(-0.5, 0.5)})],
    };
    if draws.next() < 0.3 {
        loads.push(json!({"pressure": {"boundary": "right", "value": size * draws.between(-0.2, 0.2)}}));
    } else if draws.next() < 0.2 {
        let point = [width + depth * draws.between(0.0, 0.5), 0.0];
        obstacles.push(
            json!({"boundary": "right", "approach": "+x", "shape": {"plane": {"point": point, "normal": [1, 0]}}}),
        );
    }
    let scene = json!({
        "model": draws.of(&["plane-strain", "plane-stress"]),
        "thickness": draws.between(0.1, 2.0),
        "body": {"rectangle": {"x": draws.lines(width), "y": draws.lines(height), "element": element}},
        "material": {"young": young, "poisson": draws.of(&[0.0, 0.2, 0.3, 0.45, 0.49, 0.499, 0.4999, 0.49999])},
        "supports": supports,
        "loads": loads,
        "obstacles": obstacles,
    });
    (Scene::from_json(&scene.to_string(), "scene").unwrap(), element)
}

/// A column between rollers under a body force b, up or down, its head against a plane: its displacement is quadratic.
///
/// With the modulus M of a column that cannot bulge, the pressure q at the head, the height h and the gap g, the head
/// moves by `b h^2/2M - q h/M`, which equals g if the head touches; the stress at y is `b (h - y) - q`. This gives
/// energy and force of the exact answer.
pub fn column(seed: u64) -> (Scene, &'static str, [f64; 2]) {
    let mut draws = Draws(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
    (0..8).for_each(|_| {
        draws.next();
    });
    let (width, height, thickness) = (draws.between(0.5, 2.0), draws.between(0.3, 1.2), draws.between(0.1, 2.0));
    let (young, poisson) = (10_f64.powf(draws.between(3.0, 11.0)), *draws.of(&[0.0, 0.2, 0.3, 0.45, 0.49, 0.499]));
    let (model, element) = (*draws.of(&["plane-strain", "plane-stress"]), *draws.of(&ELEMENTS));
    let modulus = match model {
        "plane-strain" => young * (1.0 - poisson) / ((1.0 + poisson) * (1.0 - 2.0 * poisson)),
        _ => young / (1.0 - poisson * poisson),
    };
    let gap = height * 1e-3 * draws.between(-1.0, 1.0);
    // The head hardly touches, or is pressed with up to many times the force, or anything between.
    let force = 2.0 * modulus / (height * height) * (gap + height * 1e-3 * draws.between(0.01, 2.0));
    let scene = json!({
        "model": model,
        "thickness": thickness,
        "body": {"rectangle": {"x": draws.lines(width), "y": draws.lines(height), "element": element}},
        "material": {"young": young, "poisson": poisson},
        "supports": [
            {"on": {"boundary": "bottom"}, "y": 0}, {"on": {"boundary": "left"}, "x": 0}, {"on": {"boundary": "right"}, "x": 0}
        ],
        "loads": [{"body-force": [0, force]}],
        "obstacles": [{"boundary": "top", "approach": "+y", "shape": {"plane": {"point": [0, height + gap], "normal": [0, 1]}}}],
    });
    let pressure = force * height / 2.0 - modulus * gap / height;
    let stored = (force * force * height.powi(3) / 3.0 - pressure * force * height * height
        + pressure * pressure * height)
        / (2.0 * modulus);
    let work = force * (force * height.powi(3) / 3.0 - pressure * height * height / 2.0) / modulus;
    let area = width * thickness;
    let exact = [area * (stored - work), area * pressure];
    (Scene::from_json(&scene.to_string(), "scene").unwrap(), element, exact)
}

/// Compares the brackets of a column with the exact energy and force. Returns the violations of the guarantee.
///
/// # Errors
/// Those of the total error.
pub fn of_column(seed: u64, levels: usize) -> Result<Vec<String>, Error> {
    let (scene, element, [energy, force]) = column(seed);
    let mut violations = Vec::new();
    for (number, one) in Examined::of(&scene, levels)?.iter().enumerate() {
        // Both sides contain the quadratic displacement: only rounding of their energies is left, and its root in the
        // distance.
        let size = ROUNDING * one.norm.powi(2).max(energy.abs());
        let [low, high] = one.energies;
        let [least, most] = one.force_interval.unwrap_or([f64::NAN; 2]);
        let slack = ROUNDING.sqrt() * force;
        let is_held = low <= energy + size && energy <= high + size && high - low <= size;
        if !(is_held && least <= force + slack && force <= most + slack && most - least <= 2.0 * slack) {
            violations.push(format!("column {seed}, {element}, mesh {number}: {energy} and {force}: {one:?}"));
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

/// Compares the brackets on the mesh of a scene and on `levels` finer ones with each other.
///
/// # Errors
/// Those of the total error.
pub fn shown(seed: u64, levels: usize) -> Result<Shown, Error> {
    let (scene, element) = scene(seed);
    let found = Examined::of(&scene, levels)?;
    let last = found.last().unwrap();
    let size = found.iter().flat_map(|one| one.energies).fold(0.0, |size: f64, energy| size.max(energy.abs()));
    let mut violations = Vec::new();
    for (number, one) in found.iter().enumerate() {
        let mut hold = |what: &str, is_held: bool| {
            if !is_held {
                violations.push(format!("seed {seed}, {element}, mesh {number}: {what}: {one:?}, {last:?}"));
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
    let (of_displacement, of_own, of_force) = effectivities(&found);
    Ok(Shown { element, violations, of_displacement, of_own, of_force })
}

/// Bounds divided by errors, on meshes for which the last mesh gives the error to a few percent.
fn effectivities(found: &[Examined]) -> (Vec<f64>, Option<f64>, Vec<f64>) {
    const CLEAR: f64 = 20.0;
    let last = found.last().unwrap();
    let exact = (last.energies[0] + last.energies[1]) / 2.0;
    let clear = |one: &&Examined| one.bound > CLEAR * last.bound;
    let of_displacement =
        found.iter().filter(clear).map(|one| one.bound / (2.0 * (one.energies[1] - exact)).sqrt()).collect();
    let of_own = (last.own[1] > CLEAR * last.bound).then(|| last.own[0] / last.own[1]);
    let of_force = found.iter().filter_map(|one| {
        let [low, high] = one.force_interval?;
        Some((high - low) / 2.0 / one.force / (one.bound / one.norm))
    });
    (of_displacement, of_own, of_force.filter(|ratio| ratio.is_finite()).collect())
}
