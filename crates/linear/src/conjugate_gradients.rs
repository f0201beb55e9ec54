//! The step of conjugate gradients. Its callers give operator and preconditioned residual, and decide after each step,
//! or before the next, whether to stop.

use super::dot;

/// Groups of unknowns that share no energy: the blocks of a block-diagonal matrix.
#[derive(Clone, Copy, Debug)]
pub struct Blocks<'a> {
    /// The block of each unknown; not read if there is only one block.
    pub of_unknown: &'a [usize],
    /// Number of blocks.
    pub count: usize,
}

impl Blocks<'_> {
    /// All unknowns in one block.
    pub const ONE: Blocks<'static> = Blocks { of_unknown: &[], count: 1 };

    /// The block of an unknown.
    pub fn of(&self, unknown: usize) -> usize {
        if self.count == 1 { 0 } else { self.of_unknown[unknown] }
    }

    /// The scalar product of two vectors on each block.
    pub fn dots(&self, a: &[f64], b: &[f64]) -> Vec<f64> {
        if self.count == 1 {
            return vec![dot(a, b)];
        }
        let mut dots = vec![0.0; self.count];
        a.iter().zip(b).zip(self.of_unknown).for_each(|((a, b), &block)| dots[block] += a * b);
        dots
    }

    /// `y += factor x` with the factor of each block.
    fn add(&self, y: &mut [f64], factors: &[f64], x: &[f64]) {
        if let [factor] = factors {
            return y.iter_mut().zip(x).for_each(|(y, x)| *y += factor * x);
        }
        y.iter_mut().zip(x).zip(self.of_unknown).for_each(|((y, x), &block)| *y += factors[block] * x);
    }
}

/// The state of conjugate gradients for A x = b. Each block has its own, with scale, step lengths and Ritz values of
/// its own.
#[derive(Clone, Debug)]
pub struct Iterate<'a> {
    blocks: Blocks<'a>,
    /// The iterate x, one entry per column of A.
    pub solution: Vec<f64>,
    /// b - A x.
    pub rest: Vec<f64>,
    /// The direction p of the last step, length n.
    pub direction: Vec<f64>,
    /// A p.
    moved: Vec<f64>,
    /// `p'A p` in each block.
    pub energies: Vec<f64>,
    /// The coefficient of the previous direction in p, in each block; 0 in the first step.
    pub shares: Vec<f64>,
    /// The length of the last step in units of p, in each block.
    pub lengths: Vec<f64>,
}

impl<'a> Iterate<'a> {
    /// The start at x with the residual `rest`.
    pub fn new(solution: Vec<f64>, rest: Vec<f64>, blocks: Blocks<'a>) -> Self {
        let (zeros, of_blocks) = (vec![0.0; rest.len()], vec![0.0; blocks.count]);
        let (energies, shares, lengths) = (of_blocks.clone(), of_blocks.clone(), of_blocks);
        Iterate { blocks, solution, rest, direction: zeros.clone(), moved: zeros, energies, shares, lengths }
    }

    /// Moves x along the preconditioned residual, made conjugate to the last direction. A block in which the
    /// preconditioned residual is zero from here on stays where it is. If another block has no positive energy or no
    /// finite step, this returns `false` and moves nothing; the direction and its energies remain as evidence.
    pub fn step(&mut self, preconditioned: Vec<f64>, operator: impl FnOnce(&[f64]) -> Vec<f64>) -> bool {
        let ratio = |(a, b): (f64, &f64)| if a == 0.0 && *b == 0.0 { 0.0 } else { a / b };
        // Made conjugate to the last direction itself, so that rounding of the preconditioner to single precision does
        // no harm.
        let along = self.blocks.dots(&preconditioned, &self.moved);
        self.shares = along.into_iter().zip(&self.energies).map(|entry| -ratio(entry)).collect();
        let last = std::mem::replace(&mut self.direction, preconditioned);
        self.blocks.add(&mut self.direction, &self.shares, &last);
        self.moved = operator(&self.direction);
        self.energies = self.blocks.dots(&self.direction, &self.moved);
        let work = self.blocks.dots(&self.direction, &self.rest);
        let is_step = |(&work, &energy): (&f64, &f64)| {
            (work == 0.0 && energy == 0.0) || (energy > 0.0 && (work / energy).is_finite())
        };
        if !work.iter().zip(&self.energies).all(is_step) {
            return false;
        }
        self.lengths = work.into_iter().zip(&self.energies).map(ratio).collect();
        self.blocks.add(&mut self.solution, &self.lengths, &self.direction);
        let back: Vec<f64> = self.lengths.iter().map(|length| -length).collect();
        self.blocks.add(&mut self.rest, &back, &self.moved);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Springs of stiffness 4 and 1 and, in another block, one of `last`, under forces of 8, 3 and 5.
    fn stepped(last: f64, steps: usize) -> (Iterate<'static>, bool) {
        let blocks = Blocks { of_unknown: &[0, 0, 1], count: 2 };
        let mut iterate = Iterate::new(vec![0.0; 3], vec![8.0, 3.0, 5.0], blocks);
        let product = |p: &[f64]| vec![4.0 * p[0], p[1], last * p[2]];
        let is_step = (0..steps).all(|_| iterate.step(iterate.rest.clone(), product));
        (iterate, is_step)
    }

    #[test]
    fn every_block_is_solved_in_as_many_steps_as_it_has_eigenvalues_and_then_rests() {
        // The scales are powers of two, so that the second block ends exactly and rests in the second step.
        let (iterate, is_step) = stepped(2.0_f64.powi(-60), 2);
        assert!(is_step && iterate.lengths[1] == 0.0, "{iterate:?}");
        for (found, exact) in iterate.solution.iter().zip([2.0, 3.0, 5.0 * 2.0_f64.powi(60)]) {
            assert!((found / exact - 1.0).abs() < 1e-14, "{iterate:?}");
        }
    }

    #[test]
    fn a_block_without_positive_energy_ends_all_and_nothing_moves() {
        for last in [0.0, -1.0] {
            let (iterate, is_step) = stepped(last, 1);
            assert!(!is_step && iterate.solution == [0.0; 3] && iterate.energies[1] <= 0.0, "{iterate:?}");
        }
    }
}
