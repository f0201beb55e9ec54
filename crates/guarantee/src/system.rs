//! The contact problem of simplices with the same number of unknowns each, which are linear functions of the free ones.
//!
//! The unknowns are the components along the axes of a displacement at places, then the free motions of rigid faces and
//! the travels of pressed obstacles. Supports and rigid faces make those of some places functions of fewer free ones.

use std::collections::BTreeMap;

use super::mesh::{OuterFacet, SimplexMesh};
use super::problem::{ContinuumProblem, Foundation};
use super::simplex::Point;
use crate::error::Error;
use signorini_fem::assembly::perpendicular;
use signorini_fem::geometry::{Around, COORDINATES, dot, length, unit};
use signorini_qp::{ContactProblem, NearNullSpace, SparseMatrix, SymmetricMatrix};

/// A direction depends on others if the sine of its angle to their span is below this: the rounding of written
/// components.
const DEPENDENT: f64 = 1e-9;

/// The matrix of a simplex, row by row.
pub type Block = Vec<f64>;

/// Adds springs on a facet with this normal to the matrix of its simplex. `share` is the integral of the product of two
/// of the functions on the facet, and `local` their numbers among those of the simplex.
pub fn add_springs(
    block: &mut Block,
    dimension: usize,
    (springs, normal): (&Foundation, Point),
    local: &[usize],
    share: &[Vec<f64>],
) {
    let count = block.len().isqrt();
    for (axis, &along) in COORDINATES[..dimension].iter().enumerate() {
        let resistance = springs.resistance(normal, along);
        for (&own, line) in local.iter().zip(share) {
            for (&other, &share) in local.iter().zip(line) {
                for (towards, part) in resistance.iter().enumerate().take(dimension) {
                    block[(dimension * own + towards) * count + dimension * other + axis] += share * part;
                }
            }
        }
    }
}

/// The unknowns of the simplices, the same number for each.
#[derive(Clone, Debug)]
pub struct CellNumbers {
    pub of_cell: usize,
    /// Those of all simplices, one after another.
    pub numbers: Vec<usize>,
}

impl CellNumbers {
    pub fn of(&self, cell: usize) -> &[usize] {
        &self.numbers[cell * self.of_cell..(cell + 1) * self.of_cell]
    }

    pub fn iter(&self) -> impl Iterator<Item = &[usize]> + Clone {
        self.numbers.chunks_exact(self.of_cell)
    }
}

/// A bound on a sum of unknowns: `sum of coefficient x <= gap`.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The unknowns and their coefficients, those of its place first.
    pub terms: Vec<(usize, f64)>,
    /// The number of terms of its place.
    own: usize,
    /// The bound of the row, in length.
    pub gap: f64,
}

impl Row {
    /// The bound on the displacement of a place along a normal, less that of a place of another body, with the travel
    /// of the obstacle towards the body and the share of it that counts.
    pub fn new(
        (place, other): (usize, Option<usize>),
        dimension: usize,
        normal: Point,
        travel: Option<(usize, f64)>,
        gap: f64,
    ) -> Self {
        let mut terms: Vec<_> = along(place, dimension, normal).collect();
        let own = terms.len();
        let other = other.into_iter().flat_map(|place| along(place, dimension, normal));
        terms.extend(other.map(|(unknown, part)| (unknown, -part)).chain(travel));
        Row { terms, own, gap }
    }

    /// The place whose displacement it bounds.
    pub fn place(&self, dimension: usize) -> usize {
        self.terms.first().map_or(usize::MAX, |term| term.0 / dimension)
    }

    /// The sum at these values of all unknowns.
    pub fn value(&self, values: &[f64]) -> f64 {
        self.terms.iter().map(|&(unknown, coefficient)| coefficient * values[unknown]).sum()
    }
}

/// The unknowns of a place with the components of a vector.
fn along(place: usize, dimension: usize, vector: Point) -> impl Iterator<Item = (usize, f64)> {
    let components = vector.into_iter().take(dimension).enumerate();
    components.filter(|part| part.1 != 0.0).map(move |(axis, part)| (dimension * place + axis, part))
}

/// All unknowns as linear functions of the free ones.
#[derive(Clone, Debug)]
pub struct Affine {
    /// How many are free.
    pub free: usize,
    /// How many of these, the first ones, belong to one place each.
    own: usize,
    /// Rigid motions in the plane or in space cost no energy.
    moves_rigidly: bool,
    /// The orthonormal axes of the supports of each supported place.
    pub supports: BTreeMap<usize, Vec<Point>>,
    /// The prescribed part of each unknown, which no free unknown changes.
    pub prescribed: Vec<f64>,
    /// The first term of each unknown, and the end.
    starts: Vec<u32>,
    /// Free unknowns with their coefficients.
    terms: Vec<(u32, f64)>,
}

/// The displacement of a supported place.
struct Supported {
    /// Its prescribed part.
    offset: Point,
    /// The orthonormal axes of the supports.
    held: Vec<Point>,
    /// The other axes.
    free: Vec<Point>,
}

impl Supported {
    /// The displacement under prescribed components; `first` is the first free axis, if it may be.
    fn of(dimension: usize, components: &[(Point, f64)], first: Option<Point>) -> Self {
        let (mut held, mut offset): (Vec<Point>, Point) = (Vec::new(), [0.0; 3]);
        for &(direction, value) in components {
            let rest = perpendicular(direction, &held);
            if length(rest) > DEPENDENT {
                let axis = unit(perpendicular(unit(rest), &held));
                let amount = (value - dot(direction, offset)) / dot(direction, axis);
                (0..3).for_each(|of| offset[of] += amount * axis[of]);
                held.push(axis);
            }
        }
        let mut axes = held.clone();
        let first = first.map(|first| perpendicular(first, &axes)).filter(|rest| length(*rest) > DEPENDENT);
        axes.extend(first.map(unit));
        while axes.len() < dimension {
            let rests = COORDINATES[..dimension].iter().map(|&axis| perpendicular(axis, &axes));
            let Some(rest) = rests.max_by(|a, b| length(*a).total_cmp(&length(*b))) else { break };
            axes.push(unit(perpendicular(unit(rest), &axes)));
        }
        let free = axes.split_off(held.len());
        Supported { offset, held, free }
    }
}

impl Affine {
    /// The unknowns of a mesh at these places; `fixed` are those of them that do not move along an axis, `on` gives the
    /// places on a facet.
    pub fn new(
        problem: &ContinuumProblem,
        mesh: &SimplexMesh,
        places: &[Point],
        fixed: impl Iterator<Item = (usize, Point)>,
        on: impl Fn(&OuterFacet) -> Vec<usize>,
    ) -> Self {
        let dimension = mesh.dimension;
        let (mut held, mut faces, mut normals) = (BTreeMap::<_, Vec<_>>::new(), BTreeMap::new(), BTreeMap::new());
        fixed.for_each(|(place, axis)| held.entry(place).or_default().push((axis, 0.0)));
        for outer in mesh.surface() {
            let condition = &problem.conditions[outer.condition];
            for place in on(&outer) {
                let components = condition.held.iter().map(|held| (held.direction, held.value.at(places[place])));
                if !condition.held.is_empty() {
                    held.entry(place).or_default().extend(components);
                }
                faces.extend(condition.rigid_face.map(|face| (place, face)));
                normals
                    .extend(condition.obstacles.first().map(|&obstacle| (place, problem.obstacles[obstacle].normal)));
            }
        }
        held.retain(|place, _| !faces.contains_key(place));
        let mut special: BTreeMap<usize, Supported> = BTreeMap::new();
        for (&place, &normal) in normals.iter().filter(|(place, _)| !faces.contains_key(place)) {
            special.insert(place, Supported::of(dimension, &[], Some(normal)));
        }
        for (&place, components) in &held {
            special.insert(place, Supported::of(dimension, components, normals.get(&place).copied()));
        }
        let prescribed: usize = special.values().map(|supported| supported.held.len()).sum();
        // The motions of rigid faces and the travels come last.
        let own = dimension * (places.len() - faces.len()) - prescribed;
        let mut motions = vec![own];
        motions.extend(problem.rigid_faces.iter().scan(own, |next, face| {
            *next += face.free.len();
            Some(*next)
        }));
        let free = own + problem.loads_of_motions().len();
        let count = dimension * places.len() + free - own;
        let mut unknowns = Affine {
            free,
            own,
            moves_rigidly: !problem.is_axisymmetric && own == free,
            supports: BTreeMap::new(),
            prescribed: Vec::with_capacity(count),
            starts: vec![0],
            terms: Vec::with_capacity(count),
        };
        let mut next = 0;
        for (place, &at) in places.iter().enumerate() {
            if let Some(&face) = faces.get(&place) {
                let (first, face) = (motions[face], &problem.rigid_faces[face]);
                for axis in 0..dimension {
                    let by_one = face.free.iter().enumerate().map(|(motion, by)| (first + motion, by.0[axis].at(at)));
                    unknowns.push(face.prescribed[axis].at(at), by_one);
                }
            } else if let Some(supported) = special.get(&place) {
                for axis in 0..dimension {
                    let along = supported.free.iter().enumerate().map(|(free, along)| (next + free, along[axis]));
                    unknowns.push(supported.offset[axis], along);
                }
                next += supported.free.len();
            } else {
                (0..dimension).for_each(|axis| unknowns.push(0.0, std::iter::once((next + axis, 1.0))));
                next += dimension;
            }
        }
        (own..free).for_each(|motion| unknowns.push(0.0, std::iter::once((motion, 1.0))));
        let is_supported =
            |(place, supported): (usize, Supported)| (!supported.held.is_empty()).then_some((place, supported.held));
        unknowns.supports = special.into_iter().filter_map(is_supported).collect();
        unknowns
    }

    fn push(&mut self, offset: f64, terms: impl Iterator<Item = (usize, f64)>) {
        self.prescribed.push(offset);
        self.terms.extend(terms.filter(|term| term.1 != 0.0).map(|(free, coefficient)| (free as u32, coefficient)));
        self.starts.push(self.terms.len() as u32);
    }

    /// The free unknowns of an unknown, with their coefficients.
    fn terms(&self, unknown: usize) -> &[(u32, f64)] {
        &self.terms[self.starts[unknown] as usize..self.starts[unknown + 1] as usize]
    }

    pub fn count(&self) -> usize {
        self.prescribed.len()
    }

    /// The free unknowns of terms with their coefficients, and their prescribed part.
    pub fn of_terms(&self, of_all: &[(usize, f64)]) -> (Vec<(usize, f64)>, f64) {
        let (mut terms, mut prescribed) = (BTreeMap::new(), 0.0);
        for &(unknown, coefficient) in of_all {
            prescribed += coefficient * self.prescribed[unknown];
            for &(free, part) in self.terms(unknown) {
                *terms.entry(free as usize).or_insert(0.0) += coefficient * part;
            }
        }
        (terms.into_iter().filter(|term| term.1.abs() > DEPENDENT).collect(), prescribed)
    }

    /// The free unknown of the place of a row, or of the place opposite to it if that one is held, and its coefficient;
    /// `None` unless one unknown alone moves the place along the row.
    pub fn own_term(&self, row: &Row) -> Option<(usize, f64)> {
        let of_places = [&row.terms[..row.own], &row.terms[row.own..]].map(|terms| self.of_terms(terms).0);
        match of_places.iter().find(|terms| !terms.is_empty())?[..] {
            [(free, coefficient)] if free < self.own => Some((free, coefficient)),
            _ => None,
        }
    }

    /// Changes the displacement of a place of a row, if that has a free unknown of its own, so that the sum of the row
    /// is `to`.
    pub fn move_to(&self, values: &mut [f64], row: &Row, to: f64) {
        let Some((free, coefficient)) = self.own_term(row) else { return };
        let amount = (to - row.value(values)) / coefficient;
        for &(unknown, _) in &row.terms {
            let own = self.terms(unknown).iter().filter(|term| term.0 as usize == free);
            values[unknown] += own.map(|term| amount * term.1).sum::<f64>();
        }
    }

    /// All values from those of the free unknowns.
    pub fn expanded(&self, free: &[f64]) -> Vec<f64> {
        let value = |unknown: usize| {
            let terms = self.terms(unknown).iter().map(|&(free_unknown, part)| part * free[free_unknown as usize]);
            terms.fold(self.prescribed[unknown], |sum, part| sum + part)
        };
        (0..self.count()).map(value).collect()
    }

    /// The sums over all unknowns of an amount times the coefficient of each free unknown: forces along these.
    pub fn gathered(&self, of_all: &[f64]) -> Vec<f64> {
        self.gathered_by(of_all, |part| part)
    }

    /// The same sums with a function of the coefficients.
    pub fn gathered_by(&self, of_all: &[f64], factor: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut sums = vec![0.0; self.free];
        for (unknown, amount) in of_all.iter().enumerate() {
            self.terms(unknown).iter().for_each(|&(free, part)| sums[free as usize] += factor(part) * amount);
        }
        sums
    }

    /// The same unknowns without prescribed parts, with the sums of some rows held at a value; `None` if the unknown of
    /// one row has a part in another.
    pub fn with_held<'r>(&self, rows: impl Iterator<Item = &'r Row>, to: f64) -> Option<Self> {
        // Each held unknown is a constant and a sum of others.
        let mut held: BTreeMap<usize, (f64, Vec<(usize, f64)>)> = BTreeMap::new();
        for row in rows {
            let (own, coefficient) = self.own_term(row)?;
            let others = self.of_terms(&row.terms).0.into_iter().filter(|term| term.0 != own);
            let given = (to / coefficient, others.map(|(free, part)| (free, -part / coefficient)).collect());
            let known = held.entry(own).or_insert_with(|| given.clone());
            if *known != given {
                return None;
            }
        }
        let others = || held.values().flat_map(|given| &given.1);
        if others().any(|other| held.contains_key(&other.0)) {
            return None;
        }
        let mut unknowns = Affine {
            free: self.free - held.len(),
            own: self.own - held.len(),
            moves_rigidly: self.moves_rigidly && others().next().is_none(),
            supports: self.supports.clone(),
            prescribed: Vec::with_capacity(self.count()),
            starts: vec![0],
            terms: Vec::with_capacity(self.terms.len()),
        };
        let mut next = 0..;
        let number = |free: usize| if held.contains_key(&free) { None } else { next.next() };
        let numbers: Vec<Option<usize>> = (0..self.free).map(number).collect();
        for unknown in 0..self.count() {
            let (mut prescribed, mut terms) = (0.0, Vec::new());
            for &(free, part) in self.terms(unknown) {
                match held.get(&(free as usize)) {
                    None => terms.push((free as usize, part)),
                    Some((constant, others)) => {
                        prescribed += part * constant;
                        terms.extend(others.iter().map(|&(other, share)| (other, part * share)));
                    }
                }
            }
            unknowns.push(prescribed, terms.into_iter().filter_map(|(free, part)| Some((numbers[free]?, part))));
        }
        Some(unknowns)
    }

    /// The rigid motions as values of the free unknowns; `None` with unknowns other than those of places, and about an
    /// axis.
    fn rigid_motions(&self, places: &[Point], dimension: usize) -> Result<Option<NearNullSpace>, Error> {
        if !self.moves_rigidly {
            return Ok(None);
        }
        let along = |axis: usize| places.iter().map(|place| place[axis]).collect();
        let all = NearNullSpace::of_nodes(&(0..dimension).map(along).collect::<Vec<_>>())?;
        Ok(NearNullSpace::of_modes(all.vectors().iter().map(|motion| self.gathered(motion)).collect()))
    }

    /// The problem of simplices with these unknowns and matrices, under a load on all unknowns, with rows. At each of
    /// the `places` a linear displacement has the values of the unknowns along the axes.
    pub fn problem(
        &self,
        dimension: usize,
        numbers: &CellNumbers,
        blocks: &[Block],
        load: &[f64],
        rows: &[Row],
        places: &[Point],
    ) -> Result<ContactProblem, Error> {
        let (starts, row_indices) = self.pattern(numbers);
        let (mut values, mut lifted) = (vec![0.0; row_indices.len()], vec![0.0; self.count()]);
        for (unknowns, block) in numbers.iter().zip(blocks) {
            for (&unknown, line) in unknowns.iter().zip(block.chunks_exact(unknowns.len())) {
                for (&other, &value) in unknowns.iter().zip(line) {
                    lifted[unknown] += value * self.prescribed[other];
                }
                for &(column, part) in self.terms(unknown) {
                    let of_column = starts[column as usize]..starts[column as usize + 1];
                    let mut place = of_column.start;
                    for (&other, &value) in unknowns.iter().zip(line) {
                        for &(row, other_part) in self.terms(other).iter().filter(|term| term.0 >= column) {
                            // Most unknowns follow the one before.
                            if row_indices.get(place + 1) == Some(&row) && place + 1 < of_column.end {
                                place += 1;
                            } else {
                                let before = row_indices[of_column.clone()].partition_point(|&other| other < row);
                                place = of_column.start + before;
                            }
                            values[place] += part * other_part * value;
                        }
                    }
                }
            }
        }
        let stiffness = SparseMatrix::from_parts(self.free, starts, row_indices, values);
        let left: Vec<f64> = load.iter().zip(&lifted).map(|(load, lifted)| load - lifted).collect();
        let (mut contact, mut gap) = (Vec::new(), Vec::with_capacity(rows.len()));
        for (index, row) in rows.iter().enumerate() {
            let (terms, prescribed) = self.of_terms(&row.terms);
            contact.extend(terms.into_iter().map(|(free, coefficient)| (index, free, coefficient)));
            gap.push(row.gap - prescribed);
        }
        let contact = SparseMatrix::from_triplets(rows.len(), self.free, &contact)?;
        let posed = ContactProblem::new(SymmetricMatrix::from_lower(stiffness)?, self.gathered(&left), contact, gap)?;
        Ok(match self.rigid_motions(places, dimension)? {
            Some(motions) => posed.with_near_null(motions)?,
            None => posed,
        })
    }

    /// Column starts and rows of the lower triangle in the free unknowns.
    fn pattern(&self, numbers: &CellNumbers) -> (Vec<usize>, Vec<u32>) {
        let free = |cell: &[usize]| {
            let mut free: Vec<usize> = Vec::with_capacity(cell.len());
            cell.iter().for_each(|&unknown| free.extend(self.terms(unknown).iter().map(|term| term.0 as usize)));
            free.sort_unstable();
            free.dedup();
            free
        };
        let around = Around::new(self.free, numbers.iter().map(|cell| free(cell).into_iter()));
        let (mut starts, mut rows, mut found) = (vec![0], Vec::new(), Vec::<u32>::new());
        for column in 0..self.free {
            // The unknowns of one place have the same neighbours.
            if column == 0 || around.at(column) != around.at(column - 1) {
                let cells = around.at(column).iter().flat_map(|&cell| numbers.of(cell as usize));
                found.clear();
                found.extend(cells.flat_map(|&other| self.terms(other).iter().map(|term| term.0)));
                found.sort_unstable();
                found.dedup();
            }
            rows.extend(found.iter().filter(|&&row| row as usize >= column));
            starts.push(rows.len());
        }
        (starts, rows)
    }
}

#[cfg(test)]
mod tests {
    use super::super::bodies::body;
    use super::super::displacement::Displacements;
    use super::super::problem::{Held, Linear};
    use super::*;

    /// Supports along two directions that are not at right angles hold what each of them prescribes.
    #[test]
    fn inclined_supports_at_one_place_are_both_kept() {
        let [one, other] = [[1.0, 0.0, 0.0], [0.6, 0.8, 0.0]];
        let supported = Supported::of(3, &[(one, 3.0), (other, -5.0)], None);
        for (direction, value) in [(one, 3.0), (other, -5.0)] {
            assert!((dot(direction, supported.offset) - value).abs() < 1e-14, "{:?}", supported.offset);
        }
        assert_eq!((supported.held.len(), &supported.free[..]), (2, &[[0.0, 0.0, 1.0]][..]));
    }

    /// Rows along an inclined normal at a place that a support holds along x: one unknown moves it, by a part of
    /// itself.
    #[test]
    fn a_row_at_a_support_is_moved_to_a_value_and_held_there() {
        let (mut problem, mesh) = body(2);
        let normal = [0.6, 0.8, 0.0];
        problem.obstacles[0].normal = normal;
        problem.conditions[2].held = vec![Held { direction: COORDINATES[0], value: Linear::constant(0.25) }];
        let displacements = Displacements::new(&problem, &mesh);
        let unknowns = displacements.unknowns();
        let outer = mesh.surface().find(|outer| outer.condition == 2).unwrap();
        let row = Row::new((displacements.on_facet(&outer)[2], None), 2, normal, None, 0.0);
        assert_eq!(row.place(2), displacements.on_facet(&outer)[2]);
        let (own, coefficient) = unknowns.own_term(&row).unwrap();
        assert!((coefficient - 0.8).abs() < 1e-14, "{coefficient}");
        let mut values = unknowns.expanded(&vec![0.0; unknowns.free]);
        assert!((row.value(&values) - 0.15).abs() < 1e-14);
        unknowns.move_to(&mut values, &row, 7.0);
        assert!((row.value(&values) - 7.0).abs() < 1e-13, "{}", row.value(&values));
        // Held rows have no prescribed part.
        let held = unknowns.with_held(std::iter::once(&row), -1.0).unwrap();
        assert_eq!(held.free, unknowns.free - 1);
        assert!(own < unknowns.free && (row.value(&held.expanded(&vec![0.5; held.free])) + 1.0).abs() < 1e-14);
    }

    /// A support that holds the surface inside the obstacle says how deep.
    #[test]
    fn a_support_inside_an_obstacle_names_the_depth() {
        let (mut problem, mesh) = body(2);
        problem.conditions[2].held = vec![Held { direction: COORDINATES[1], value: Linear::constant(0.5) }];
        let displacements = Displacements::new(&problem, &mesh);
        let error = displacements.rows(&displacements.unknowns()).unwrap_err();
        // The gap is between -0.1 and 0.26 there.
        let Error::Qp(signorini_qp::Error::Infeasible { overlap, .. }) = error else { panic!("{error}") };
        assert!(overlap > 0.24 && overlap < 0.5, "{overlap}");
    }
}
