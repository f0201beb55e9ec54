//! Warnings: models that can be solved but may mislead, with a remedy.

use crate::fem::ElementKind;

/// A fact about a scene that a reader of its answer should know.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Warning {
    /// Elements lock if the material is nearly incompressible.
    #[error(
        "Poisson's ratio {poisson} locks {element} elements: pressures can come out several times too large; take \
         `\"integration\": \"mean-dilatation\"` with {} elements, a smaller ratio, or compare with a finer mesh \
         before using them",
        ElementKind::of_mean_dilatation("or").to_lowercase()
    )]
    NearlyIncompressible {
        /// Poisson's ratio of the material, near 0.5.
        poisson: f64,
        /// Short name of the element that locks, as `Q4`.
        element: &'static str,
    },
    /// The materials of one body differ much in stiffness.
    #[error(
        "the materials {}have Young's moduli from {soft:e} to {stiff:e}, a factor of {ratio:.1e}: stresses and strains of the soft \
         one lose digits next to the stiff one, and the error of the mesh gathers at their interface; compare with a finer mesh, or take \
         the stiff part as a support or an obstacle",
        if body.is_empty() { String::new() } else { format!("of `{body}` ") }
    )]
    StiffnessJump {
        /// The name of a further body; empty for the first.
        body: String,
        /// The largest modulus, in force per area.
        stiff: f64,
        /// The smallest modulus, in force per area.
        soft: f64,
        /// The largest modulus over the smallest.
        ratio: f64,
    },
    /// Young's modulus is far above that of every material in the units of the scene.
    #[error(
        "Young's modulus {young:e} is in {force}/{length}2, the units of this scene, {times:.0} times that of diamond: if it is given in Pa, \
         write {meant:e}; steel has {steel:e} {force}/{length}2"
    )]
    UnitOfYoung {
        /// The modulus, in force per area.
        young: f64,
        /// The unit of its numerator, as `N`.
        force: String,
        /// The unit whose square divides it, as `mm`.
        length: String,
        /// The modulus over that of diamond.
        times: f64,
        /// The number of the modulus in the units of the scene if it was given in pascals.
        meant: f64,
        /// The modulus of steel in the units of the scene.
        steel: f64,
    },
    /// No node of the candidate boundary faces the obstacle.
    #[error(
        "obstacles[{obstacle}] faces no node of its boundary: the body is solved without it; check its place, \
         its approach direction and its radius"
    )]
    NoContactRow {
        /// Number of the obstacle without rows, from 0.
        obstacle: usize,
    },
    /// Nothing of two boundaries faces the other.
    #[error(
        "{obstacle}: no facet of `{boundary}` faces `{other}` within reach: both bodies are solved without this contact; check the \
         boundaries, the approach direction and `reach`"
    )]
    NoFacingFacet {
        /// Place of the obstacle without facing facets in the scene, as `obstacles[0]`.
        obstacle: String,
        /// Name of the boundary that would carry the rows.
        boundary: String,
        /// Name of the boundary of the other body, which faces nothing.
        other: String,
    },
    /// Two boundaries cover each other only in part.
    #[error(
        "{obstacle}: {:.1} % of the area of `{boundary}` face `{other}`, and {:.1} % of the nodes of `{other}` face `{boundary}`: where nothing faces them, the \
         bodies can go through each other; name boundaries that contain the whole contact",
        100.0 * share, 100.0 * of_other
    )]
    PartlyCovered {
        /// Place of the partly covered pair in the scene, as `obstacles[0]`.
        obstacle: String,
        /// Name of the partly covered boundary, which carries the rows.
        boundary: String,
        /// Name of the boundary that faces the carrying one.
        other: String,
        /// Covered share of the area of the carrying boundary.
        share: f64,
        /// Share of the nodes of the other boundary that face the carrying one.
        of_other: f64,
    },
    /// Two surfaces move together across a gap.
    #[error(
        "{tie}: `{boundary}` and `{to}` are tied over distances up to {apart:.2e}: forces along the surfaces turn both bodies over such a \
         distance; move the bodies together, or give a smaller `reach`"
    )]
    TiedApart {
        /// Place of the tie across a gap in the scene, as `ties[0].surfaces`.
        tie: String,
        /// Name of the boundary that takes the means over the gap.
        boundary: String,
        /// Name of the boundary that it is tied to.
        to: String,
        /// Largest distance, in length.
        apart: f64,
    },
    /// Two tied surfaces cover each other only in part.
    #[error(
        "{tie}: {:.1} % of the area of `{boundary}` and {:.1} % of the nodes of `{to}` are tied; the rest is free, and the bodies can go \
         through each other there",
        100.0 * share, 100.0 * of_other
    )]
    PartlyTied {
        /// Place of the partial tie in the scene, as `ties[0].surfaces`.
        tie: String,
        /// Name of the partly tied boundary, which takes the means.
        boundary: String,
        /// Name of the boundary that it is partly tied to.
        to: String,
        /// Tied share of the area of the boundary.
        share: f64,
        /// Share of the nodes of the other boundary that are tied.
        of_other: f64,
    },
    /// Facets that cut the corner of a curve are off by a large part of the gap.
    #[error(
        "{obstacle}: facets stand for curves and miss them by up to {sag:.2e}, while the largest gap is {gap:.2e}: gaps are those of curves \
         through the nodes, which are not known so well; give the distance as `fit`, take quadratic elements, or a finer mesh"
    )]
    Sag {
        /// Place of the obstacle with curved surfaces in the scene, as `obstacles[0]`.
        obstacle: String,
        /// Largest distance of a facet from the curve for which it stands, in length.
        sag: f64,
        /// Largest gap of a row, in length.
        gap: f64,
    },
    /// The other boundary is much coarser than the one that carries the rows.
    #[error(
        "{obstacle}: the facets of `{other}` are {ratio:.1} times as long as those of `{boundary}`: between them the pressure has waves; \
         refine `{other}`"
    )]
    CoarseMaster {
        /// Place of the pair with the coarse surface in the scene, as `obstacles[0]`.
        obstacle: String,
        /// Name of the finer boundary, which carries the rows.
        boundary: String,
        /// Name of the coarse boundary of the other body.
        other: String,
        /// Length of its facets over the length of those that carry rows.
        ratio: f64,
    },
    /// The meshes lie otherwise than the fit says.
    #[error(
        "{obstacle}: the meshes lie {differs:.2e} away from the fit {fit:.2e} (interference is negative): the fit counts; check its value, \
         and that both boundaries are meant"
    )]
    FitDiffers {
        /// Place of the obstacle with the fit in the scene, as `obstacles[0]`.
        obstacle: String,
        /// Largest difference of the distance of the meshes and the fit, in length.
        differs: f64,
        /// The gap of the fit, in length.
        fit: f64,
    },
    /// Most candidates of an obstacle are held by supports.
    #[error(
        "{held} of {of} nodes that may touch obstacles[{obstacle}] are held in all directions by supports: the obstacle cannot press on \
         them; free that boundary, or name another one"
    )]
    HeldCandidates {
        /// Number of the obstacle with held candidates, from 0.
        obstacle: usize,
        /// Number of candidate nodes with supports in all directions.
        held: usize,
        /// Number of all candidate nodes of the obstacle.
        of: usize,
    },
    /// Obstacles make the same rows as an earlier one.
    #[error("{}", doubled(*.first, *.second, *.last, *.count))]
    DoubledObstacle {
        /// Number of the earliest obstacle with these rows, from 0.
        first: usize,
        /// Number of the first later obstacle with the same rows.
        second: usize,
        /// The latest obstacle with these rows, numbered from 0.
        last: usize,
        /// Number of the later obstacles with the same rows.
        count: usize,
    },
    /// A load acts on supported dofs only.
    #[error(
        "loads[{load}] acts only on nodes that supports hold: the supports take it and nothing moves; load another \
         boundary"
    )]
    LoadOnSupport {
        /// Number of the load on supported nodes, from 0.
        load: usize,
    },
    /// A force acts on a single node of a body in the plane or in space.
    #[error(
        "loads[{load}] is a force on a single node: displacement and stress there grow with every refinement; spread it over a boundary \
         as a traction if they matter"
    )]
    PointLoad {
        /// Number of the load on a single node, from 0.
        load: usize,
    },
    /// An element is folded at a corner, but not where it is integrated.
    #[error(
        "the Jacobian determinant of element {element} is {value:.2e} at its node at {at:?}, but positive where it is integrated, and so \
         it is for {count} elements: they are solved; stresses at such a corner are not to be trusted; move the node"
    )]
    FoldedCorner {
        /// The number of the first such element: that of a deck, or its place in the mesh from 0.
        element: usize,
        /// The node, one coordinate for each axis, in length.
        at: Vec<f64>,
        /// The determinant there, relative to the size of the element to the power of its dimension, negative.
        value: f64,
        /// Number of such elements.
        count: usize,
    },
    /// A body is cut at a plane of symmetry, but nothing holds the cut.
    #[error(
        "no support holds the boundary `{boundary}`: the body can move across this cut, so that it is not half of a \
         symmetric body; hold the component across the cut"
    )]
    FreeSymmetry {
        /// Name of the boundary at the plane of symmetry.
        boundary: String,
    },
    /// Nodes of one body have the same place.
    #[error(
        "{count} nodes of the mesh have the place of another node, such as nodes {first} and {second} at {at:?}: the parts of the mesh \
         are not joined there; merge these nodes in the mesher, unless a slit is meant"
    )]
    CoincidentNodes {
        /// Index of one such node in the mesh, from 0.
        first: usize,
        /// Index of another node at the same place, from 0.
        second: usize,
        /// Coordinates of the node, `dim` of them, in length.
        at: Vec<f64>,
        /// Number of nodes that share their place with a node before them.
        count: usize,
    },
    /// A deck says something that is answered in another way.
    #[error("{place}: {message}")]
    Deck {
        /// File and line of the card that is answered otherwise, as `part.inp:12`.
        place: String,
        /// A sentence on what is answered instead.
        message: String,
    },
    /// A deck asks for large displacements.
    #[error("{place}: NLGEOM is answered with small displacements")]
    Nonlinear {
        /// File and line of the card that asks for them, as `part.inp:12`.
        place: String,
    },
    /// The scheme can gain energy.
    #[error(
        "the scheme `{scheme}` can gain energy at every impact: it is for comparison only; take `fox-goodwin` or \
         `contact-stabilised` for answers"
    )]
    GainsEnergy {
        /// Its name in scenes, as `trapezoidal`.
        scheme: &'static str,
    },
}

fn doubled(first: usize, second: usize, last: usize, count: usize) -> String {
    if count == 1 {
        return format!(
            "obstacles[{first}] and obstacles[{second}] make the same rows: the shares of the force between the two have no meaning; \
             leave one obstacle out"
        );
    }
    format!(
        "obstacles[{first}] and {count} others, from obstacles[{second}] to obstacles[{last}], make the same rows: the shares of the \
         force among them have no meaning; leave all but one out"
    )
}

impl Warning {
    /// The name of the kind of warning about a scene, the same in every version.
    pub fn code(&self) -> &'static str {
        match self {
            Warning::NearlyIncompressible { .. } => "nearly-incompressible",
            Warning::StiffnessJump { .. } => "stiffness-jump",
            Warning::UnitOfYoung { .. } => "unit-of-young",
            Warning::NoContactRow { .. } => "no-contact-row",
            Warning::NoFacingFacet { .. } => "no-facing-facet",
            Warning::PartlyCovered { .. } => "partly-covered",
            Warning::TiedApart { .. } => "tied-apart",
            Warning::PartlyTied { .. } => "partly-tied",
            Warning::Sag { .. } => "sag",
            Warning::CoarseMaster { .. } => "coarse-master",
            Warning::FitDiffers { .. } => "fit-differs",
            Warning::HeldCandidates { .. } => "held-candidates",
            Warning::DoubledObstacle { .. } => "doubled-obstacle",
            Warning::LoadOnSupport { .. } => "load-on-support",
            Warning::PointLoad { .. } => "point-load",
            Warning::FoldedCorner { .. } => "folded-corner",
            Warning::FreeSymmetry { .. } => "free-symmetry",
            Warning::CoincidentNodes { .. } => "coincident-nodes",
            Warning::Deck { .. } => "deck",
            Warning::Nonlinear { .. } => "nonlinear",
            Warning::GainsEnergy { .. } => "gains-energy",
        }
    }
}
