//! The next mesh for a guaranteed bound. A mesh costs two solves, and a refinement nothing beside them: it is repeated,
//! with the shares that its pieces are expected to have, until the next mesh is worth its solves.

use super::goal::{LEAST, marked};
use crate::continuum::{Bracket, SimplexMesh};

/// The share of the square of the error that is refined at once. Several small steps grade the mesh better than a large
/// one.
const AT_ONCE: f64 = 0.2;

/// A mesh that is not expected to meet the goal has more than this many times the simplices of the one before.
const GROWN: f64 = 1.9;

/// A simplex with at least this share of the size of the one before is whole: new nodes on circles change sizes a
/// little.
const WHOLE: f64 = 0.9;

/// The logarithm of the measured reduction of the error over that of the expected one lies in this range, or the last
/// step is no example.
const RESPONSE: [f64; 2] = [0.5, 2.0];

/// How shares answer to refinement, as the meshes so far show it.
#[derive(Debug, Default)]
pub(super) struct Foresight {
    /// For each node the power of the size of the simplices at it with which their shares fall: small at a
    /// singularity.
    powers: Vec<f64>,
    /// For each simplex, the share and the size of the simplex of the last mesh of which it is a piece.
    wholes: Vec<[f64; 2]>,
    /// The bound on the last mesh, and the share of its square that was expected to be left on this one.
    before: Option<[f64; 2]>,
}

impl Foresight {
    /// A finer mesh, for a bound that meets the goal or for one that is as small as [`GROWN`] allows, and the nodes of
    /// it that are expected to touch.
    pub fn finer(&mut self, bracket: &Bracket, goal: f64) -> (SimplexMesh, Vec<bool>) {
        let (problem, mesh, bound) = (bracket.problem, bracket.mesh, bracket.bound());
        let (mut shares, mut touching) = (bracket.shares.clone(), bracket.touching());
        let (whole, smooth) = (bracket.distance(), smooth(mesh));
        self.learn(mesh, &shares);
        let response = self.before.map_or(1.0, |[before, left]| 2.0 * (bound / before).ln() / left.ln());
        let response = if response.is_nan() { 1.0 } else { response.clamp(RESPONSE[0], RESPONSE[1]) };
        self.wholes = (0..mesh.count()).map(|cell| [shares[cell], mesh.simplex(cell).size()]).collect();
        let (mut finer, mut wanted) = (mesh.clone(), 1.0 - (goal / bound).powi(2));
        loop {
            let next = problem.refined(&finer, &marked(&shares, wanted.clamp(LEAST, AT_ONCE)));
            touching = next.carried(touching, |one, other| one && other);
            self.powers = next.carried(std::mem::take(&mut self.powers), f64::max);
            let of_piece = |cell: usize| {
                let power = next.cell(cell).iter().map(|&node| self.powers[node]).fold(smooth, f64::min);
                let whole = next.wholes[cell];
                shares[whole] * (next.simplex(cell).size() / finer.simplex(whole).size()).powf(power)
            };
            shares = (0..next.count()).map(of_piece).collect();
            self.wholes = next.wholes.iter().map(|&whole| self.wholes[whole]).collect();
            let left = shares.iter().sum::<f64>() / whole;
            wanted = 1.0 - (goal / bound).powi(2) / left.powf(response);
            let is_enough = next.count() as f64 > GROWN * mesh.count() as f64 || next.count() == finer.count();
            finer = next;
            if wanted <= 0.0 || is_enough {
                self.before = Some([bound, left]);
                return (finer, touching);
            }
        }
    }

    /// Takes the powers at the nodes of the simplices that were refined last from the shares of their pieces. A node
    /// has the largest: at a singularity all of them are small.
    fn learn(&mut self, mesh: &SimplexMesh, shares: &[f64]) {
        let (smooth, mut found) = (smooth(mesh), vec![-1.0_f64; mesh.nodes.len()]);
        for (cell, [share, size]) in self.wholes.iter().enumerate() {
            let power = (shares[cell] / share).ln() / (mesh.simplex(cell).size() / size).ln();
            // The power of a simplex that was not refined has no meaning.
            if mesh.simplex(cell).size() < WHOLE * size && !power.is_nan() {
                mesh.cell(cell).iter().for_each(|&node| found[node] = found[node].max(power.clamp(0.0, smooth)));
            }
        }
        self.powers.resize(mesh.nodes.len(), smooth);
        self.powers.iter_mut().zip(found).filter(|pair| pair.1 >= 0.0).for_each(|(power, found)| *power = found);
    }
}

/// The power where stresses are smooth: the square of the error of linear stresses falls with the fourth power of the
/// length, on the volume.
fn smooth(mesh: &SimplexMesh) -> f64 {
    1.0 + 4.0 / mesh.dimension as f64
}
