//! Random contact problems from a seed.

use signorini::ContactProblem;

use crate::problems::of_entries;

/// A chain of springs with springs to the ground, of random stiffness, and contact rows, some inclined, on random
/// nodes.
pub fn springs(seed: u64) -> ContactProblem {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut random = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let dofs = 4 + (random() * 30.0) as usize;
    let mut entries = Vec::new();
    for dof in 0..dofs {
        entries.push((dof, dof, 0.01 + random()));
        if dof > 0 {
            let spring = 10_f64.powf(4.0 * random() - 1.0);
            entries.extend([(dof, dof, spring), (dof - 1, dof - 1, spring), (dof, dof - 1, -spring)]);
        }
    }
    let load = (0..dofs).map(|_| 4.0 * random() - 1.0).collect();
    let rows = 1 + (random() * dofs as f64 * 0.8) as usize;
    let (mut contact, mut gap) = (Vec::new(), Vec::new());
    for row in 0..rows {
        let dof = (random() * dofs as f64) as usize;
        contact.push((row, dof, 1.0));
        if random() < 0.3 {
            contact.push((row, (dof + 1) % dofs, random() - 0.5));
        }
        gap.push(random() - 0.3);
    }
    of_entries(&entries, load, &contact, gap)
}

/// A chain of 30 to 250 springs with springs to the ground, and rows that keep dofs apart: most of them neighbours.
pub fn stacked(seed: u64) -> ContactProblem {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut random = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let dofs = 30 + (random() * 221.0) as usize;
    let mut entries = Vec::new();
    for dof in 0..dofs {
        entries.push((dof, dof, 1e-3 + random()));
        if dof > 0 {
            let spring = 10_f64.powf(4.0 * random() - 2.0);
            entries.extend([(dof, dof, spring), (dof - 1, dof - 1, spring), (dof, dof - 1, -spring)]);
        }
    }
    let load = (0..dofs).map(|dof| if 2 * dof < dofs { random() } else { -random() }).collect();
    let (mut contact, mut gap) = (Vec::new(), Vec::new());
    for dof in 1..dofs {
        let other = if random() < 0.8 { dof - 1 } else { (random() * dof as f64) as usize };
        contact.extend([(dof - 1, other, 1.0), (dof - 1, dof, -1.0)]);
        gap.push(if random() < 0.3 { 0.0 } else { 0.1 * random() });
    }
    of_entries(&entries, load, &contact, gap)
}
