//! Kinds of contact rows with their gaps.

use super::Draws;

/// Contact rows: B (m x n) and g (m).
#[derive(Clone, Debug, Default)]
pub struct Rows {
    pub contact: Vec<Vec<f64>>,
    pub gap: Vec<f64>,
}

/// Makes rows for a body; their gaps are measured from a point.
type Make = fn(&mut Draws, &[f64]) -> Rows;

/// Every kind of rows with its name.
pub const ROWS: [(&str, Make); 14] = [
    ("few", few),
    ("boolean", boolean),
    ("difference", difference),
    ("integer", integer),
    ("dense", dense),
    ("duplicate", duplicate),
    ("scaled-duplicate", scaled_duplicate),
    ("dependent", dependent),
    ("opposed", opposed),
    ("nearly-parallel", nearly_parallel),
    ("empty", empty),
    ("infinite", infinite),
    ("vertex", vertex),
    ("infeasible", infeasible),
];

/// Relative amounts by which the gap of a copied row is tighter or looser than that of the first.
const OFFSETS: [f64; 10] = [0.0, 0.0, 0.0, 6e-3, -6e-3, 1e-3, -1e-3, 1e-9, -1e-9, 1.0];

impl Rows {
    fn count(&self) -> usize {
        self.gap.len()
    }

    fn push(&mut self, row: Vec<f64>, gap: f64) {
        self.contact.push(row);
        self.gap.push(gap);
    }
}

pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Adds `count` rows; the distance of each from the point is mostly zero or positive.
fn add(rows: &mut Rows, draws: &mut Draws, point: &[f64], count: usize, make: fn(&mut Draws, usize) -> Vec<f64>) {
    for _ in 0..count {
        let row = make(draws, point.len());
        let distance = match draws.below(5) {
            0 => 0.0,
            1 => draws.signed(),
            2 => draws.short(-8, 0),
            _ => 0.5 + 0.5 * draws.signed(),
        };
        let gap = dot(&row, point) + distance;
        rows.push(row, gap);
    }
}

fn unit(draws: &mut Draws, n: usize) -> Vec<f64> {
    let mut row = vec![0.0; n];
    row[draws.below(n)] = draws.pick(&[1.0, 1.0, -1.0]);
    row
}

fn pair(draws: &mut Draws, n: usize) -> Vec<f64> {
    let mut row = vec![0.0; n];
    row[draws.below(n)] = 1.0;
    let other = draws.below(n);
    row[other] = if row[other] == 0.0 { -1.0 } else { 1.0 };
    row
}

fn whole(draws: &mut Draws, n: usize) -> Vec<f64> {
    (0..n).map(|_| f64::from(draws.between(-2, 2))).collect()
}

fn random(draws: &mut Draws, n: usize) -> Vec<f64> {
    (0..n).map(|_| draws.signed()).collect()
}

fn any(draws: &mut Draws, n: usize) -> Vec<f64> {
    draws.pick(&[unit, unit, pair, whole, random])(draws, n)
}

fn few(draws: &mut Draws, point: &[f64]) -> Rows {
    let (mut rows, count) = (Rows::default(), draws.below(3));
    add(&mut rows, draws, point, count, any);
    rows
}

fn some(draws: &mut Draws, point: &[f64], most: usize, make: fn(&mut Draws, usize) -> Vec<f64>) -> Rows {
    // Sometimes as many rows as a larger body has dofs.
    let most = if draws.one_in(4) { most.max(point.len()) } else { most };
    let (mut rows, count) = (Rows::default(), 1 + draws.below(most));
    add(&mut rows, draws, point, count, make);
    rows
}

fn boolean(draws: &mut Draws, point: &[f64]) -> Rows {
    some(draws, point, 9, unit)
}

/// Rows between two dofs; in some problems, from each dof to the next.
fn difference(draws: &mut Draws, point: &[f64]) -> Rows {
    if draws.one_in(2) {
        return some(draws, point, 9, pair);
    }
    let mut rows = Rows::default();
    for dof in 1..point.len() {
        let mut row = vec![0.0; point.len()];
        (row[dof - 1], row[dof]) = (-1.0, 1.0);
        rows.push(row, point[dof] - point[dof - 1] + draws.signed());
    }
    rows
}

fn integer(draws: &mut Draws, point: &[f64]) -> Rows {
    some(draws, point, 12, whole)
}

fn dense(draws: &mut Draws, point: &[f64]) -> Rows {
    some(draws, point, 9, random)
}

/// A few rows, then more that are derived from those.
fn more(draws: &mut Draws, point: &[f64], make: fn(&mut Draws, &Rows) -> (Vec<f64>, f64)) -> Rows {
    let mut rows = some(draws, point, 5, any);
    for _ in 0..1 + draws.below(4) {
        let (row, gap) = make(draws, &rows);
        rows.push(row, gap);
    }
    rows
}

/// A gap made tighter or looser by a share of its size, or by that share of 1 if it is zero.
fn off(draws: &mut Draws, gap: f64) -> f64 {
    gap + draws.pick(&OFFSETS) * if gap == 0.0 { 1.0 } else { gap.abs() }
}

fn duplicate(draws: &mut Draws, point: &[f64]) -> Rows {
    more(draws, point, |draws, rows| {
        let of = draws.below(rows.count());
        (rows.contact[of].clone(), off(draws, rows.gap[of]))
    })
}

fn scaled_duplicate(draws: &mut Draws, point: &[f64]) -> Rows {
    more(draws, point, |draws, rows| {
        let of = draws.below(rows.count());
        let factor = draws.pick(&[1e-3, 1e-6, 1e-9, 1e-13, 2.0_f64.powi(-30), 3.0, 1e3, 1e7]);
        (rows.contact[of].iter().map(|b| b * factor).collect(), factor * off(draws, rows.gap[of]))
    })
}

fn dependent(draws: &mut Draws, point: &[f64]) -> Rows {
    more(draws, point, |draws, rows| {
        let factor = draws.pick(&[1.0, 1.0, 1.0, 0.25, 1e-6, 1e-13]);
        let (mut row, mut gap) = (vec![0.0; rows.contact[0].len()], 0.0);
        for _ in 0..2 + draws.below(2) {
            let (of, weight) = (draws.below(rows.count()), draws.pick(&[1.0, 1.0, 2.0, -1.0, 0.5]));
            row.iter_mut().zip(&rows.contact[of]).for_each(|(entry, b)| *entry += weight * b);
            gap += weight * rows.gap[of];
        }
        row.iter_mut().for_each(|entry| *entry *= factor);
        (row, factor * off(draws, gap))
    })
}

fn opposed(draws: &mut Draws, point: &[f64]) -> Rows {
    more(draws, point, |draws, rows| {
        let of = draws.below(rows.count());
        let width = draws.pick(&[0.0, 0.0, 1.0, 1.0, 0.125, 1e-3, 1e-9, -1e-3]);
        (rows.contact[of].iter().map(|b| -b).collect(), width - rows.gap[of])
    })
}

fn nearly_parallel(draws: &mut Draws, point: &[f64]) -> Rows {
    more(draws, point, |draws, rows| {
        let (of, apart) = (draws.below(rows.count()), draws.decades(1e-12, 1e-1));
        let row = rows.contact[of].iter().map(|b| b + apart * draws.signed()).collect();
        (row, rows.gap[of] + apart * draws.signed())
    })
}

/// Empty rows among others; a stiffness with a zero diagonal adds rows on dofs without stiffness by chance.
fn empty(draws: &mut Draws, point: &[f64]) -> Rows {
    more(draws, point, |draws, rows| {
        let mut row = vec![0.0; rows.contact[0].len()];
        if draws.one_in(2) {
            let last = row.len() - 1;
            row[last] = draws.pick(&[1.0, -1.0, 1e-3]);
        }
        (row, draws.pick(&[0.0, 1.0, 1.0, 1e-3, 0.5]))
    })
}

fn infinite(draws: &mut Draws, point: &[f64]) -> Rows {
    let mut rows = some(draws, point, 8, any);
    for gap in &mut rows.gap {
        if draws.one_in(3) {
            *gap = draws.pick(&[f64::INFINITY, 1e20, 1e30]);
        }
    }
    rows
}

/// More rows than the point needs; all pass through the point.
fn vertex(draws: &mut Draws, point: &[f64]) -> Rows {
    let mut rows = Rows::default();
    for _ in 0..1 + draws.below(point.len() + 4) {
        let row = draws.pick(&[unit, pair, whole])(draws, point.len());
        let gap = dot(&row, point);
        rows.push(row, gap);
    }
    rows
}

/// A row that is the opposite of a sum of others and contradicts them.
fn infeasible(draws: &mut Draws, point: &[f64]) -> Rows {
    let mut rows = some(draws, point, 5, any);
    let (mut row, mut gap) = (vec![0.0; point.len()], 0.0);
    for of in 0..rows.count() {
        let weight = draws.pick(&[0.0, 1.0, 1.0, 2.0, 0.5]);
        row.iter_mut().zip(&rows.contact[of]).for_each(|(entry, b)| *entry -= weight * b);
        gap -= weight * rows.gap[of];
    }
    let size = gap.abs().max(row.iter().fold(0.0_f64, |size, b| size.max(b.abs())));
    rows.push(row, gap - draws.pick(&[1.0, 1.0, 1e-3]) * if size > 0.0 { size } else { 1.0 });
    rows
}
