//! Kinds of stiffness matrices.

use super::Draws;

type Matrix = Vec<Vec<f64>>;

/// Makes a matrix of random size.
type Make = fn(&mut Draws) -> Matrix;

/// Every kind of stiffness with its name.
pub const KINDS: [(&str, Make); 23] = [
    ("identity", identity),
    ("contrast", contrast),
    ("spd", dense),
    ("integer", integer),
    ("integer-deficient", integer_deficient),
    ("springs", springs),
    ("springs-weak", springs_weak),
    ("springs-floating", springs_floating),
    ("scaled-dofs", dense),
    ("string", string),
    ("membrane", membrane),
    ("plate", plate),
    ("plate-floating", plate_floating),
    ("strip", strip),
    ("beam", beam),
    ("parts", parts),
    ("parts-floating", parts_floating),
    ("zero-diagonal", zero_diagonal),
    ("zero", zero),
    ("nearly-singular", nearly_singular),
    ("indefinite", indefinite),
    ("arrow", arrow),
    ("bodies", bodies),
];

/// Random numbers of a problem.
impl Draws {
    /// The numbers of problem `number` of a seed.
    pub fn of(seed: u64, number: u64) -> Self {
        let mixed = Draws(seed).below(usize::MAX >> 1) as u64;
        let mut draws = Draws(mixed ^ number.wrapping_mul(0xd134_2543_de82_ef95));
        draws.below(2);
        draws
    }

    pub fn one_in(&mut self, n: usize) -> bool {
        self.below(n) == 0
    }

    pub fn pick<T: Clone>(&mut self, from: &[T]) -> T {
        from[self.below(from.len())].clone()
    }

    /// An integer between two bounds, both included.
    pub fn between(&mut self, low: i32, high: i32) -> i32 {
        low + self.below((high - low + 1) as usize) as i32
    }

    /// A number between two bounds; every decade is equally likely.
    pub fn decades(&mut self, low: f64, high: f64) -> f64 {
        let part = 0.5 + 0.5 * self.signed();
        low * (high / low).powf(part)
    }

    /// A positive number with few bits, between about 2^low and 2^high.
    pub fn short(&mut self, low: i32, high: i32) -> f64 {
        f64::from(self.between(1, 15)) * 2.0_f64.powi(self.between(low, high) - 3)
    }
}

fn square(n: usize) -> Matrix {
    vec![vec![0.0; n]; n]
}

fn size(draws: &mut Draws) -> usize {
    1 + draws.below(8)
}

/// A random size, sometimes larger.
fn size_of_network(draws: &mut Draws) -> usize {
    if draws.one_in(12) { 9 + draws.below(16) } else { 1 + draws.below(8) }
}

/// `A A'` summed in order, so that both triangles agree.
fn gram(a: &Matrix) -> Matrix {
    let product = |i: usize, j: usize| a[i].iter().zip(&a[j]).map(|(x, y)| x * y).sum();
    (0..a.len()).map(|i| (0..a.len()).map(|j| product(i, j)).collect()).collect()
}

fn identity(draws: &mut Draws) -> Matrix {
    let mut k = square(size(draws));
    (0..k.len()).for_each(|i| k[i][i] = 1.0);
    k
}

/// A diagonal with ratios of 1e3 to 1e9.
fn contrast(draws: &mut Draws) -> Matrix {
    let (mut k, span) = (square(size(draws)), draws.decades(1e3, 1e9));
    (0..k.len()).for_each(|i| k[i][i] = if draws.one_in(3) { 1.0 / span } else { draws.decades(1.0 / span, 1.0) });
    k
}

fn dense(draws: &mut Draws) -> Matrix {
    let n = size(draws);
    let a: Matrix = (0..n).map(|_| (0..n).map(|_| draws.signed()).collect()).collect();
    let (mut k, ground) = (gram(&a), draws.decades(1e-3, 1.0));
    (0..n).for_each(|i| k[i][i] += ground);
    k
}

fn whole(draws: &mut Draws, n: usize, rank: usize) -> Matrix {
    (0..n).map(|_| (0..rank).map(|_| f64::from(draws.between(-3, 3))).collect()).collect()
}

fn integer(draws: &mut Draws) -> Matrix {
    let n = size(draws);
    let mut k = gram(&whole(draws, n, n));
    (0..n).for_each(|i| k[i][i] += 1.0);
    k
}

fn integer_deficient(draws: &mut Draws) -> Matrix {
    let n = 2 + draws.below(6);
    let rank = 1 + draws.below(n - 1);
    gram(&whole(draws, n, rank))
}

fn add_spring(k: &mut Matrix, i: usize, j: usize, spring: f64) {
    k[i][i] += spring;
    k[j][j] += spring;
    k[i][j] -= spring;
    k[j][i] -= spring;
}

/// Springs between dofs `from..to`: a chain and a few more.
fn connect(k: &mut Matrix, draws: &mut Draws, from: usize, to: usize, spring: fn(&mut Draws) -> f64) {
    for i in from + 1..to {
        let before = from + draws.below(i - from);
        let value = spring(draws);
        add_spring(k, i, before, value);
        let other = from + draws.below(i - from);
        if other != before {
            let value = spring(draws);
            add_spring(k, i, other, value);
        }
    }
}

fn spring(draws: &mut Draws) -> f64 {
    draws.decades(1e-2, 1e2)
}

fn short_spring(draws: &mut Draws) -> f64 {
    draws.short(-6, 6)
}

fn springs(draws: &mut Draws) -> Matrix {
    let n = size_of_network(draws);
    let mut k = square(n);
    connect(&mut k, draws, 0, n, spring);
    (0..n).for_each(|i| {
        if i == 0 || draws.one_in(3) {
            k[i][i] += spring(draws)
        }
    });
    k
}

/// A network of which one part is held only by a spring of 1e-6.
fn springs_weak(draws: &mut Draws) -> Matrix {
    let n = 1 + size_of_network(draws);
    let (mut k, middle) = (square(n), 1 + draws.below(n - 1));
    connect(&mut k, draws, 0, middle, spring);
    connect(&mut k, draws, middle, n, spring);
    k[0][0] += spring(draws);
    k[middle][middle] += 1e-6;
    k
}

/// Networks of two parts, most of these without a spring to the ground; their numbers have so few bits that every sum
/// is exact.
fn springs_floating(draws: &mut Draws) -> Matrix {
    let n = 2 + draws.below(7);
    let (mut k, middle) = (square(n), 1 + draws.below(n));
    connect(&mut k, draws, 0, middle, short_spring);
    connect(&mut k, draws, middle.min(n), n, short_spring);
    if draws.one_in(3) {
        k[0][0] += short_spring(draws);
    }
    k
}

fn string(draws: &mut Draws) -> Matrix {
    let (n, tension) = (2 + draws.below(11), if draws.one_in(2) { 1.0 } else { draws.decades(1e-3, 1e3) });
    let mut k = square(n);
    (1..n).for_each(|i| add_spring(&mut k, i, i - 1, tension));
    k[0][0] += tension;
    k[n - 1][n - 1] += if draws.one_in(2) { tension } else { 0.0 };
    k
}

/// The five-point Laplacian, clamped all around.
fn membrane(draws: &mut Draws) -> Matrix {
    let most = if draws.one_in(12) { 5 } else { 2 };
    let (across, along) = (2 + draws.below(most), 2 + draws.below(most + 1));
    let n = across * along;
    let mut k = square(n);
    let right = (0..n).filter(|i| i % across + 1 < across).map(|i| (i, i + 1));
    for (i, j) in right.chain((0..n - across).map(|i| (i, i + across))) {
        k[i][j] = -1.0;
        k[j][i] = -1.0;
    }
    (0..n).for_each(|i| k[i][i] = 4.0);
    k
}

/// A four-node element a x b in plane stress, with Young's modulus 1 and Poisson's ratio nu, times `1 - nu^2`.
fn quad(a: f64, b: f64, nu: f64) -> [[f64; 8]; 8] {
    let (mut k, at) = ([[0.0; 8]; 8], 1.0 / 3.0_f64.sqrt());
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    for (x, y) in corners.map(|(x, y)| (x * at, y * at)) {
        let slopes = corners.map(|(p, q)| (p * (1.0 + q * y) / (2.0 * a), q * (1.0 + p * x) / (2.0 * b)));
        for i in 0..4 {
            for j in 0..4 {
                let ((xi, yi), (xj, yj), part) = (slopes[i], slopes[j], a * b / 4.0);
                k[2 * i][2 * j] += part * (xi * xj + (1.0 - nu) / 2.0 * yi * yj);
                k[2 * i][2 * j + 1] += part * (nu * xi * yj + (1.0 - nu) / 2.0 * yi * xj);
                k[2 * i + 1][2 * j] += part * (nu * yi * xj + (1.0 - nu) / 2.0 * xi * yj);
                k[2 * i + 1][2 * j + 1] += part * (yi * yj + (1.0 - nu) / 2.0 * xi * xj);
            }
        }
    }
    k
}

/// A plate of `across` x `along` equal elements; the nodes at the left end are clamped.
fn elements(along: usize, across: usize, element: &[[f64; 8]; 8], clamped: bool) -> Matrix {
    let dof = |i: usize, j: usize| 2 * (i * (across + 1) + j);
    let mut k = square(2 * (along + 1) * (across + 1));
    for i in 0..along {
        for j in 0..across {
            let dofs: Vec<usize> = [dof(i, j), dof(i + 1, j), dof(i + 1, j + 1), dof(i, j + 1)]
                .iter()
                .flat_map(|&at| [at, at + 1])
                .collect();
            for (p, &at) in dofs.iter().enumerate() {
                for (q, &to) in dofs.iter().enumerate() {
                    // Makes the rounding in both triangles equal.
                    k[at][to] += element[p.max(q)][p.min(q)];
                }
            }
        }
    }
    let from = if clamped { 2 * (across + 1) } else { 0 };
    k[from..].iter().map(|line| line[from..].to_vec()).collect()
}

fn plate(draws: &mut Draws) -> Matrix {
    let (along, across) = draws.pick(&[(1, 1), (2, 1), (1, 2), (2, 2)]);
    elements(along, across, &quad(1.0, draws.decades(0.5, 2.0), 0.3), true)
}

/// One square element with Poisson's ratio 1/4, times 24: every entry is a multiple of 1/4.
fn plate_floating(draws: &mut Draws) -> Matrix {
    let quarters = quad(1.0, 1.0, 0.25).map(|line| line.map(|value| (96.0 * value).round() / 4.0));
    let mut k = elements(1, 1, &quarters, false);
    // Some bodies are supported at a node, along one axis or both.
    let held = draws.below(3);
    k.truncate(8 - held);
    k.iter_mut().for_each(|line| line.truncate(8 - held));
    k
}

/// A cantilever one element high and 10 to 100 heights long.
fn strip(draws: &mut Draws) -> Matrix {
    let (along, slender) = (2 + draws.below(3), draws.decades(10.0, 100.0));
    elements(along, 1, &quad(slender / along as f64, 1.0, 0.3), true)
}

/// A clamped Euler-Bernoulli beam, with deflection and slope at each node.
fn beam(draws: &mut Draws) -> Matrix {
    let (elements, length) = (1 + draws.below(5), draws.decades(1e-2, 1e2));
    let mut k = square(2 * (elements + 1));
    let l = length / elements as f64;
    let entries = [
        [12.0, 6.0 * l, -12.0, 6.0 * l],
        [6.0 * l, 4.0 * l * l, -6.0 * l, 2.0 * l * l],
        [-12.0, -6.0 * l, 12.0, -6.0 * l],
        [6.0 * l, 2.0 * l * l, -6.0 * l, 4.0 * l * l],
    ];
    for element in 0..elements {
        for (i, line) in entries.iter().enumerate() {
            line.iter().enumerate().for_each(|(j, value)| k[2 * element + i][2 * element + j] += value / (l * l * l));
        }
    }
    k[2..].iter().map(|line| line[2..].to_vec()).collect()
}

/// Joins matrices as the blocks of a diagonal.
fn blocks(parts: Vec<Matrix>) -> Matrix {
    let mut k = square(parts.iter().map(Vec::len).sum());
    let mut from = 0;
    for part in parts {
        for (i, line) in part.iter().enumerate() {
            k[from + i][from..from + line.len()].copy_from_slice(line);
        }
        from += part.len();
    }
    k
}

fn scaled(mut k: Matrix, factor: f64) -> Matrix {
    k.iter_mut().flatten().for_each(|value| *value *= factor);
    k
}

/// Two to four small bodies of different stiffness.
fn parts(draws: &mut Draws) -> Matrix {
    let part = |draws: &mut Draws| {
        let (n, scale) = (1 + draws.below(3), draws.pick(&[1.0, 1.0, 1e-6, 1e-12, 1e-20]));
        let mut k = square(n);
        connect(&mut k, draws, 0, n, short_spring);
        k[0][0] += short_spring(draws);
        scaled(k, scale)
    };
    blocks((0..2 + draws.below(3)).map(|_| part(draws)).collect())
}

/// Parts with stiffnesses that are powers of two; some are held by contact only.
fn parts_floating(draws: &mut Draws) -> Matrix {
    let part = |draws: &mut Draws| {
        let (n, scale) = (1 + draws.below(3), 2.0_f64.powi(-draws.pick(&[0, 0, 20, 40, 66])));
        let mut k = square(n);
        connect(&mut k, draws, 0, n, short_spring);
        if draws.one_in(2) {
            k[0][0] += short_spring(draws);
        }
        scaled(k, scale)
    };
    blocks((0..2 + draws.below(3)).map(|_| part(draws)).collect())
}

fn zero_diagonal(draws: &mut Draws) -> Matrix {
    let (n, empty) = (1 + draws.below(4), 1 + draws.below(3));
    let mut k = square(n);
    (0..n).for_each(|i| k[i][i] = draws.short(-3, 3));
    if draws.one_in(2) {
        k = gram(&whole(draws, n, n));
        (0..n).for_each(|i| k[i][i] += 1.0);
    }
    blocks(vec![k, square(empty)])
}

fn zero(draws: &mut Draws) -> Matrix {
    square(1 + draws.below(4))
}

/// `A A'` with one column of A scaled by 2^-10 to 2^-18.
fn nearly_singular(draws: &mut Draws) -> Matrix {
    let n = 2 + draws.below(5);
    let (mut a, small) = (whole(draws, n, n), 2.0_f64.powi(-draws.between(10, 18)));
    a.iter_mut().for_each(|line| line[n - 1] *= small);
    let mut k = gram(&a);
    // A column that depends on others gives a null space, which a weak spring to the ground mostly removes.
    if draws.one_in(2) {
        (0..n).for_each(|i| k[i][i] += small * small);
    }
    k
}

/// A singular matrix minus 2^-10 to 2^-4 of its diagonal.
fn indefinite(draws: &mut Draws) -> Matrix {
    let mut k = integer_deficient(draws);
    let less = 2.0_f64.powi(-draws.between(4, 10));
    (0..k.len()).for_each(|i| k[i][i] -= less * k[i][i].min(8.0));
    k
}

fn arrow(draws: &mut Draws) -> Matrix {
    let n = 2 + draws.below(7);
    let mut k = square(n);
    for i in 1..n {
        let (own, across) = (draws.decades(1e-2, 1e2), draws.signed());
        k[i][i] = own;
        k[0][i] = across;
        k[i][0] = across;
        k[0][0] += across * across / own;
    }
    k[0][0] += draws.decades(1e-3, 1.0);
    k
}

/// Two or three chains, the first grounded; their numbers have so few bits that every sum is exact.
fn bodies(draws: &mut Draws) -> Matrix {
    let body = |draws: &mut Draws, grounded: bool| {
        let n = 1 + draws.below(4);
        let mut k = square(n);
        connect(&mut k, draws, 0, n, short_spring);
        k[0][0] += if grounded { short_spring(draws) } else { 0.0 };
        k
    };
    let first = body(draws, true);
    let others = (0..1 + draws.below(2)).map(|_| body(draws, false)).collect();
    blocks([vec![first], others].concat())
}
