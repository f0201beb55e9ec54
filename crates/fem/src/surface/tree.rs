//! A tree of boxes around triangles, halved at the median along their longest extent; whether a surface is closed.

use super::facets::{Facets, Triangle};
use crate::error::Error;
use crate::geometry::{Around, distance, dot, length, midpoint, minus};
use robust::{Coord, orient2d};

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
pub struct Tree {
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
pub type Limits = [[f64; 3]; 2];

/// The limits of an empty set.
pub(super) const NOWHERE: Limits = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];

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
            let middle = midpoint(branch.low, branch.high);
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

// The crossings of a line along an axis with a surface, without leaks: the line is moved aside by two infinitely small
// steps, so that it meets no edge and no corner; the side of an edge on which it runs is decided exactly.

/// A crossing of a line with a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// The coordinate along the axis.
    pub at: f64,
    /// Change of the number of solids around the line at the crossing, in the direction of the axis: 1 into a solid, -1
    /// out of a solid.
    pub turns: i32,
}

impl ClosedSurface {
    /// The crossings of the line along `axis` through a point, increasing.
    #[doc(hidden)]
    pub fn crossings(&self, axis: usize, point: [f64; 3]) -> Vec<Crossing> {
        let (first, second) = ((axis + 1) % 3, (axis + 2) % 3);
        let across = |at: [f64; 3]| Coord { x: at[first], y: at[second] };
        let mut crossings = Vec::new();
        self.tree.along(axis, point, |triangle| {
            let corners = self.triangle(triangle).0;
            let sides = [0, 1, 2].map(|corner| {
                side(across(corners[(corner + 1) % 3]), across(corners[(corner + 2) % 3]), across(point))
            });
            let turns = match sides.map(|side| side.0) {
                [1, 1, 1] => -1,
                [-1, -1, -1] => 1,
                _ => return,
            };
            // The area on each side is the weight of the opposite corner.
            let sum: f64 = sides.iter().map(|side| side.1).sum();
            let share = |corner: usize| if sum == 0.0 { 0.0 } else { sides[corner].1 / sum };
            let [a, b, c] = corners.map(|corner| corner[axis]);
            crossings.push(Crossing { at: a + share(1) * (b - a) + share(2) * (c - a), turns });
        });
        crossings.sort_by(|a, b| a.at.total_cmp(&b.at));
        crossings
    }

    /// Returns `true` for a point inside a solid.
    pub(super) fn contains(&self, point: [f64; 3]) -> bool {
        // The choice of the axis does not matter.
        let before = self.crossings(2, point).into_iter().filter(|crossing| crossing.at < point[2]);
        before.map(|crossing| crossing.turns).sum::<i32>() > 0
    }
}

/// The side of the line from `a` to `b` on which the point lies after an infinitely small step along x and an
/// infinitely smaller step along y: 1 left, -1 right, 0 if `a` and `b` are the same; and twice the area of their
/// triangle before these steps.
fn side(a: Coord<f64>, b: Coord<f64>, point: Coord<f64>) -> (i32, f64) {
    let area = orient2d(a, b, point);
    let moved = if area != 0.0 {
        area
    } else if a.y != b.y {
        a.y - b.y
    } else {
        b.x - a.x
    };
    (i32::from(moved > 0.0) - i32::from(moved < 0.0), area)
}

/// A volume below this times area and extent is rounding: a sheet folded onto itself encloses no volume.
const NO_VOLUME: f64 = 1e-13;

/// The boundary of one solid or of several, made of triangles that leave no gap, so that each place is inside or
/// outside.
#[derive(Debug)]
pub struct ClosedSurface {
    vertices: Vec<[f64; 3]>,
    /// Counterclockwise seen from outside.
    corners: Vec<[u32; 3]>,
    /// The triangles around each vertex.
    around: Around,
    pub(super) tree: Tree,
}

impl ClosedSurface {
    /// Checks that the triangles form closed surfaces, reverses them if all run clockwise, and builds the tree.
    pub(super) fn new(mut facets: Facets) -> Result<Self, Error> {
        let of_triangles = facets.corners.iter().map(|corners| corners.map(|vertex| vertex as usize));
        let around = Around::new(facets.vertices.len(), of_triangles);
        check_edges(&facets, &around)?;
        let place = |corners: &[u32; 3]| Triangle(corners.map(|vertex| facets.vertices[vertex as usize]));
        let has_area = |&triangle: &u32| place(&facets.corners[triangle as usize]).area_normal() != [0.0; 3];
        let numbers: Vec<u32> = (0..facets.corners.len() as u32).filter(has_area).collect();
        if numbers.is_empty() {
            return Err(facets.fault(0, "it has no triangle with a positive area"));
        }
        let tree = Tree::new(&numbers, |triangle| limits(place(&facets.corners[triangle as usize])));
        let [low, high] = tree.limits();
        let (mut volume, mut area) = (0.0, 0.0);
        for triangle in numbers.iter().map(|&triangle| place(&facets.corners[triangle as usize])) {
            let normal = triangle.area_normal();
            volume += dot(normal, minus(triangle.0[0], low)) / 6.0;
            area += length(normal) / 2.0;
        }
        if volume.abs() <= NO_VOLUME * area * distance(low, high) {
            return Err(facets.fault(0, format!("it encloses no volume: {volume:.1e}, for an area of {area:.1e}")));
        }
        if volume < 0.0 {
            facets.corners.iter_mut().for_each(|corners| corners.swap(1, 2));
        }
        Ok(ClosedSurface { vertices: facets.vertices, corners: facets.corners, around, tree })
    }

    pub(super) fn triangle(&self, number: u32) -> Triangle {
        Triangle(self.corners_of(number).map(|vertex| self.vertices[vertex as usize]))
    }

    pub(super) fn corners_of(&self, number: u32) -> [u32; 3] {
        self.corners[number as usize]
    }

    pub(super) fn around(&self, vertex: u32) -> &[u32] {
        self.around.at(vertex as usize)
    }
}

fn limits(triangle: Triangle) -> Limits {
    triangle.0.into_iter().fold(NOWHERE, |sum, corner| joined(sum, [corner; 2]))
}

/// Edges with one kind of fault.
#[derive(Clone, Copy, Debug)]
struct Faulty {
    count: usize,
    first: Along,
}

/// A triangle along an edge: its number, and the corner at which its edge begins.
type Along = (u32, usize);

/// Every edge must join two triangles, in opposite directions.
fn check_edges(facets: &Facets, around: &Around) -> Result<(), Error> {
    let [mut open, mut crowded, mut alike]: [Option<Faulty>; 3] = [None; 3];
    let mut edges: Vec<(u32, Along)> = Vec::new();
    for vertex in 0..facets.vertices.len() as u32 {
        // An edge is counted at its end with the lower number, as the other end and a triangle along it. They are
        // sorted: the tip of a cone and copies of one triangle have very many.
        edges.clear();
        for &triangle in around.at(vertex as usize) {
            let corners = facets.corners[triangle as usize];
            for (corner, from) in corners.into_iter().enumerate() {
                let to = corners[(corner + 1) % 3];
                if from.min(to) == vertex {
                    edges.push((from.max(to), (triangle, corner)));
                }
            }
        }
        edges.sort_unstable();
        for of_edge in edges.chunk_by(|one, next| one.0 == next.0) {
            let begins = |&(_, (triangle, corner)): &(u32, Along)| facets.corners[triangle as usize][corner] == vertex;
            let away = of_edge.iter().filter(|&along| begins(along)).count();
            let kind = match (away, of_edge.len() - away) {
                (1, 1) => continue,
                (1, 0) | (0, 1) => &mut open,
                (2, 0) | (0, 2) => &mut alike,
                _ => &mut crowded,
            };
            let first = of_edge[0].1;
            let known = kind.get_or_insert(Faulty { count: 0, first });
            (known.count, known.first) = (known.count + 1, known.first.min(first));
        }
    }
    let edges = |count: usize| if count == 1 { "1 edge".into() } else { format!("{count} edges") };
    let (found, message) = match (open, crowded, alike) {
        (Some(found), _, _) => {
            let many = if found.count == 1 { "belongs" } else { "belong" };
            let message = format!(
                "the surface is not closed after vertices of equal coordinates are merged: {} {many} to one \
                 triangle only, but an obstacle needs an inside",
                edges(found.count)
            );
            (found, message)
        }
        (None, Some(found), _) => (
            found,
            "more than two triangles meet at an edge, so that inside and outside cannot be distinguished".into(),
        ),
        (None, None, Some(found)) => {
            let message = format!(
                "triangles on both sides of {} run along them in the same direction, so that one triangle faces \
                 inwards; orient all triangles alike",
                edges(found.count)
            );
            (found, message)
        }
        (None, None, None) => return Ok(()),
    };
    let (triangle, corner) = (found.first.0 as usize, found.first.1);
    let corners = facets.corners[triangle];
    let [from, to] = [corners[corner], corners[(corner + 1) % 3]].map(|vertex| facets.vertices[vertex as usize]);
    let message = format!("{message}; the first runs from {from:?} to {to:?} at the triangle that begins here");
    Err(facets.fault(facets.place(triangle), message))
}
