//! Reference points: components without nodes, which couplings, equations and springs join to nodes. They are
//! eliminated here, so that the problem has unknowns of nodes alone; what they do follows from its answer.

use std::collections::{BTreeMap, BTreeSet};

use super::facing::TieRow;
use super::preload::{bolt_of, point_named, terms_of};
use super::rigid_face::{Given, NAMES, motions};
use crate::error::Error;
use crate::fem::assembly::Springs;
use crate::fem::body::ElasticBody;
use crate::fem::sum::{Component, LinearForm, Sum, following, mean};
use crate::fem::tributary_areas;
use crate::scene::input::entry::{boundary, finite, nodes_named_once, positive, vector, wrong};
use crate::scene::input::schema::{CouplingSpec, Scene, TermPlace, TermSpec, TieSpec};

/// In the replaced components of a sum, an equation at points by its number: how much of it the sum has taken up. With
/// the multipliers of what is left, these shares give the multiplier of every equation as it was.
const EQUATION: usize = 6;

/// What is left of a value below this share of its parts is rounding.
const CONTRADICTION: f64 = 1e-9;

/// The reference points of a scene, and what its ties and springs at points mean for nodes. In sums the points come
/// after the nodes of the mesh.
#[derive(Clone, Debug, Default)]
pub struct ReferencePoints {
    pub all: Vec<ReferencePoint>,
    nodes: usize,
    /// The sums of each tie at points that are zero.
    pub ties: BTreeMap<usize, Vec<Sum>>,
    /// The elongations of springs at points, with their stiffnesses in force per length.
    springs: BTreeMap<usize, (Sum, f64)>,
    whole: Whole,
    /// The work of the forces and moments on points.
    load: Sum,
}

/// What ties and springs at points are in the scene, before the elimination.
#[derive(Clone, Debug, Default)]
struct Whole {
    equations: Vec<(usize, Sum)>,
    /// The elongation of each spring, without points that no tie joins to a body: they are the ground.
    springs: BTreeMap<usize, Sum>,
    /// The first side of each tie: the nodes of a coupling, or the place of the first term of an equation.
    sides: BTreeMap<usize, BTreeSet<usize>>,
}

#[derive(Clone, Debug)]
pub struct ReferencePoint {
    pub name: String,
    pub at: [f64; 3],
    /// The preload that it stands for.
    pub bolt: Option<usize>,
    /// Its motions in the order of [`Component`]; `None` for those that nothing gives.
    moved: [Option<Sum>; 6],
    /// The forces and moments on it in the scene.
    applied: [f64; 6],
}

/// The number of a reference point that equations, springs and couplings may name.
fn joining(scene: &Scene, name: &str, path: &str) -> Result<usize, Error> {
    match bolt_of(scene, name) {
        None => point_named(scene, name, path),
        Some(bolt) => Err(wrong(
            path,
            format!("`{name}` stands for the bolt of ties[{bolt}]; prescribe its `x` or its `force` instead"),
        )),
    }
}

/// A sum of terms, and the place of the first one in the list; points come after the nodes.
fn sum_of(scene: &Scene, terms: &[TermSpec], path: &str, body: &ElasticBody) -> Result<(Sum, usize), Error> {
    let (mut sum, nodes) = (Sum::default(), body.mesh().nodes().len());
    let point = |name: &str, path: String| joining(scene, name, &path).map(|point| nodes + point);
    let placed = terms_of(terms, path, body, &point)?;
    for (term, &(place, vector)) in terms.iter().zip(&placed) {
        sum.add_along(place, vector);
        let turns = [term.rotation.x, term.rotation.y, term.rotation.z].into_iter().enumerate();
        turns.filter(|turn| turn.1 != 0.0).for_each(|(axis, part)| sum.add((place, 3 + axis), part));
    }
    Ok((sum, placed.first().map_or(0, |first| first.0)))
}

/// The reference points, eliminated from all ties, springs and loads.
pub(crate) fn reference_points(scene: &Scene, body: &ElasticBody) -> Result<ReferencePoints, Error> {
    let nodes = body.mesh().nodes().len();
    let mut points = ReferencePoints { nodes, ..ReferencePoints::default() };
    let mut prescribed = BTreeMap::new();
    for (index, spec) in scene.points.iter().enumerate() {
        let path = format!("points[{index}]");
        if spec.name.is_empty() || scene.points[..index].iter().any(|other| other.name == spec.name) {
            let message = format!("`{}` is not allowed: every point needs a name of its own", spec.name);
            return Err(wrong(format!("{path}.name"), message));
        }
        let at = vector(&format!("{path}.at"), &spec.at, body.dimension())?;
        let turns = spec.rotation.clone().unwrap_or_default();
        let given = Given {
            motions: [spec.x, spec.y, spec.z, turns.x, turns.y, turns.z],
            force: spec.force.as_deref(),
            moment: spec.moment.as_deref(),
        };
        let (mut applied, bolt) = ([0.0; 6], bolt_of(scene, &spec.name));
        for motion in motions(&given, &path, body)? {
            applied[motion.kind] = motion.force;
            if bolt.is_some() {
                if motion.kind > 0 && (motion.force != 0.0 || motion.prescribed.is_some_and(|value| value != 0.0)) {
                    let message = "the point stands for a bolt, which has a shortening and a tension along x alone";
                    return Err(wrong(format!("{path}.{}", motion.name()), message));
                }
                continue;
            }
            points.load.add((nodes + index, motion.kind), motion.force);
            prescribed.extend(motion.prescribed.map(|value| ((nodes + index, motion.kind), value)));
        }
        let (name, moved) = (spec.name.clone(), Default::default());
        points.all.push(ReferencePoint { name, at, bolt, moved, applied });
    }
    if !points.all.is_empty() {
        Elimination::of(scene, body, points.load)?.points(scene, &prescribed, points.all)
    } else {
        Ok(points)
    }
}

/// Returns `true` if a reference point is among the terms.
fn names_point(terms: &[TermSpec]) -> bool {
    terms.iter().any(|term| matches!(term.on, TermPlace::Reference(_)))
}

impl CouplingSpec {
    /// The sums that the coupling makes zero.
    fn sums(&self, scene: &Scene, path: &str, body: &ElasticBody) -> Result<Vec<Sum>, Error> {
        let (mesh, dimension) = (body.mesh(), body.dimension());
        let number = joining(scene, &self.point, &format!("{path}.point"))?;
        let at = vector(&format!("points[{number}].at"), &scene.points[number].at, dimension)?;
        let point = (mesh.nodes().len() + number, at);
        let all = motions(&Given::default(), path, body)?;
        let kinds = |turns: bool| all.iter().map(|motion| motion.kind).filter(move |&kind| (kind >= 3) == turns);
        let (axes, turns): (Vec<usize>, Vec<usize>) = (kinds(false).collect(), kinds(true).map(|k| k - 3).collect());
        let areas = match &self.boundary {
            Some(name) if self.nodes.is_empty() => {
                tributary_areas(body, boundary(mesh, name, &format!("{path}.boundary"))?)
            }
            None if !self.nodes.is_empty() && !self.mean => {
                let nodes = nodes_named_once(mesh, &self.nodes, &format!("{path}.nodes"))?;
                nodes.into_iter().map(|node| (node, 0.0)).collect()
            }
            None if !self.nodes.is_empty() => return Err(wrong(path, "a `mean` is over the area of a `boundary`")),
            _ => return Err(wrong(path, "needs either a `boundary` or `nodes`; give one of them")),
        };
        let places = areas.into_iter().map(|(node, area)| (node, area, mesh.nodes()[node]));
        if !self.mean {
            return Ok(places.flat_map(|(node, _, place)| following((node, place), point, &axes, &turns)).collect());
        }
        // About an axis of revolution the mean of a radial displacement is no motion of a point.
        let revolved = body.formulation().is_axisymmetric();
        let kinds: Vec<usize> = kinds(false).filter(|&kind| !revolved || kind != 0).chain(kinds(true)).collect();
        mean(&places.collect::<Vec<_>>(), point, &kinds, dimension == 2)
            .ok_or_else(|| wrong(path, "the nodes of the boundary lie on a line, about which no moment acts"))
    }
}

/// The sums from which components are taken one after the other.
struct Elimination {
    nodes: usize,
    equations: Vec<(usize, Sum)>,
    springs: BTreeMap<usize, (Sum, f64)>,
    load: Sum,
    whole: Whole,
    /// The eliminated components, each with a sum that has it and is zero.
    solved: Vec<(Component, Sum)>,
}

impl Elimination {
    fn of(scene: &Scene, body: &ElasticBody, load: Sum) -> Result<Self, Error> {
        let (mut equations, mut springs, nodes) = (Vec::new(), BTreeMap::new(), body.mesh().nodes().len());
        let mut sides = BTreeMap::<usize, BTreeSet<usize>>::new();
        for (index, tie) in scene.ties.iter().enumerate() {
            match tie {
                TieSpec::Equation(spec) if names_point(&spec.terms) => {
                    let path = format!("ties[{index}].equation");
                    finite(format!("{path}.value"), spec.value)?;
                    let (mut sum, first) = sum_of(scene, &spec.terms, &path, body)?;
                    (sum.constant, sum.scale) = (-spec.value, spec.value.abs());
                    sides.insert(index, [first].into());
                    equations.push((index, sum));
                }
                TieSpec::Coupling(spec) => {
                    let sums = spec.sums(scene, &format!("ties[{index}].coupling"), body)?;
                    let places = sums.iter().flat_map(|sum| sum.terms.keys().map(|component| component.0));
                    sides.insert(index, places.filter(|&place| place < nodes).collect());
                    equations.extend(sums.into_iter().map(|sum| (index, sum)));
                }
                _ => {}
            }
        }
        for (index, spec) in scene.springs.iter().enumerate().filter(|(_, spec)| names_point(&spec.terms)) {
            let path = format!("springs[{index}]");
            let along = positive(&format!("{path}.along"), spec.along_alone(&path)?)?;
            springs.insert(index, (sum_of(scene, &spec.terms, &path, body)?.0, along));
        }
        let tied = equations.iter().flat_map(|(_, sum): &(usize, Sum)| sum.terms.keys());
        let tied: BTreeSet<usize> = tied.map(|component| component.0).collect();
        let of_body = |(&index, (sum, _)): (&usize, &(Sum, f64))| {
            let mut sum = sum.clone();
            sum.terms.retain(|component, _| component.0 < nodes || tied.contains(&component.0));
            (index, sum)
        };
        let whole = Whole { springs: springs.iter().map(of_body).collect(), equations: equations.clone(), sides };
        for (number, (_, sum)) in equations.iter_mut().enumerate() {
            sum.replaced.insert((number, EQUATION), 1.0);
        }
        Ok(Elimination { nodes, equations, springs, load, whole, solved: Vec::new() })
    }

    fn sums(&mut self) -> impl Iterator<Item = &mut Sum> {
        let Elimination { equations, springs, load, solved, .. } = self;
        let equations = equations.iter_mut().map(|(_, sum)| sum);
        let springs = springs.values_mut().map(|(elongation, _)| elongation);
        equations.chain(springs).chain(solved.iter_mut().map(|(_, zero)| zero)).chain(std::iter::once(load))
    }

    /// Takes the equation in which a component has the largest share, and with it removes the component everywhere
    /// else.
    fn eliminate(&mut self, component: Component) {
        let shares = self.equations.iter().map(|(_, sum)| sum.share(component)).enumerate();
        let largest = shares.filter(|(_, share)| *share > 0.0).max_by(|one, other| one.1.total_cmp(&other.1));
        if let Some((pivot, _)) = largest {
            let zero = self.equations.remove(pivot).1;
            self.sums().for_each(|sum| sum.eliminate(component, &zero));
            self.solved.push((component, zero));
        }
    }

    /// The points after the elimination of all their components.
    fn points(
        mut self,
        scene: &Scene,
        prescribed: &BTreeMap<Component, f64>,
        mut all: Vec<ReferencePoint>,
    ) -> Result<ReferencePoints, Error> {
        let nodes = self.nodes;
        // A tie of which nothing is left keeps its place.
        let mut ties: BTreeMap<usize, Vec<Sum>> = self.equations.iter().map(|one| (one.0, Vec::new())).collect();
        let (equations, springs) = (self.equations.iter().map(|one| &one.1), self.springs.values().map(|one| &one.0));
        let named = equations.chain(springs).flat_map(|sum| sum.terms.keys().copied());
        let joined: BTreeSet<Component> = named.filter(|component| component.0 >= nodes).collect();
        let word = |(point, kind): Component| (&scene.points[point - nodes].name, NAMES[kind]);
        let free = |component: Component, what: &str| {
            let (name, motion) = word(component);
            format!("the reference point `{name}` is free in `{motion}`; {what}")
        };
        if let Some(&alone) = self.load.terms.keys().find(|component| !joined.contains(component)) {
            let message =
                free(alone, "nothing follows it that could carry the force; add a coupling, an equation or a spring");
            return Err(wrong(format!("points[{}]", alone.0 - nodes), message));
        }
        for sum in self.sums() {
            let own = sum.terms.keys().filter_map(|component| Some((*component, *prescribed.get(component)?)));
            own.collect::<Vec<_>>().into_iter().for_each(|(component, value)| sum.insert(component, value));
        }
        joined.iter().filter(|component| !prescribed.contains_key(component)).for_each(|&one| self.eliminate(one));
        let loose = |sum: &Sum| sum.terms.keys().copied().find(|component| component.0 >= nodes);
        for (index, sum) in self.equations {
            let of_tie = ties.entry(index).or_default();
            if !sum.terms.is_empty() {
                of_tie.push(sum);
            } else if sum.constant.abs() > CONTRADICTION * sum.scale {
                let message = "the displacements that are prescribed at reference points contradict this equation";
                return Err(wrong(format!("ties[{index}]"), message));
            }
        }
        if let Some((index, component)) = self.springs.iter().find_map(|(index, one)| Some((index, loose(&one.0)?))) {
            return Err(wrong(format!("springs[{index}]"), free(component, "nothing but springs holds it")));
        }
        if let Some(component) = loose(&self.load) {
            let message = free(component, "it carries no force there");
            return Err(wrong(format!("points[{}]", component.0 - nodes), message));
        }
        for (&(point, kind), &constant) in prescribed {
            all[point - nodes].moved[kind] = Some(Sum { constant, ..Sum::default() });
        }
        for ((point, kind), zero) in self.solved {
            let (mut value, own) = (Sum::default(), zero.terms[&(point, kind)]);
            value.add_multiple(-1.0 / own, &zero);
            value.terms.retain(|component, _| component.0 < nodes);
            all[point - nodes].moved[kind] = Some(value);
        }
        Ok(ReferencePoints { all, nodes, ties, springs: self.springs, whole: self.whole, load: self.load })
    }
}

impl ReferencePoints {
    /// The spring of this number, if a point is among its terms.
    pub fn spring(&self, number: usize) -> Option<Springs> {
        let (elongation, along) = self.springs.get(&number)?;
        let form = LinearForm { terms: elongation.vectors().into_iter().collect(), own: 0 };
        Some(Springs::between(form, elongation.constant, *along))
    }

    /// Adds the forces on nodes that do the work of those on points, `dimension` entries for each node.
    pub fn add_load(&self, load: &mut [f64], dimension: usize) {
        for (node, force) in self.load.vectors() {
            load[dimension * node..dimension * (node + 1)].iter_mut().zip(force).for_each(|(sum, part)| *sum += part);
        }
    }

    /// The value of a sum in the displacement of each node.
    fn value(sum: &Sum, displacement: &impl Fn(usize) -> [f64; 3]) -> f64 {
        sum.terms.iter().fold(sum.constant, |all, (&(node, axis), part)| all + part * displacement(node)[axis])
    }

    /// The forces of loads, ties and springs on what is eliminated: on prescribed components of points, and the
    /// multiplier of each equation as it was before the elimination.
    fn eliminated(
        &self,
        displacement: &impl Fn(usize) -> [f64; 3],
        rows: &[TieRow],
        of_ties: &[f64],
    ) -> BTreeMap<Component, f64> {
        let mut all = self.load.replaced.clone();
        let mut add = |factor: f64, replaced: &BTreeMap<Component, f64>| {
            replaced.iter().for_each(|(component, part)| *all.entry(*component).or_default() += factor * part);
        };
        rows.iter().zip(of_ties).for_each(|(row, multiplier)| add(*multiplier, &row.on_points));
        for (elongation, along) in self.springs.values() {
            add(-along * Self::value(elongation, displacement), &elongation.replaced);
        }
        all
    }

    /// Of each point the displacements and rotations, and the forces and moments from outside: those of the scene, and
    /// those that hold prescribed motions; from the displacement of each node and the multipliers of all equations.
    pub fn values(
        &self,
        displacement: impl Fn(usize) -> [f64; 3],
        rows: &[TieRow],
        of_ties: &[f64],
    ) -> Vec<[[f64; 6]; 2]> {
        let value = |sum: &Sum| Self::value(sum, &displacement);
        let moved = |point: &ReferencePoint| point.moved.each_ref().map(|sum| sum.as_ref().map_or(0.0, value));
        let mut all: Vec<[[f64; 6]; 2]> = self.all.iter().map(|point| [moved(point), point.applied]).collect();
        let eliminated = self.eliminated(&displacement, rows, of_ties).into_iter();
        eliminated.filter(|one| one.0.1 != EQUATION).for_each(|((point, kind), force)| {
            all[point - self.nodes][1][kind] -= force;
        });
        all
    }

    /// The forces and moments of each tie at points on its first side.
    pub fn forces_of_ties(
        &self,
        displacement: impl Fn(usize) -> [f64; 3],
        rows: &[TieRow],
        of_ties: &[f64],
    ) -> BTreeMap<usize, ForcesAt> {
        let eliminated = self.eliminated(&displacement, rows, of_ties);
        let mut ties: BTreeMap<usize, ForcesAt> = BTreeMap::new();
        for (number, (tie, sum)) in self.whole.equations.iter().enumerate() {
            let (of_tie, side) = (ties.entry(*tie).or_default(), &self.whole.sides[tie]);
            let multiplier = eliminated.get(&(number, EQUATION)).copied().unwrap_or(0.0);
            let own = sum.terms.iter().filter(|term| side.contains(&term.0.0));
            own.for_each(|(&(place, kind), part)| of_tie.entry(place).or_default()[kind] += multiplier * part);
        }
        ties
    }

    /// The forces and moments of each spring at points on the bodies, at all places of its terms.
    pub fn forces_of_springs(&self, displacement: impl Fn(usize) -> [f64; 3]) -> BTreeMap<usize, ForcesAt> {
        let of_spring = |(index, (elongation, along)): (&usize, &(Sum, f64))| {
            let (force, mut forces) = (-along * Self::value(elongation, &displacement), ForcesAt::new());
            let terms = self.whole.springs[index].terms.iter();
            terms.for_each(|(&(place, kind), part)| forces.entry(place).or_default()[kind] += force * part);
            (*index, forces)
        };
        self.springs.iter().map(of_spring).collect()
    }

    /// A place in sums, if it is a point.
    pub fn at(&self, place: usize) -> Option<&ReferencePoint> {
        self.all.get(place.checked_sub(self.nodes)?)
    }
}

/// Forces, then moments, by the places in sums on which they act: nodes, and after them points.
pub(crate) type ForcesAt = BTreeMap<usize, [f64; 6]>;
