//! The description of an element.

/// The largest number of nodes of an element.
pub const MAX_NODES: usize = 20;

/// One value per node of an element; entries beyond its nodes are zero.
pub type PerNode<T> = [T; MAX_NODES];

/// The values of the nodes of an element, followed by zeros.
pub(super) fn padded<T: Copy + Default, const N: usize>(values: [T; N]) -> PerNode<T> {
    let mut all = [T::default(); MAX_NODES];
    all[..N].copy_from_slice(&values);
    all
}

/// The corners of a quadratic element, then the middles of its edges.
pub(super) const fn with_middles<const C: usize, const E: usize, const N: usize>(
    corners: [[f64; 3]; C],
    edges: [[usize; 2]; E],
) -> [[f64; 3]; N] {
    let mut nodes = [[0.0; 3]; N];
    let mut entry = 0;
    while entry < 3 * N {
        let (node, axis) = (entry / 3, entry % 3);
        let [a, b] = if node < C { [node; 2] } else { edges[node - C] };
        nodes[node][axis] = (corners[a][axis] + corners[b][axis]) / 2.0;
        entry += 1;
    }
    nodes
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// A simplex: origin and unit vectors; linear functions have total degree one.
    Simplex,
    /// A product of intervals [-1, 1]; linear functions have degree one in each coordinate.
    Product,
}

/// A point at which an integral over a reference cell takes its integrand, with a weight and the shape functions there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuadraturePoint {
    /// Its place `[xi, eta, zeta]` in the reference cell, dimensionless; zero along axes that the cell does not have.
    pub at: [f64; 3],
    /// Weight; the weights add up to the size of the reference cell.
    pub weight: f64,
}

#[derive(Debug)]
pub struct ReferenceElement {
    /// Short name of the element in messages and tables, as `Q4`.
    pub name: &'static str,
    /// Simplex or product of intervals.
    pub form: Shape,
    /// Dimension of the cell, 0 to 3.
    pub dimension: usize,
    /// Reference coordinates of the nodes; the corners come first.
    pub nodes: &'static [[f64; 3]],
    pub corners: usize,
    /// The two corners next to each mid-side node, in the order of these nodes.
    pub mid_sides: &'static [[usize; 2]],
    /// Local nodes of every face, in the order of the facet's own reference cell, seen from outside counterclockwise.
    pub faces: &'static [&'static [usize]],
    /// Local nodes around each straight cell into which a facet is cut, along the nodes of a line; empty for a cell
    /// that is no facet.
    pub straight: &'static [&'static [usize]],
    /// Values of the shape functions at a reference point.
    pub shape: fn([f64; 3]) -> PerNode<f64>,
    /// Derivatives of the shape functions with respect to the reference coordinates, at a reference point.
    pub derivative: fn([f64; 3]) -> PerNode<[f64; 3]>,
    /// Quadrature that integrates stiffness and constant loads of an undistorted cell exactly.
    pub quadrature: &'static [QuadraturePoint],
    /// The same for a cell of a body of revolution: the radius adds one degree.
    pub quadrature_revolved: &'static [QuadraturePoint],
    /// The number of the element in a file of Gmsh.
    pub gmsh: usize,
    /// The position of each node in an element of a Gmsh file.
    pub gmsh_order: &'static [usize],
    /// The number of the element in a VTK file, with its nodes in the same order.
    pub vtk: u8,
    /// The element in files of CalculiX.
    pub calculix: CalculixCell,
    /// The counts that a cell of a structured mesh adds.
    pub counts: LatticeCounts,
}

/// An element in the files of results of CalculiX.
///
/// # Source
/// K. Wittig, *CalculiX GraphiX User's Manual*, version 2.20, "Element Types"; points and their order as CalculiX 2.20
/// prints strains that are linear in a single element.
#[derive(Debug)]
pub struct CalculixCell {
    /// The number of the type in a file `.frd`.
    pub number: usize,
    /// The local node at each position in an element of that file.
    pub order: &'static [usize],
    /// The points of a layer at which stress and strain are printed.
    pub points: &'static [QuadraturePoint],
    /// The number of layers of points: CalculiX makes solid elements of those in the plane.
    pub layers: usize,
}

/// The counts that a cell of a large structured mesh adds: a quadrilateral or a brick, cut into simplices if the
/// element is a simplex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LatticeCounts {
    /// Nodes that a cell adds.
    pub nodes: f64,
    /// Nodes that a cell adds to a line across it.
    pub line: f64,
    /// Nodes of the elements of a cell together.
    pub connections: f64,
    /// Nodes coupled to a node by the stiffness, the node included, on average.
    pub neighbours: f64,
}

impl LatticeCounts {
    /// For a cell of which no mesh consists.
    pub const NONE: Self = LatticeCounts { nodes: 0.0, line: 0.0, connections: 0.0, neighbours: 0.0 };
}

impl ReferenceElement {
    /// Reference coordinates of the centroid: the mean of the corners.
    pub fn centroid(&self) -> [f64; 3] {
        let corners = &self.nodes[..self.corners];
        [0, 1, 2].map(|axis| corners.iter().map(|corner| corner[axis]).sum::<f64>() / self.corners as f64)
    }

    /// Returns `true` if a reference point is in the cell, or outside by at most `tolerance`.
    pub fn contains(&self, at: [f64; 3], tolerance: f64) -> bool {
        let own = &at[..self.dimension];
        match self.form {
            Shape::Product => own.iter().all(|xi| xi.abs() <= 1.0 + tolerance),
            Shape::Simplex => own.iter().all(|&xi| xi >= -tolerance) && own.iter().sum::<f64>() <= 1.0 + tolerance,
        }
    }

    /// The local nodes in the order of a mirrored element: that of the cell with xi and eta exchanged, or, on a line,
    /// with xi reversed.
    pub fn mirrored(&self) -> Vec<usize> {
        let mirror = |[xi, eta, zeta]: [f64; 3]| match self.dimension {
            1 => [-xi, eta, zeta],
            _ => [eta, xi, zeta],
        };
        let place = |at: [f64; 3]| self.nodes.iter().position(|&node| node == at);
        self.nodes.iter().enumerate().map(|(local, &at)| place(mirror(at)).unwrap_or(local)).collect()
    }
}
