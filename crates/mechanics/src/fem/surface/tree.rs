//! A tree of boxes around triangles, halved at the median along their longest extent.

use crate::fem::geometry::{distance, dot, length, minus};

/// Triangles of a leaf: with fewer triangles more boxes are tested than triangles are saved.
const LEAF: usize = 4;

/// A box around items, and its content.
#[derive(Clone, Copy, Debug)]
struct Branch {
    low: [f64; 3],
    high: [f64; 3],
    /// In a leaf the index of its first item in the order; else the index of its second half. The first half follows
    /// directly.
    next: u32,
    /// Number of items of a leaf; zero for a branch with halves.
    count: u32,
}

#[derive(Debug)]
pub(crate) struct Tree {
    branches: Vec<Branch>,
    order: Vec<u32>,
}

/// An item while the tree is built: the middle of its box, relative to the box of all.
#[derive(Clone, Copy, Debug)]
struct Thing {
    middle: [f32; 3],
    number: u32,
}

/// Lowest and highest coordinates.
pub(crate) type Limits = [[f64; 3]; 2];

/// The limits of an empty set.
pub(super) const NOWHERE: Limits = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];

/// The limits of both.
pub(super) fn joined(a: Limits, b: Limits) -> Limits {
    [[0, 1, 2].map(|axis| a[0][axis].min(b[0][axis])), [0, 1, 2].map(|axis| a[1][axis].max(b[1][axis]))]
}

impl Tree {
    pub fn new(numbers: &[u32], limits: impl Fn(u32) -> Limits) -> Self {
        let [low, high] = numbers.iter().fold(NOWHERE, |sum, &number| joined(sum, limits(number)));
        let widest = (0..3).map(|axis| high[axis] - low[axis]).fold(f64::MIN_POSITIVE, f64::max);
        let thing = |&number: &u32| {
            let [from, to] = limits(number);
            Thing {
                middle: [0, 1, 2].map(|axis| (((from[axis] + to[axis]) / 2.0 - low[axis]) / widest) as f32),
                number,
            }
        };
        let mut things: Vec<Thing> = numbers.iter().map(thing).collect();
        let mut tree = Tree { branches: Vec::new(), order: Vec::with_capacity(numbers.len()) };
        tree.grow(&mut things, &limits);
        tree
    }

    /// Adds the branch of these items, and returns its limits. The median halves the items, so that the depth is small.
    fn grow(&mut self, things: &mut [Thing], limits: &impl Fn(u32) -> Limits) -> Limits {
        let own = self.branches.len();
        let first = self.order.len() as u32;
        self.branches.push(Branch { low: [0.0; 3], high: [0.0; 3], next: first, count: things.len() as u32 });
        let [low, high] = if things.len() <= LEAF {
            self.order.extend(things.iter().map(|thing| thing.number));
            things.iter().fold(NOWHERE, |sum, thing| joined(sum, limits(thing.number)))
        } else {
            let (mut from, mut to) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
            for thing in things.iter() {
                from = [0, 1, 2].map(|axis| from[axis].min(thing.middle[axis]));
                to = [0, 1, 2].map(|axis| to[axis].max(thing.middle[axis]));
            }
            let wide = |axis: usize| to[axis] - from[axis];
            let axis = (1..3).fold(0, |widest, axis| if wide(axis) > wide(widest) { axis } else { widest });
            let half = things.len() / 2;
            things.select_nth_unstable_by(half, |a, b| a.middle[axis].total_cmp(&b.middle[axis]));
            let (before, after) = things.split_at_mut(half);
            let first = self.grow(before, limits);
            (self.branches[own].next, self.branches[own].count) = (self.branches.len() as u32, 0);
            joined(first, self.grow(after, limits))
        };
        (self.branches[own].low, self.branches[own].high) = (low, high);
        [low, high]
    }

    pub fn limits(&self) -> Limits {
        self.branches.first().map_or(NOWHERE, |all| [all.low, all.high])
    }

    /// Visits the things near a point, roughly from near to far; `visit` returns the squared distance beyond which the
    /// remaining items do not matter.
    pub fn near(&self, point: [f64; 3], mut visit: impl FnMut(u32) -> f64) {
        let mut reach = f64::INFINITY;
        let far = |place: usize| self.branches[place].squared_distance(point);
        let mut open = vec![(0, far(0))];
        while let Some((place, distance)) = open.pop() {
            if distance > reach {
                continue;
            }
            let branch = self.branches[place];
            for &number in self.things(branch) {
                reach = visit(number);
            }
            if branch.count == 0 {
                let halves = [place + 1, branch.next as usize].map(|half| (half, far(half)));
                let [nearer, farther] = if halves[1].1 < halves[0].1 { [halves[1], halves[0]] } else { halves };
                open.extend([farther, nearer]);
            }
        }
    }

    /// Visits all items whose boxes a line along `axis` through a point meets.
    pub fn along(&self, axis: usize, point: [f64; 3], mut visit: impl FnMut(u32)) {
        let across = [(axis + 1) % 3, (axis + 2) % 3];
        let mut open = vec![0];
        while let Some(place) = open.pop() {
            let branch = self.branches[place];
            if across.iter().any(|&axis| point[axis] < branch.low[axis] || point[axis] > branch.high[axis]) {
                continue;
            }
            self.things(branch).iter().for_each(|&number| visit(number));
            if branch.count == 0 {
                open.extend([place + 1, branch.next as usize]);
            }
        }
    }

    /// Visits all items whose boxes may lie in a cone: within `radius` of a line through `point` along a unit vector,
    /// more by `spread` per distance from the point, and at most `reach` away along the line. It may visit items
    /// outside.
    pub fn around_line(
        &self,
        point: [f64; 3],
        along: [f64; 3],
        [radius, spread, reach]: [f64; 3],
        mut visit: impl FnMut(u32),
    ) {
        // A tree without items has a branch without halves.
        let mut open = if self.order.is_empty() { Vec::new() } else { vec![0] };
        while let Some(place) = open.pop() {
            let branch = self.branches[place];
            let middle = [0, 1, 2].map(|axis| (branch.low[axis] + branch.high[axis]) / 2.0);
            let half = distance(branch.high, middle);
            let away = minus(middle, point);
            let far = dot(away, along);
            let aside = length(minus(away, along.map(|part| far * part)));
            if far.abs() > reach + radius + half || aside > radius + half + spread * (far.abs() + half) {
                continue;
            }
            self.things(branch).iter().for_each(|&number| visit(number));
            if branch.count == 0 {
                open.extend([place + 1, branch.next as usize]);
            }
        }
    }

    /// The items of a leaf; empty for a branch with halves.
    fn things(&self, branch: Branch) -> &[u32] {
        let (first, count) = (branch.next as usize, branch.count as usize);
        if count == 0 { &[] } else { &self.order[first..first + count] }
    }
}

impl Branch {
    fn squared_distance(&self, point: [f64; 3]) -> f64 {
        let beyond = [0, 1, 2].map(|axis| (self.low[axis] - point[axis]).max(point[axis] - self.high[axis]).max(0.0));
        beyond.iter().map(|part| part * part).sum()
    }
}
