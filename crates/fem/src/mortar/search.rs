//! The search: what each facet of the slave surface shares with the master surface, and the master nodes that face the
//! slave surface.

use std::collections::{BTreeMap, BTreeSet};

use super::coverage::{Covered, MOST, Shared};
use super::data::{Mortar, MortarRow, Opposite};
use super::face::Projected;
use super::facet::{self, PlacedFacet, SharedPoint, SurfaceMesh};
use super::line;
use super::skin::Curve;
use crate::element::{MAX_NODES, PerNode, positive_coefficient, positive_functions};
use crate::geometry::{dot, length, minus, shifted, unit};
use crate::surface::Tree;

/// A place outside a facet by less than this, in reference coordinates, is on its edge.
const SAME_PLACE: f64 = 1e-9;

/// Steps to the point at which a line meets a curve.
const MEETING_STEPS: usize = 3;

/// The facets of both surfaces, and the mean outward unit normals at the nodes of each.
pub(super) struct BothSurfaces<'a> {
    pub slave: Vec<PlacedFacet<'a>>,
    pub master: Vec<PlacedFacet<'a>>,
    pub normals: [Vec<[f64; 3]>; 2],
}

impl<'a> BothSurfaces<'a> {
    pub fn of(mortar: &Mortar<'a>) -> Self {
        let [slave, master] = [mortar.slave, mortar.master].map(|surface| {
            let facets = surface.facets.chunks_exact(surface.kind.nodes());
            facets.map(|nodes| PlacedFacet::new(&surface, nodes)).collect::<Vec<_>>()
        });
        let normals = [normals(&mortar.slave, &slave), normals(&mortar.master, &master)];
        BothSurfaces { slave, master, normals }
    }

    /// The larger sag of both.
    pub fn sag(&self) -> f64 {
        let [own, others] = &self.normals;
        facet::sag(&self.slave, own).max(facet::sag(&self.master, others))
    }

    /// Returns `true` if straight facets stand for curves.
    pub fn has_curves(&self) -> bool {
        self.sag() > 0.0
    }

    /// The facets of both surfaces without those that see nothing and turn away from a neighbour that does: their
    /// normals would bend those of the nodes that the two share. `None` without such a facet.
    pub fn without_turned_away(&self, covered: &[Covered], met: &BTreeSet<u32>) -> Option<[Vec<usize>; 2]> {
        let sees = |facet: usize| covered[facet].is_covered();
        let kept = [
            kept(&self.slave, self.normals[0].len(), sees),
            kept(&self.master, self.normals[1].len(), |facet| met.contains(&(facet as u32))),
        ];
        let is_whole = kept[0].len() == self.slave.len() && kept[1].len() == self.master.len();
        (!is_whole).then(|| kept.map(|facets| facets.into_iter().flat_map(|facet| facet.nodes).copied().collect()))
    }

    /// The boxes around the master facets.
    fn tree(&self) -> Tree {
        let numbers: Vec<u32> = (0..self.master.len() as u32).collect();
        Tree::new(&numbers, |number| {
            let facet = &self.master[number as usize];
            let [low, high] = [f64::min, f64::max].map(|pick| {
                [0, 1, 2].map(|axis| facet.places().iter().map(|place| place[axis]).reduce(pick).unwrap_or(0.0))
            });
            // A curved edge leaves the box of its nodes.
            [low.map(|at| at - facet.radius / 4.0), high.map(|at| at + facet.radius / 4.0)]
        })
    }
}

/// A slave facet as the other surface is seen from it.
struct FacetView<'f> {
    facet: &'f PlacedFacet<'f>,
    /// Unit vectors out of the body, of the facet and at its nodes.
    direction: [f64; 3],
    directions: Vec<[f64; 3]>,
    /// A face in space with its plane.
    projected: Option<Projected<'f>>,
}

impl<'f> FacetView<'f> {
    fn new(facet: &'f PlacedFacet<'f>, given: Option<[f64; 3]>, normals: &[[f64; 3]]) -> Self {
        let direction = given.unwrap_or(facet.normal);
        let directions = facet.nodes.iter().map(|&node| given.unwrap_or(normals[node])).collect();
        let is_edge = facet.reference().dimension == 1;
        FacetView { facet, direction, directions, projected: (!is_edge).then(|| Projected::new(facet, direction)) }
    }

    /// The numbers of the master facets that may face it within reach.
    fn near(&self, tree: &Tree, reach: f64) -> Vec<u32> {
        let mut near = Vec::new();
        if dot(self.direction, self.facet.normal) > 0.0 {
            let spread = self.directions.iter().fold(0.0, |spread: f64, &way| {
                let along = dot(way, self.direction);
                spread.max(length(minus(way, self.direction.map(|part| along * part))) / along.max(0.1))
            });
            let cone = [self.facet.radius, spread, reach];
            tree.around_line(self.facet.middle, self.direction, cone, |number| near.push(number));
            near.sort_unstable();
        }
        near
    }

    /// The place of the facet that a point faces, if it faces it within reach.
    fn opposite(&self, node: usize, place: [f64; 3], reach: f64) -> Option<Opposite> {
        let (facet, directions) = (self.facet, &self.directions);
        let found = match &self.projected {
            None => line::foot(facet, directions, place),
            Some(face) => face.foot(place),
        };
        let at = found.filter(|&at| facet.reference().contains(at, SAME_PLACE))?;
        let shape = (facet.reference().shape)(at);
        let sum = |value: &dyn Fn(usize) -> [f64; 3]| {
            (0..facet.nodes.len()).fold([0.0; 3], |sum, local| {
                let value = value(local);
                shifted(sum, shape[local], value)
            })
        };
        let normal = unit(sum(&|local| directions[local]));
        let gap = dot(minus(place, sum(&|local| facet.places()[local])), normal);
        let slave = facet.nodes.iter().copied().zip(shape).collect();
        (gap.abs() <= reach).then_some(Opposite { node, slave, normal, gap })
    }
}

/// The distances of slave nodes from the curve for which the master facets stand that cover the slave surface.
pub(super) struct Distances<'a> {
    slave: &'a [[f64; 3]],
    sides: &'a BothSurfaces<'a>,
    /// The numbers of these facets.
    met: &'a BTreeSet<u32>,
    tree: Tree,
    curve: Curve<'a>,
    reach: f64,
}

impl<'a> Distances<'a> {
    pub fn of(mortar: &Mortar<'a>, sides: &'a BothSurfaces<'a>, met: &'a BTreeSet<u32>) -> Self {
        let curve = Curve::of(&mortar.master, &sides.master, &sides.normals[1]);
        Distances { slave: mortar.slave.nodes, sides, met, tree: sides.tree(), curve, reach: mortar.reach }
    }

    /// The gap of a row by the distances of its slave nodes, which lie on their curve; `None` if the curve ends before
    /// one of them. `ends` are those of the edges of nodes that have coefficients.
    pub fn of_row(&self, row: &MortarRow, ends: &[Option<[usize; 2]>]) -> Option<f64> {
        let distance = |node: usize| self.along(self.slave[node], row.normal);
        let mut gap = 0.0;
        for &(node, share) in &row.slave {
            let own = distance(node)?;
            gap += share
                * match ends[node] {
                    Some([a, b]) => positive_coefficient(own, [distance(a)?, distance(b)?]),
                    None => own,
                };
        }
        Some(gap)
    }

    /// The distance of a point from the curve along a direction.
    fn along(&self, from: [f64; 3], way: [f64; 3]) -> Option<f64> {
        let back = way.map(|part| 0.0 - part);
        let mut near = Vec::new();
        self.tree.around_line(from, way, [0.0, 0.0, self.reach], |number| near.push(number));
        near.retain(|number| self.met.contains(number));
        near.sort_unstable();
        let distance = |number: u32| {
            let facet = &self.sides.master[number as usize];
            let turned = dot(facet.normal, back);
            if turned <= 0.0 {
                return None;
            }
            let met = FacetView::new(facet, Some(back), &self.sides.normals[1]).opposite(0, from, self.reach)?;
            let across = FacetView::new(facet, Some(facet.normal), &self.sides.normals[1]);
            // The line meets the curve above another point of the facet than the facet itself.
            let mut gap = met.gap;
            for _ in 0..MEETING_STEPS {
                let at = shifted(from, gap, way);
                let below = across.opposite(0, at, f64::INFINITY).unwrap_or_else(|| met.clone());
                let mut shape: PerNode<f64> = [0.0; MAX_NODES];
                shape.iter_mut().zip(&below.slave).for_each(|(value, entry)| *value = entry.1);
                gap = met.gap - self.curve.beyond(facet, &shape) / turned;
            }
            Some(gap)
        };
        near.into_iter().filter_map(distance).min_by(|a, b| a.abs().total_cmp(&b.abs()))
    }
}

/// What both surfaces see of each other.
pub(super) struct Sight<'f> {
    /// The integrals over the covered part of every slave facet.
    pub covered: Vec<Covered<'f>>,
    /// The nearest place of the slave surface for each master node.
    pub opposite: Vec<Opposite>,
    /// The numbers of the master facets that cover slave facets.
    pub met: BTreeSet<u32>,
}

impl Mortar<'_> {
    /// What the surfaces see of each other within reach, with nothing solid between.
    pub(super) fn sight<'f>(&self, sides: &'f BothSurfaces<'f>) -> Sight<'f> {
        let (tree, mut all_met) = (sides.tree(), BTreeSet::new());
        let is_clear = |[from, to]: [[f64; 3]; 2], outward: [f64; 3]| {
            self.between.is_none_or(|between| between.is_clear(from, to, outward))
        };
        let can_touch = |one: &Shared, outward: [f64; 3]| {
            let [from, to] = one.middles();
            self.between.is_none_or(|between| between.can_touch(from, to, outward))
        };
        let mut nearest: BTreeMap<usize, Opposite> = BTreeMap::new();
        let mut all = Vec::with_capacity(sides.slave.len());
        for facet in &sides.slave {
            let site = FacetView::new(facet, self.direction, &sides.normals[0]);
            let mut covered = self.whole(&site);
            let (mut met, mut shared) = (BTreeSet::new(), Vec::new());
            let near = site.near(&tree, self.reach).into_iter().map(|number| (number, &sides.master[number as usize]));
            for (number, other) in near.filter(|(_, other)| facet.faces(other)) {
                let found = self.shared(&site, other);
                if found.as_ref().is_some_and(|one| !can_touch(one, site.direction)) {
                    continue;
                }
                all_met.extend(found.iter().map(|_| number));
                shared.extend(found);
                for (&node, &place) in other.nodes.iter().zip(other.places()) {
                    let found = met.insert(node).then(|| site.opposite(node, place, self.reach)).flatten();
                    let Some(found) = found else { continue };
                    let is_nearest = nearest.get(&node).is_none_or(|nearest| found.gap.abs() < nearest.gap.abs());
                    let foot = shifted(place, -found.gap, found.normal);
                    if is_nearest && is_clear([foot, place], found.normal) {
                        nearest.insert(node, found);
                    }
                }
            }
            covered.add(shared);
            all.push(covered);
        }
        Sight { covered: all, opposite: nearest.into_values().collect(), met: all_met }
    }

    /// The integrals over the whole facet.
    fn whole<'f>(&self, site: &FacetView<'f>) -> Covered<'f> {
        let (facet, mut covered) = (site.facet, Covered::new(site.facet));
        let mut add = |at: [f64; 3], size: f64| {
            let area = size * self.measure(facet, &(facet.reference().shape)(at));
            covered.add_whole(&self.functions(facet, at), area);
        };
        match &site.projected {
            None => line::for_each_of_whole(facet, &mut add),
            Some(face) => face.for_each_of_whole(&mut add),
        }
        covered
    }

    /// The integrals over what a slave facet shares with a facet of the other surface; `None` if it is nothing.
    fn shared<'f>(&self, site: &FacetView, other: &'f PlacedFacet<'f>) -> Option<Shared<'f>> {
        let (facet, mut shared) = (site.facet, Shared::new(other));
        let heights = [facet, other].map(|one| {
            let mut heights: PerNode<f64> = [0.0; MAX_NODES];
            let places = one.places().iter().map(|&place| dot(minus(place, facet.middle), site.direction));
            heights.iter_mut().zip(places).for_each(|(height, place)| *height = place);
            heights
        });
        let sum = |values: &PerNode<f64>, shape: &PerNode<f64>| -> f64 {
            values.iter().zip(shape).take(MOST).map(|(value, share)| value * share).sum()
        };
        let mut add = |SharedPoint { slave, master, weight }| {
            let [own, opposite] = [(facet.reference().shape)(slave), (other.reference().shape)(master)];
            let gap = sum(&heights[1], &opposite) - sum(&heights[0], &own);
            let area = weight * self.measure(facet, &own);
            shared.add(facet.nodes.len(), area, gap, [&self.functions(facet, slave), &opposite]);
            if self.between.is_some() {
                shared.add_places(area, [facet.at(&own), other.at(&opposite)]);
            }
        };
        match &site.projected {
            None => line::for_each_point(facet, &site.directions, other, self.reach, &mut add),
            Some(face) => face.for_each_point(other, self.reach, &mut add),
        }
        (shared.area > 0.0).then_some(shared)
    }

    /// The values of the functions of a slave facet.
    fn functions(&self, facet: &PlacedFacet, at: [f64; 3]) -> PerNode<f64> {
        let mut values = (facet.reference().shape)(at);
        if facet.reference().dimension == 2 {
            let has = |local: usize| self.has_coefficient.is_none_or(|has| has(facet.nodes[local]));
            positive_functions(facet.reference(), has, &mut values);
        }
        values
    }

    /// The factor from length or area to area at a point of a facet.
    fn measure(&self, facet: &PlacedFacet, shape: &PerNode<f64>) -> f64 {
        let radius = facet.places().iter().zip(shape).map(|(place, share)| share * place[0]).sum();
        self.formulation.measure(radius)
    }
}

/// The facets that see the other surface, and those that do not turn away from one of these at a common node.
fn kept<'f, 'a>(facets: &'f [PlacedFacet<'a>], nodes: usize, sees: impl Fn(usize) -> bool) -> Vec<&'f PlacedFacet<'a>> {
    let mut seeing: Vec<Vec<usize>> = vec![Vec::new(); nodes];
    for facet in (0..facets.len()).filter(|&facet| sees(facet)) {
        facets[facet].nodes.iter().for_each(|&node| seeing[node].push(facet));
    }
    let turns_away =
        |one: &PlacedFacet| one.nodes.iter().flat_map(|&node| &seeing[node]).any(|&facet| !facets[facet].is_alike(one));
    let numbered = facets.iter().enumerate();
    numbered.filter(|&(number, facet)| sees(number) || !turns_away(facet)).map(|(_, facet)| facet).collect()
}

/// The mean outward unit normal at each node.
fn normals(surface: &SurfaceMesh, facets: &[PlacedFacet]) -> Vec<[f64; 3]> {
    let mut sums = vec![[0.0; 3]; surface.nodes.len()];
    facets.iter().for_each(|facet| facet.add_normals(&mut sums));
    sums.into_iter().map(unit).collect()
}
