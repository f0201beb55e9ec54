//! Solves the conditions `e = K u + B' z - f = 0`, `s = g - B u >= 0`, `z >= 0`, `s'z = 0` in integers. Principal
//! pivots eliminate the displacement; the rest is a linear complementarity problem. Lemke's method with the
//! lexicographic rule is finite and ends in a solution or a ray for every positive semidefinite K.
//!
//! # Source
//! R. W. Cottle, J.-S. Pang, R. E. Stone, *The Linear Complementarity Problem* (1992), sections 2.3, 4.4 and 4.9.

use std::cmp::Ordering;

use num_bigint::BigInt;

use super::dyadic::sign;
use super::tableau::Tableau;
use super::units::Integers;

/// A variable of the conditions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variable {
    /// e_j.
    Imbalance(usize),
    /// u_j.
    Displacement(usize),
    /// s_i.
    Distance(usize),
    /// z_i.
    Force(usize),
    /// The artificial variable of Lemke's method.
    Artificial,
}

use Variable::{Artificial, Displacement, Distance, Force, Imbalance};

impl Variable {
    fn complement(self) -> Variable {
        match self {
            Imbalance(j) => Displacement(j),
            Displacement(j) => Imbalance(j),
            Distance(i) => Force(i),
            Force(i) => Distance(i),
            Artificial => Artificial,
        }
    }
}

/// Result of the conditions.
#[derive(Clone, Debug)]
pub enum Ending {
    /// Displacements and forces, divided by a positive denominator.
    Solved { displacement: Vec<BigInt>, force: Vec<BigInt>, denominator: BigInt },
    /// No solution. The forces of the ray are Farkas' weights if K is definite.
    Ray(Vec<BigInt>),
}

/// The conditions after eliminating the displacement as far as K is regular.
pub struct Eliminated {
    tableau: Tableau<Variable>,
    dofs: usize,
    rows: usize,
    /// A basis of the null space of K: each vector as integers, in the order of the dofs.
    pub null: Vec<Vec<BigInt>>,
}

/// Eliminates u as far as K is regular. Returns `None` if K has a negative eigenvalue.
pub fn eliminate(problem: &Integers) -> Option<Eliminated> {
    let Integers { stiffness, contact, load, gap, .. } = problem;
    let (dofs, rows) = (load.len(), gap.len());
    let balance = (0..dofs).map(|i| {
        let forces = (0..rows).map(|row| contact[row][i].clone());
        std::iter::once(-&load[i]).chain(stiffness[i].iter().cloned()).chain(forces).collect()
    });
    let distance = (0..rows).map(|row| {
        let moved = contact[row].iter().map(|b| -b);
        std::iter::once(gap[row].clone()).chain(moved).chain((0..rows).map(|_| BigInt::ZERO)).collect()
    });
    let lines: Vec<Vec<BigInt>> = balance.chain(distance).collect();
    let basic = (0..dofs).map(Imbalance).chain((0..rows).map(Distance)).collect();
    let others = (0..dofs).map(Displacement).chain((0..rows).map(Force)).collect();
    let mut tableau = Tableau::new(lines, basic, others);
    let mut left: Vec<usize> = (0..dofs).collect();
    while let Some(place) = left.iter().position(|&dof| sign(tableau.entry(dof, dof)) != 0) {
        let dof = left.remove(place);
        if sign(tableau.entry(dof, dof)) < 0 {
            return None;
        }
        tableau.pivot(dof, dof);
    }
    if left.iter().any(|&i| left.iter().any(|&j| sign(tableau.entry(i, j)) != 0)) {
        return None;
    }
    let vector = |&free: &usize| {
        let entry = |dof: usize| match left.contains(&dof) {
            true if dof == free => tableau.denominator.clone(),
            true => BigInt::ZERO,
            false => tableau.entry(dof, free).clone(),
        };
        (0..dofs).map(entry).collect()
    };
    let null = left.iter().map(vector).collect();
    Some(Eliminated { tableau, dofs, rows, null })
}

impl Eliminated {
    /// Solves the remaining complementarity problem.
    pub fn end(self) -> Ending {
        let Eliminated { mut tableau, dofs, rows, null } = self;
        if !null.is_empty() && !eliminate_free(&mut tableau) {
            return Ending::Ray(vec![BigInt::ZERO; rows]);
        }
        // Every displacement is basic now, or has no effect; an imbalance that is not basic is zero.
        while let Some(place) = tableau.others.iter().position(|other| matches!(other, Imbalance(_) | Displacement(_)))
        {
            tableau.drop_other(place);
        }
        let mut displaced = Vec::new();
        for place in (0..tableau.basic.len()).rev() {
            match tableau.basic[place] {
                Displacement(dof) => displaced.push((dof, tableau.take_basic(place))),
                Imbalance(_) => drop(tableau.take_basic(place)),
                _ => {}
            }
        }
        let (of_displaced, known) = (tableau.others.clone(), tableau.denominator.clone());
        if let Some(ray) = lemke(&mut tableau) {
            let mut forces = vec![BigInt::ZERO; rows];
            for (variable, value) in ray {
                if let Force(row) = variable {
                    forces[row] = value;
                }
            }
            return Ending::Ray(forces);
        }
        let value = |variable: Variable| {
            let place = tableau.basic.iter().position(|&basic| basic == variable);
            place.map_or(BigInt::ZERO, |place| tableau.rows[place][0].clone())
        };
        // The displacements over the product of the two denominators.
        let others: Vec<BigInt> = of_displaced.iter().map(|&variable| value(variable)).collect();
        let mut displacement = vec![BigInt::ZERO; dofs];
        for (dof, row) in displaced {
            displacement[dof] =
                row[1..].iter().zip(&others).fold(&row[0] * &tableau.denominator, |sum, (a, x)| sum + a * x);
        }
        let force = (0..rows).map(|row| value(Force(row)) * &known).collect();
        Ending::Solved { displacement, force, denominator: known * &tableau.denominator }
    }
}

/// Exchanges each displacement that K leaves undetermined, and the force that has to balance it, with a row that it
/// moves. Returns `false` if nothing balances its load.
fn eliminate_free(tableau: &mut Tableau<Variable>) -> bool {
    let free: Vec<Variable> = tableau.others.iter().copied().filter(|other| matches!(other, Displacement(_))).collect();
    for variable in free {
        let column =
            tableau.others.iter().position(|&other| other == variable).expect("a free displacement is not basic");
        let imbalance = tableau
            .basic
            .iter()
            .position(|&basic| basic == variable.complement())
            .expect("the balance of a free displacement is basic");
        let is_row = |place: &usize| matches!(tableau.basic[*place], Distance(_) | Force(_));
        let moved = (0..tableau.basic.len()).filter(is_row).find(|&place| sign(tableau.entry(place, column)) != 0);
        let Some(place) = moved else {
            if sign(&tableau.rows[imbalance][0]) != 0 {
                return false;
            }
            continue;
        };
        let partner = tableau.basic[place].complement();
        tableau.pivot(place, column);
        let column = tableau.others.iter().position(|&other| other == partner).expect("a pair has one basic variable");
        tableau.pivot(imbalance, column);
    }
    true
}

/// Solves the complementarity problem of a tableau with any matrix. Returns the ray if Lemke's method ends in one.
pub(super) fn lemke(tableau: &mut Tableau<Variable>) -> Option<Vec<(Variable, BigInt)>> {
    let start = tableau.basic.clone();
    let artificial = tableau.others.len();
    tableau.others.push(Artificial);
    let denominator = tableau.denominator.clone();
    tableau.rows.iter_mut().for_each(|row| row.push(denominator.clone()));
    // The variable with the lowest constant leaves; of equal ones the last, as the lexicographic rule demands for unit
    // vectors.
    let lowest = (0..tableau.rows.len()).rev().min_by(|&a, &b| tableau.rows[a][0].cmp(&tableau.rows[b][0]))?;
    if sign(&tableau.rows[lowest][0]) >= 0 {
        return None;
    }
    let mut entering = tableau.basic[lowest].complement();
    tableau.pivot(lowest, artificial);
    loop {
        let column = tableau.others.iter().position(|&other| other == entering).expect("a complement is not basic");
        let Some(leaving) = first_to_vanish(tableau, column, &start) else {
            let ray = |place: usize| (tableau.basic[place], tableau.entry(place, column).clone());
            let itself = (entering, tableau.denominator.clone());
            return Some((0..tableau.basic.len()).map(ray).chain([itself]).collect());
        };
        let left = tableau.basic[leaving];
        tableau.pivot(leaving, column);
        if left == Artificial {
            return None;
        }
        entering = left.complement();
    }
}

/// The basic variable that becomes zero first as the variable at `column` grows, by the lexicographic rule.
fn first_to_vanish(tableau: &Tableau<Variable>, column: usize, start: &[Variable]) -> Option<usize> {
    let falling = (0..tableau.rows.len()).filter(|&place| sign(tableau.entry(place, column)) < 0);
    falling.reduce(|best, place| match earlier(tableau, column, start, place, best) {
        Ordering::Less => place,
        _ => best,
    })
}

/// Compares the rows a and b of `(constants, inverse of the basis)` over the entries of `column`.
fn earlier(tableau: &Tableau<Variable>, column: usize, start: &[Variable], a: usize, b: usize) -> Ordering {
    let rate = |place: usize| -tableau.entry(place, column);
    let (rate_a, rate_b) = (rate(a), rate(b));
    let compare = |at_a: &BigInt, at_b: &BigInt| (at_a * &rate_b).cmp(&(at_b * &rate_a));
    let constants = compare(&tableau.rows[a][0], &tableau.rows[b][0]);
    let inverse = |place: usize, variable: Variable| match tableau.others.iter().position(|&other| other == variable) {
        Some(other) => -tableau.entry(place, other),
        None if tableau.basic[place] == variable => tableau.denominator.clone(),
        None => BigInt::ZERO,
    };
    start
        .iter()
        .fold(constants, |order, &variable| order.then_with(|| compare(&inverse(a, variable), &inverse(b, variable))))
}
