//! The exact answer of a problem, or the exact reason why it has no answer. Every verdict is verified in the data
//! before it is returned.

use serde_json::{Value, json};

use super::case::Case;
use super::dyadic::{Dyadic, dot, ratio};
use super::lemke::{Ending, eliminate};
use super::problem::Exact;
use super::tableau::rank;
use super::units::Integers;

type Vector = Vec<Dyadic>;

/// A solution: displacements u (n) and forces z = -lambda (m of [`Exact`]), each divided by `denominator > 0`.
#[derive(Clone, Debug)]
pub struct Answer {
    pub displacement: Vec<Dyadic>,
    pub force: Vec<Dyadic>,
    pub denominator: Dyadic,
    /// `true` if no other displacement solves the problem.
    pub is_unique: bool,
}

/// Outcome of a problem.
#[derive(Clone, Debug)]
pub enum Outcome {
    Solved(Answer),
    /// Farkas' weights y: `y >= 0`, `B'y = 0`, `g'y < 0`, and `-g'y / |g|'y`.
    Infeasible {
        weights: Vec<Dyadic>,
        overlap: f64,
        is_driven: bool,
    },
    /// The direction d: `K d = 0`, `B d <= 0`, `f'd > 0`, and `f'd / |f|'|d|`.
    Unbounded {
        direction: Vec<Dyadic>,
        drive: f64,
    },
    /// K has a negative eigenvalue.
    Indefinite {
        is_feasible: bool,
    },
}

impl Outcome {
    /// The name of the outcome, as the program uses it.
    pub fn verdict(&self) -> &'static str {
        match self {
            Outcome::Solved(answer) if answer.is_unique => "solved",
            Outcome::Solved(_) => "under-held",
            Outcome::Infeasible { .. } => "infeasible",
            Outcome::Unbounded { .. } => "unbounded",
            Outcome::Indefinite { .. } => "not-convex",
        }
    }
}

impl Exact {
    /// A solution rounded to doubles: u, and lambda with an entry for each row of the case.
    pub fn rounded(&self, case: &Case, answer: &Answer) -> (Vec<f64>, Vec<f64>) {
        let round = |value| ratio(value, &answer.denominator);
        let mut lambda = vec![0.0; case.rows()];
        // Zero without a sign, as in files.
        self.rows.iter().zip(&answer.force).for_each(|(&row, force)| lambda[row] = 0.0 - round(force));
        (answer.displacement.iter().map(round).collect(), lambda)
    }

    /// The outcome as JSON, rounded to doubles.
    pub fn json(&self, case: &Case) -> Value {
        let outcome = self.outcome();
        let over_sum = |values: &[Dyadic]| -> Vec<f64> {
            let sum = values.iter().fold(Dyadic::ZERO, |sum, value| &sum + &value.abs());
            values.iter().map(|value| ratio(value, &sum)).collect()
        };
        let verdict = outcome.verdict();
        match &outcome {
            Outcome::Solved(answer) => {
                let (displacement, multiplier) = self.rounded(case, answer);
                json!({"verdict": verdict, "displacement": displacement, "multiplier": multiplier})
            }
            Outcome::Infeasible { weights, overlap, .. } => {
                json!({"verdict": verdict, "weights": over_sum(weights), "rows": self.rows, "overlap": overlap})
            }
            Outcome::Unbounded { direction, drive } => {
                json!({"verdict": verdict, "direction": over_sum(direction), "drive": drive})
            }
            Outcome::Indefinite { is_feasible } => json!({"verdict": verdict, "feasible": is_feasible}),
        }
    }

    /// Decides the problem.
    pub fn outcome(&self) -> Outcome {
        let Some((ending, null)) = self.end() else {
            return Outcome::Indefinite { is_feasible: self.contradiction().is_none() };
        };
        match ending {
            Ok(mut answer) => {
                answer.is_unique = self.is_unique(&answer, &null);
                Outcome::Solved(answer)
            }
            Err(_) => {
                let escape = self.escape(&null);
                match (self.contradiction(), escape) {
                    (Some(weights), escape) => {
                        let (work, size) = (dot(&self.gap, &weights), self.size_of_gaps(&weights));
                        Outcome::Infeasible { overlap: -ratio(&work, &size), weights, is_driven: escape.is_some() }
                    }
                    (None, Some(direction)) => {
                        let size: Dyadic =
                            self.load.iter().zip(&direction).fold(Dyadic::ZERO, |sum, (f, d)| &sum + &(f * d).abs());
                        Outcome::Unbounded { drive: ratio(&dot(&self.load, &direction), &size), direction }
                    }
                    (None, None) => panic!("a feasible problem without an escape direction must have a solution"),
                }
            }
        }
    }

    fn size_of_gaps(&self, weights: &[Dyadic]) -> Dyadic {
        self.gap.iter().zip(weights).fold(Dyadic::ZERO, |sum, (g, y)| &sum + &(g * y).abs())
    }

    /// The verified answer of the conditions, or the forces of the ray in which they end, and the null space of K.
    /// Returns `None` if K has a negative eigenvalue.
    fn end(&self) -> Option<(Result<Answer, Vector>, Vec<Vector>)> {
        let integers = Integers::of(self);
        let eliminated = eliminate(&integers)?;
        let null = eliminated.null.iter().map(|vector| integers.displacement(vector)).collect();
        let ending = match eliminated.end() {
            Ending::Ray(forces) => Err(integers.force(&forces)),
            Ending::Solved { displacement, force, denominator } => Ok(Answer {
                displacement: integers.displacement(&displacement),
                force: integers.force(&force),
                denominator: Dyadic::new(denominator, 0),
                is_unique: true,
            }),
        };
        if let Ok(answer) = &ending {
            self.check_solved(answer);
        }
        Some((ending, null))
    }

    /// `g - B u`, times the denominator of u.
    pub fn distances(&self, answer: &Answer) -> Vec<Dyadic> {
        let distance =
            |(row, gap): (&Vec<Dyadic>, &Dyadic)| &(gap * &answer.denominator) - &dot(row, &answer.displacement);
        self.contact.iter().zip(&self.gap).map(distance).collect()
    }

    /// Asserts every condition of a solution.
    fn check_solved(&self, answer: &Answer) {
        assert!(answer.denominator.sign() > 0);
        for dof in 0..self.dofs() {
            let column = self.contact.iter().map(|row| &row[dof]);
            let force = &dot(&self.stiffness[dof], &answer.displacement) + &dot(column, &answer.force);
            assert!(force == &self.load[dof] * &answer.denominator, "dof {dof} is not in equilibrium");
        }
        for (row, (distance, force)) in self.distances(answer).iter().zip(&answer.force).enumerate() {
            assert!(
                distance.sign() >= 0 && force.sign() >= 0 && (distance * force).is_zero(),
                "the contact conditions of row {row} do not hold"
            );
        }
    }

    /// Farkas' weights if no displacement meets the rows: the ray of the search for the smallest displacement that
    /// does.
    fn contradiction(&self) -> Option<Vec<Dyadic>> {
        let least = self.with(identity(self.dofs()), vec![Dyadic::ZERO; self.dofs()]);
        let (ending, _) = least.end().expect("the identity is definite");
        let weights = ending.err()?;
        let cancels = |dof: usize| dot(self.contact.iter().map(|row| &row[dof]), &weights).is_zero();
        assert!(
            weights.iter().all(|weight| weight.sign() >= 0) && (0..self.dofs()).all(cancels),
            "the weights are negative or the rows do not cancel"
        );
        assert!(dot(&self.gap, &weights).sign() < 0, "Farkas' weights do not show a contradiction");
        Some(weights)
    }

    fn with(&self, stiffness: Vec<Vec<Dyadic>>, load: Vec<Dyadic>) -> Exact {
        Exact { stiffness, load, ..self.clone() }
    }

    /// `B N` and `N' f` of a null space N.
    fn in_null_space(&self, null: &[Vec<Dyadic>]) -> (Vec<Vec<Dyadic>>, Vec<Dyadic>) {
        let rows = self.contact.iter().map(|row| null.iter().map(|vector| dot(row, vector)).collect()).collect();
        (rows, null.iter().map(|vector| dot(&self.load, vector)).collect())
    }

    /// A direction without energy along which the load pushes and which no row stops, if there is one: the projection
    /// of the load onto the cone of the directions that the rows allow.
    fn escape(&self, null: &[Vec<Dyadic>]) -> Option<Vec<Dyadic>> {
        let (contact, load) = self.in_null_space(null);
        let coefficients = projection(load, contact)?;
        let entry = |dof: usize| dot(null.iter().map(|vector| &vector[dof]), &coefficients);
        let direction: Vec<Dyadic> = (0..self.dofs()).map(entry).collect();
        assert!(self.stiffness.iter().all(|row| dot(row, &direction).is_zero()), "the escape direction has energy");
        assert!(self.contact.iter().all(|row| dot(row, &direction).sign() <= 0), "a row stops the escape direction");
        assert!(dot(&self.load, &direction).sign() > 0, "the load does no work along the escape direction");
        Some(direction)
    }

    /// Returns `true` if u is the only solution. Another one differs from u by a direction without energy that opens
    /// closed rows or slides along them, and that slides along all rows with a force.
    fn is_unique(&self, answer: &Answer, null: &[Vec<Dyadic>]) -> bool {
        if null.is_empty() {
            return true;
        }
        let (moved, _) = self.in_null_space(null);
        let distances = self.distances(answer);
        let closed: Vec<usize> = (0..moved.len()).filter(|&row| distances[row].is_zero()).collect();
        let low = moved.iter().flatten().map(Dyadic::exponent).min().unwrap_or(0);
        let whole = closed.iter().map(|&row| moved[row].iter().map(|value| value.over(low.min(0))).collect());
        if rank(whole.collect()) < null.len() {
            return false;
        }
        let (pressed, touching): (Vec<usize>, Vec<usize>) =
            closed.iter().partition(|&&row| answer.force[row].sign() > 0);
        let away = |place: usize| touching.iter().fold(Dyadic::ZERO, |sum, &row| &sum - &moved[row][place]);
        let mut contact: Vec<Vec<Dyadic>> = closed.iter().map(|&row| moved[row].clone()).collect();
        contact.extend(pressed.iter().map(|&row| moved[row].iter().map(|value| -value).collect()));
        projection((0..null.len()).map(away).collect(), contact).is_none()
    }
}

fn identity(size: usize) -> Vec<Vec<Dyadic>> {
    (0..size).map(|i| (0..size).map(|j| Dyadic::integer(i64::from(i == j))).collect()).collect()
}

/// The point nearest to `load` in the cone `rows c <= 0`, times a positive number; `None` if it is zero.
fn projection(load: Vec<Dyadic>, rows: Vec<Vec<Dyadic>>) -> Option<Vec<Dyadic>> {
    let gap = vec![Dyadic::ZERO; rows.len()];
    let nearest = Exact { stiffness: identity(load.len()), load, rows: (0..gap.len()).collect(), contact: rows, gap };
    let (ending, _) = nearest.end().expect("the identity is definite");
    let answer = ending.expect("a cone must have a nearest point");
    answer.displacement.iter().any(|value| !value.is_zero()).then_some(answer.displacement)
}
