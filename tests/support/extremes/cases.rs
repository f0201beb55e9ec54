//! Problems with extreme data whose solutions are known in closed form.

use serde_json::json;
use signorini::{ContactProblem, Error, Scene, SparseMatrix, SymmetricMatrix};

use super::entry::{Entry, Truth};

/// A block between rollers whose top is pressed down by a share of its height. The strain is uniaxial on every mesh.
struct Block {
    young: f64,
    poisson: f64,
    width: f64,
    height: f64,
    /// Penetration divided by the height.
    strain: f64,
    cells: [usize; 2],
    element: &'static str,
    /// Width of the first column of cells divided by that of the block.
    sliver: Option<f64>,
}

const BLOCK: Block = Block {
    young: 1.0,
    poisson: 0.3,
    width: 1.0,
    height: 1.0,
    strain: 0.01,
    cells: [8, 8],
    element: "q4",
    sliver: None,
};

impl Block {
    fn entry(&self, group: &'static str, label: impl Into<String>) -> Result<Entry, Error> {
        let x = match self.sliver {
            Some(share) => json!({"points": [0, share * self.width, self.width], "divisions": [1, self.cells[0]]}),
            None => json!({"points": [0, self.width], "divisions": [self.cells[0]]}),
        };
        let y = json!({"points": [0, self.height], "divisions": [self.cells[1]]});
        let scene = json!({
            "body": {"rectangle": {"x": x, "y": y, "element": self.element}},
            "material": {"young": self.young, "poisson": self.poisson},
            "supports": [
                {"on": {"boundary": "bottom"}, "y": 0},
                {"on": {"boundary": "left"}, "x": 0},
                {"on": {"boundary": "right"}, "x": 0}
            ],
            "obstacles": [{
                "boundary": "top", "approach": "+y",
                "shape": {"plane": {"point": [0, self.height], "normal": [0, 1]}}
            }],
            "gap": -self.strain * self.height
        });
        let model = Scene::from_json(&scene.to_string(), "block")?.build()?;
        let nu = self.poisson;
        let modulus = self.young * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
        let force = modulus * self.strain * self.width;
        Ok(Entry::new(group, label, model.problem().clone(), Truth::Force(force)))
    }
}

/// A chain of springs with `force` at its end. If `held`, the first spring is fixed to the ground. Each of `walls` is a
/// row (dof, gap).
fn chain(springs: &[f64], held: bool, force: f64, walls: &[(usize, f64)]) -> Result<ContactProblem, Error> {
    let dofs = springs.len();
    let mut entries = Vec::new();
    for (dof, &stiffness) in springs.iter().enumerate() {
        if dof > 0 {
            entries.extend([(dof - 1, dof - 1, stiffness), (dof, dof - 1, -stiffness)]);
        }
        if dof > 0 || held {
            entries.push((dof, dof, stiffness));
        }
    }
    let mut load = vec![0.0; dofs];
    load[dofs - 1] = force;
    let rows: Vec<_> = walls.iter().enumerate().map(|(row, &(dof, _))| (row, dof, 1.0)).collect();
    let contact = SparseMatrix::from_triplets(walls.len(), dofs, &rows)?;
    let stiffness = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(dofs, dofs, &entries)?)?;
    Ok(ContactProblem::new(stiffness, load, contact, walls.iter().map(|wall| wall.1).collect())?)
}

/// A node on unit springs under the given force, with walls of these normals and gaps.
fn node(force: [f64; 2], walls: &[([f64; 2], f64)]) -> Result<ContactProblem, Error> {
    let stiffness = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(2, 2, &[(0, 0, 1.0), (1, 1, 1.0)])?)?;
    let rows: Vec<_> = walls.iter().enumerate().flat_map(|(row, (n, _))| [(row, 0, n[0]), (row, 1, n[1])]).collect();
    let contact = SparseMatrix::from_triplets(walls.len(), 2, &rows)?;
    Ok(ContactProblem::new(stiffness, force.to_vec(), contact, walls.iter().map(|wall| wall.1).collect())?)
}

fn powers(exponents: impl IntoIterator<Item = i32>) -> impl Iterator<Item = f64> {
    // Parsed as a reader would write the number, because a power by multiplication is wrong in its last digit.
    exponents.into_iter().map(|exponent| format!("1e{exponent}").parse().unwrap_or(f64::NAN))
}

/// Returns all entries with at most `most` dofs.
pub fn entries(most: usize) -> Result<Vec<Entry>, Error> {
    let groups = [
        units()?,
        blocks()?,
        springs()?,
        walls()?,
        held_only_by_contact()?,
        sizes(most)?,
        nothing_touches()?,
        ends_of_double_precision()?,
    ];
    Ok(groups.into_iter().flatten().filter(|entry| entry.problem.dofs() <= most).collect())
}

/// Problems with scaled stiffness, length and load.
fn units() -> Result<Vec<Entry>, Error> {
    let mut entries = Vec::new();
    for scale in powers((-12..=12).step_by(4)) {
        entries.push(Block { young: scale, ..BLOCK }.entry("units", format!("E = {scale:e}"))?);
        entries.push(Block { width: scale, height: scale, ..BLOCK }.entry("units", format!("length {scale:e}"))?);
        let (mixed, inverse) = (Block { young: scale, width: scale, height: scale, ..BLOCK }, 1.0 / scale);
        entries.push(mixed.entry("units", format!("E and length {scale:e}"))?);
        let opposed = Block { young: scale, width: inverse, height: inverse, ..BLOCK };
        entries.push(opposed.entry("units", format!("E {scale:e}, length {inverse:e}"))?);
        // Ten springs under a load that would move their end to twice the distance of the wall.
        let wall = |stiffness: f64, gap: f64| chain(&[stiffness; 10], true, stiffness * gap / 5.0, &[(9, gap)]);
        let force = |stiffness: f64, gap: f64| Truth::Force(stiffness * gap / 10.0);
        entries.push(Entry::new("units", format!("load {scale:e}"), wall(scale, 1.0)?, force(scale, 1.0)));
        let label = format!("load and length {scale:e}");
        entries.push(Entry::new("units", label, wall(scale, scale)?, force(scale, scale)));
    }
    Ok(entries)
}

/// Blocks with extreme penetration, material and shape.
fn blocks() -> Result<Vec<Entry>, Error> {
    let mut entries = Vec::new();
    for strain in powers((-12..=0).step_by(2)) {
        entries.push(Block { strain, ..BLOCK }.entry("gap over size", format!("{strain:e}"))?);
    }
    for poisson in [-0.99, -0.5, 0.0, 0.4, 0.49, 0.4999, 0.499999, 0.4999999] {
        entries.push(Block { poisson, ..BLOCK }.entry("Poisson's ratio", format!("{poisson}"))?);
    }
    for aspect in powers(0..=6) {
        entries.push(Block { width: aspect, ..BLOCK }.entry("aspect ratio", format!("{aspect:e} wide"))?);
        entries.push(Block { height: aspect, ..BLOCK }.entry("aspect ratio", format!("{aspect:e} high"))?);
    }
    for degrees in [10.0, 1.0, 0.1, 0.01] {
        let share = f64::to_radians(degrees).tan() / 8.0;
        let block = Block { element: "t3", sliver: Some(share), ..BLOCK };
        entries.push(block.entry("slivers", format!("angle {degrees} degrees"))?);
    }
    Ok(entries)
}

/// Springs of very different stiffness, penalties, and walls that just touch.
fn springs() -> Result<Vec<Entry>, Error> {
    let mut entries = Vec::new();
    for contrast in powers((0..=12).step_by(3)) {
        let springs: Vec<f64> = (0..20).map(|spring| if spring % 2 == 0 { 1.0 } else { contrast }).collect();
        let compliance: f64 = springs.iter().map(|spring| 1.0 / spring).sum();
        let problem = chain(&springs, true, 2.0 / compliance, &[(19, 1.0)])?;
        entries.push(Entry::new(
            "stiffness contrast",
            format!("{contrast:e}"),
            problem,
            Truth::Force(1.0 / compliance),
        ));
    }
    for penalty in powers((-4..=18).step_by(2)) {
        let problem = chain(&[10.0; 10], true, 2.0, &[(9, 1.0)])?;
        let entry = Entry::new("penalty over stiffness", format!("{penalty:e}"), problem, Truth::Force(1.0));
        entries.push(Entry { penalty: Some(penalty), ..entry });
    }
    for (label, count) in [("none", 0), ("one", 1), ("many", 5), ("all but one", 9)] {
        // If the last node reaches its wall, node k is displaced by k / 10, so that its wall has zero gap and zero
        // force.
        let walls: Vec<(usize, f64)> = (0..count).map(|dof| (dof, (dof + 1) as f64 / 10.0)).chain([(9, 1.0)]).collect();
        let problem = chain(&[10.0; 10], true, 2.0, &walls)?;
        entries.push(Entry::new("weakly active rows", label, problem, Truth::Force(1.0)));
    }
    Ok(entries)
}

/// Walls that are nearly or exactly parallel, or that contradict each other.
fn walls() -> Result<Vec<Entry>, Error> {
    let mut entries = Vec::new();
    for copies in [2, 10, 100] {
        let problem = node([3.0, 1.0], &vec![([1.0, 0.0], 0.5); copies])?;
        entries.push(Entry::new("duplicate rows", format!("{copies}"), problem, Truth::Force(2.5)));
    }
    for angle in powers((-12..=-1).rev()) {
        // Only the inclined row closes: n.(f - l n) = g.
        let normal = [angle.cos(), angle.sin()];
        let force = 3.0 * normal[0] + normal[1] - 0.5;
        let problem = node([3.0, 1.0], &[([1.0, 0.0], 0.5), (normal, 0.5)])?;
        entries.push(Entry::new("nearly parallel rows", format!("angle {angle:e}"), problem, Truth::Force(force)));
    }
    for overlap in powers((-14..=-2).rev()) {
        let problem = node([1.0, 0.0], &[([1.0, 0.0], 1.0), ([-1.0, 0.0], -1.0 - overlap)])?;
        entries.push(Entry::new("gaps that cross", format!("by {overlap:e}"), problem, Truth::None));
    }
    Ok(entries)
}

/// Springs without a support.
fn held_only_by_contact() -> Result<Vec<Entry>, Error> {
    let mut entries = Vec::new();
    for dofs in [1, 2, 10, 1000] {
        let problem = chain(&vec![1.0; dofs], false, 2.0, &[(dofs - 1, 1.0)])?;
        entries.push(Entry::new("held only by contact", format!("{dofs} dofs"), problem, Truth::Force(2.0)));
    }
    let pulled = chain(&[1.0; 10], false, -2.0, &[(9, 1.0)])?;
    entries.push(Entry::new("held only by contact", "pulled away", pulled, Truth::None));
    Ok(entries)
}

/// Problems from one dof to half a million dofs, limited to `most` dofs.
fn sizes(most: usize) -> Result<Vec<Entry>, Error> {
    let mut entries = Vec::new();
    for cells in [1, 4, 16, 60, 180, 500] {
        let dofs = 2 * cells * cells;
        if dofs <= most {
            let block = Block { cells: [cells; 2], ..BLOCK };
            entries.push(block.entry("size, all candidates closed", format!("some {dofs} dofs"))?);
        }
    }
    let single = chain(&[1.0], true, 2.0, &[(0, 1.0)])?;
    entries.push(Entry::new("size, all candidates closed", "1 dof", single, Truth::Force(1.0)));
    Ok(entries)
}

/// Problems with walls that the body does not reach.
fn nothing_touches() -> Result<Vec<Entry>, Error> {
    let mut entries = Vec::new();
    let free = |walls: &[(usize, f64)]| chain(&[10.0; 10], true, 2.0, walls);
    entries.push(Entry::new("nothing touches", "no candidate", free(&[])?, Truth::Reach(2.0)));
    entries.push(Entry::new("nothing touches", "gap inf", free(&[(9, f64::INFINITY)])?, Truth::Reach(2.0)));
    for gap in powers([3, 12, 19, 20, 100]) {
        entries.push(Entry::new("nothing touches", format!("gap {gap:e}"), free(&[(9, gap)])?, Truth::Reach(2.0)));
    }
    let still = chain(&[10.0; 10], true, 0.0, &[(9, 0.0), (4, 0.0)])?;
    entries.push(Entry::new("nothing touches", "no load, no gap", still, Truth::Reach(0.0)));
    Ok(entries)
}

/// Problems with numbers at the ends of the range of double precision.
fn ends_of_double_precision() -> Result<Vec<Entry>, Error> {
    let mut entries = Vec::new();
    for size in powers([-300, -200, -100, 100, 200, 300]) {
        let label = |what: &str| format!("{what} {size:e}");
        let problem = chain(&[size], true, 2.0 * size, &[(0, 1.0)])?;
        entries.push(Entry::new("ends of double precision", label("stiffness"), problem, Truth::Force(size)));
        let problem = chain(&[1.0], true, 2.0 * size, &[(0, size)])?;
        entries.push(Entry::new("ends of double precision", label("length"), problem, Truth::Force(size)));
    }
    let denormal = chain(&[1.0], true, 4e-320, &[(0, 2e-320)])?;
    entries.push(Entry::new("ends of double precision", "denormal length", denormal, Truth::Force(2e-320)));
    Ok(entries)
}
