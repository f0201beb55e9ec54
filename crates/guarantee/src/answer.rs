//! The part of a bracket that is kept, for a picture or a file; and any other displacement, judged by the ball that
//! contains the exact stress.

use std::collections::BTreeSet;
use std::ops::Range;

use super::bound::Bracket;
use super::integration::Sample;
use super::simplex::{MOST_CORNERS, Point, Simplex, Tensor, Weights, less, middle, weights_of_centre};
use crate::error::Error;
use signorini_fem::element::Tabulated;
use signorini_fem::geometry::{key, midpoint};
use signorini_fem::threads::each;
use signorini_fem::{Boundary, ElementKind, Mesh};

/// The answer on a mesh of triangles of six nodes or of tetrahedra of ten, with straight sides.
#[derive(Clone, Debug)]
pub struct ContinuumAnswer {
    /// Six-node triangles or ten-node tetrahedra.
    pub kind: ElementKind,
    /// Of each body the corners of the mesh, then the middles of its edges.
    pub nodes: Vec<Point>,
    /// The nodes of each element, in the order of its kind.
    pub elements: Vec<Vec<usize>>,
    /// The named parts of the surface, and the nodes of the facets of each, in the order of their kind.
    pub boundaries: Vec<(String, Vec<Vec<usize>>)>,
    /// The displacement of the nodes of the last mesh, `[u_x, u_y, u_z]` each, in length; in the plane u_z is zero.
    pub displacement: Vec<Point>,
    /// The mean over each element of the stress of the displacement and of the stress in balance:
    /// `[xx, yy, zz, xy, yz, zx]`, in force per area; in the plane those with z are zero.
    pub stress: Vec<Tensor>,
    /// The element of the first mesh that contains each element.
    pub origins: Vec<usize>,
    /// The contribution of each element to half the square of the bound, in force times length.
    pub shares: Vec<f64>,
}

impl ContinuumAnswer {
    /// Number of axes of the body, 2 or 3.
    pub fn dimension(&self) -> usize {
        self.kind.dimension()
    }

    /// The components of vectors `[x, y, z]` at all nodes along the axes of the body, in their unit: `[x, y]` or
    /// `[x, y, z]` of each node, in the order of the nodes; length `nodes x dimension`.
    pub fn components(&self, vectors: &[Point]) -> Vec<f64> {
        vectors.iter().flat_map(|vector| vector.iter().take(self.dimension())).copied().collect()
    }

    /// Nodes, elements and boundaries with their names, for a model of its own.
    pub fn mesh(&self) -> Result<Mesh, Error> {
        self.mesh_with(|_| true)
    }

    /// The same with those boundaries whose names are kept.
    pub fn mesh_with(&self, keeps: impl Fn(&str) -> bool) -> Result<Mesh, Error> {
        // As a part of itself, a boundary has its facets in the order in which they follow each other.
        let boundary = |(name, facets): &(String, Vec<Vec<usize>>)| {
            Boundary::new(name, self.kind.facet(), facets.concat()).part(name, |_| true)
        };
        let boundaries = self.boundaries.iter().filter(|boundary| keeps(&boundary.0)).map(boundary).collect();
        Ok(Mesh::new(self.nodes.clone(), self.kind, self.elements.concat(), boundaries)?)
    }
}

impl Bracket<'_> {
    /// The displacement and the stresses for a picture or a file.
    pub fn answer(&self) -> ContinuumAnswer {
        let (mesh, dimension) = (self.mesh, self.mesh.dimension);
        let kind = if dimension == 2 { ElementKind::QUADRATIC_TRIANGLE } else { ElementKind::QUADRATIC_TETRAHEDRON };
        let of = |function: usize| -> Point {
            let component =
                |axis: usize| if axis < dimension { self.primal.values[dimension * function + axis] } else { 0.0 };
            [0, 1, 2].map(component)
        };
        let corners = (0..mesh.nodes.len()).map(of);
        let middle = |(&[a, b], edge): (&[usize; 2], usize)| midpoint(midpoint(of(a), of(b)), of(edge));
        let middles = mesh.edges.iter().zip(mesh.nodes.len()..).map(middle);
        let displacement: Vec<Point> = corners.chain(middles).collect();
        let places = self.displacements.places();
        // The nodes body by body; at a seam each body has its own.
        let body_of: Vec<usize> = (0..mesh.count()).map(|cell| self.body_of(cell)).collect();
        let functions: Vec<Vec<usize>> = (0..mesh.count()).map(|cell| self.element(kind, cell)).collect();
        let of_cells = functions.iter().zip(&body_of);
        let in_bodies = of_cells.clone().flat_map(|(of_cell, &body)| of_cell.iter().map(move |&of| (body, of)));
        let in_bodies: Vec<(usize, usize)> = in_bodies.collect::<BTreeSet<_>>().into_iter().collect();
        let number = |node: (usize, usize)| in_bodies.partition_point(|other| *other < node);
        let numbered = |(of_cell, &body): (&Vec<usize>, &usize)| of_cell.iter().map(|&of| number((body, of))).collect();
        let elements: Vec<Vec<usize>> = of_cells.map(numbered).collect();
        let (mut boundaries, cells_at) = (vec![Vec::new(); self.problem.boundaries.len()], mesh.cells_at());
        for outer in mesh.surface() {
            for &boundary in &self.problem.conditions[outer.condition].boundaries {
                let body = self.problem.boundaries[boundary].1;
                let cell = cells_at[outer.facet].into_iter().flatten().find(|&cell| body_of[cell] == body);
                let cell = cell.unwrap_or(outer.cell);
                let Some(local) = mesh.sides(cell).iter().position(|&side| side == outer.facet) else { continue };
                let (element, opposite) = (&functions[cell], mesh.cell(cell)[local]);
                let on_side = |face: &&&[usize]| face.iter().all(|&place| element[place] != opposite);
                let face = kind.reference().faces.iter().find(on_side);
                boundaries[boundary].extend(face.map(|face| face.iter().map(|&place| elements[cell][place]).collect()));
            }
        }
        let names = self.problem.boundaries.iter().map(|boundary| boundary.0.clone());
        ContinuumAnswer {
            kind,
            boundaries: names.zip(boundaries).collect(),
            nodes: in_bodies.iter().map(|node| places[node.1]).collect(),
            displacement: in_bodies.iter().map(|node| displacement[node.1]).collect(),
            elements,
            stress: (0..mesh.count()).map(|cell| self.mean_stress(cell)).collect(),
            origins: mesh.origins.clone(),
            shares: self.shares.clone(),
        }
    }

    fn body_of(&self, cell: usize) -> usize {
        let contains = |body: &Range<usize>| body.contains(&self.mesh.origins[cell]);
        self.problem.bodies.iter().position(contains).unwrap_or(0)
    }

    /// The nodes of a simplex in the order of a kind.
    fn element(&self, kind: ElementKind, cell: usize) -> Vec<usize> {
        let (mesh, mut element) = (self.mesh, self.mesh.cell(cell).to_vec());
        let edges = mesh.edges_of(cell);
        if mesh.simplex(cell).oriented_size() < 0.0 {
            element.swap(0, 1);
        }
        for &[from, to] in kind.reference().mid_sides {
            let ends = key(element[from], element[to]);
            let edge = edges.iter().find(|&&edge| mesh.edges[edge] == ends);
            element.extend(edge.map(|edge| mesh.nodes.len() + edge));
        }
        element
    }

    /// The mean over a simplex of both stresses.
    fn mean_stress(&self, cell: usize) -> Tensor {
        let parts = self.mesh.dimension + 1;
        let centre = weights_of_centre(self.mesh.dimension);
        let medium = self.problem.medium(self.mesh.origins[cell]);
        let mut mean = [0.0; 6];
        for k in 0..parts {
            let place = self.mesh.simplex(cell).part(k).at(centre);
            let of_displacement = self.law(cell).stress(self.strain(&self.primal.values, cell, k, centre));
            let elastic = middle(of_displacement, self.elastic_stress(cell, k, centre));
            let own = medium.own_stress(place);
            (0..6).for_each(|entry| mean[entry] += (elastic[entry] + own[entry]) / parts as f64);
        }
        mean
    }
}

/// The distance of a displacement w from others, in the energy norm of the body without springs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judged {
    /// An upper bound of |u - w|; u is exact.
    pub bound: f64,
    /// |v - w|; v is the displacement of the bracket.
    pub from_displacement: f64,
    /// |w|.
    pub norm: f64,
}

/// The strain of a displacement in an element of the first mesh.
pub enum Strain<S> {
    /// The same everywhere.
    Constant(Tensor),
    /// A function of the place that is linear.
    Linear(S),
    /// A function of the place.
    Varying(S),
}

impl Bracket<'_> {
    /// Judges a displacement by its strain in an element of the first mesh. The displacement needs no other property:
    /// the bound follows from its distance to the centre of the ball and the radius. Integrals of a constant or linear
    /// strain are exact; those of others are by five points in each direction on each part of a simplex.
    pub fn judged<S: Fn(Point) -> Tensor>(&self, strain_in: impl Fn(usize) -> Strain<S> + Sync) -> Judged {
        let fine = self.fine_rule();
        let of_cell = |cell: usize| {
            let (simplex, strain) = (self.mesh.simplex(cell), strain_in(self.mesh.origins[cell]));
            let mut at_corners = [[0.0; 6]; MOST_CORNERS];
            match &strain {
                Strain::Constant(strain) => at_corners.fill(*strain),
                Strain::Linear(strain) => {
                    at_corners.iter_mut().zip(simplex.corners()).for_each(|(own, &corner)| *own = strain(corner));
                }
                Strain::Varying(_) => {}
            }
            let squares = |k: usize, at: &Sample| {
                let own = match &strain {
                    Strain::Varying(strain) => strain(at.place),
                    _ => mean(&at_corners, simplex.in_whole(k, at.weights)),
                };
                let law = self.law(cell);
                let of_bracket = self.strain(&self.primal.values, cell, k, at.weights);
                let balanced = law.compliance(self.elastic_stress(cell, k, at.weights));
                [less(own, middle(of_bracket, balanced)), less(own, of_bracket), own]
                    .map(|strain| at.weight * law.square(strain))
            };
            match strain {
                Strain::Varying(_) => self.sums(cell, &fine, squares),
                _ => self.sums(cell, &self.rule(), squares),
            }
        };
        let of_cells = each(self.mesh.count(), of_cell);
        let [from_centre, from_displacement, norm] =
            [0, 1, 2].map(|square| of_cells.iter().map(|cell| cell[square]).sum::<f64>().sqrt());
        Judged { bound: from_centre + self.square_of_radius().max(0.0).sqrt(), from_displacement, norm }
    }

    /// Five points in each direction on a part of a simplex.
    fn fine_rule(&self) -> impl Fn(&Simplex) -> Vec<Sample> + Sync + use<'_> {
        let corners = self.mesh.dimension + 1;
        // On these elements the shape functions are the barycentric coordinates; the weights add up to the size of the
        // reference element.
        let kind = if corners == 3 { ElementKind::LINEAR_TRIANGLE } else { ElementKind::LINEAR_TETRAHEDRON };
        let rule = Tabulated::fine(kind.reference()).points;
        let reference: f64 = rule.iter().map(|point| point.weight).sum();
        move |part| {
            let volume = self.problem.thickness * part.size() / reference;
            let sample = |shape: &[f64], weight: f64| {
                let weights = std::array::from_fn(|corner| if corner < corners { shape[corner] } else { 0.0 });
                let place = part.at(weights);
                Sample { weights, place, weight: weight * volume * self.problem.radius(place), extra: 0.0 }
            };
            rule.iter().map(|point| sample(&point.shape, point.weight)).collect()
        }
    }
}

fn mean(at_corners: &[Tensor], weights: Weights) -> Tensor {
    let mut mean = [0.0; 6];
    for (own, weight) in at_corners.iter().zip(weights) {
        mean.iter_mut().zip(own).for_each(|(sum, part)| *sum += weight * part);
    }
    mean
}
