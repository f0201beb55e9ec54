//! The analysis of a scene: its equilibrium, or, if requested, its motion or its natural vibrations.

use crate::fem::MassForm;
use crate::motion::SchemeSpec;

/// The JSON path of the fields of a motion in a scene.
pub(crate) const PATH: &str = "analysis.dynamic";

/// The JSON path of the fields of a request for modes in a scene.
pub(crate) const MODES: &str = "analysis.modes";

specs! {
/// What is computed beyond the equilibrium; a scene without it is static.
pub enum AnalysisSpec {
    /// The motion from given displacements and velocities.
    Dynamic(Box<DynamicSpec>),
    /// The natural vibrations about the equilibrium.
    Modes(ModesSpec),
}

/// The natural vibrations about the equilibrium: rows that are closed there stay closed. Every material needs a
/// density.
pub struct ModesSpec {
    /// Number of the lowest modes, at most 1000.
    #[schemars(extend("minimum" = 1, "maximum" = 1000))]
    pub count: usize,
}

/// The motion of the bodies: the scene integrated in time. Every material needs a density.
#[serde(rename_all = "kebab-case")]
pub struct DynamicSpec {
    /// Duration, positive, in time.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub duration: f64,
    /// Time step, positive. If it is left out, `courant` determines it.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub step: Option<f64>,
    /// Time step over the time in which a pressure wave crosses the shortest distance between two nodes of an element,
    /// 0.5 if left out. With `central-difference`: the step over the largest stable step, at most 1, and 0.9 if left
    /// out.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub courant: Option<f64>,
    /// The scheme.
    #[serde(default)]
    pub scheme: SchemeSpec,
    /// The form of the mass. If left out: `averaged` for `fox-goodwin`, `lumped` for `central-difference`,
    /// `redistributed` for `midpoint`, `consistent` for the others.
    pub mass: Option<MassForm>,
    /// Damping of `hht`: from -1/3 to 0, -0.1 if left out.
    #[schemars(extend("minimum" = -1.0 / 3.0, "maximum" = 0))]
    pub alpha: Option<f64>,
    /// Stiffness of `penalty` in multiples of the local stiffness of a step, positive; 10 if left out.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub penalty: Option<f64>,
    /// Penetration at which the loop of `penalty-loop` ends, as the norm over all closed rows, relative to the largest
    /// displacement of the body; positive and at most 0.1, 1e-6 if left out.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 0.1))]
    pub threshold: Option<f64>,
    /// Velocity of a node after its impact over that before, in `central-difference`, from 0 to 1; 0 if left out. Above
    /// 0 the energy of a mesh can grow; smaller steps reduce the growth.
    #[schemars(extend("minimum" = 0, "maximum" = 1))]
    pub restitution: Option<f64>,
    /// Rayleigh damping.
    #[serde(default)]
    pub damping: DampingSpec,
    /// Initial displacements and velocities; zero if left out. Of two entries for one body the later one counts.
    #[serde(default)]
    pub initial: Vec<InitialSpec>,
    /// The treatment of nodes that are inside an obstacle at the start of the motion.
    #[serde(default)]
    pub initial_penetration: PenetrationSpec,
    /// The change of the loads of the scene with time; a load that is not mentioned is constant.
    #[serde(default)]
    pub loads_in_time: Vec<LoadInTimeSpec>,
    /// Obstacles that move along their approach direction, with any number of entries for each. Only `fox-goodwin`
    /// follows them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub obstacles_in_time: Vec<ObstacleInTimeSpec>,
    /// States of the body that are written and shown, evenly over the duration, besides the first; at most 10000.
    #[serde(default = "frames")]
    #[schemars(extend("minimum" = 1, "maximum" = 10000))]
    pub frames: usize,
    /// Points with output at every step: time, displacement, velocity and contact force, in `watch.csv` of `--out`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub watch: Vec<WatchSpec>,
}

/// A point with output at every step.
pub enum WatchSpec {
    /// A node of the mesh, from 0.
    Node(usize),
    /// A point of the undeformed body, one entry for each coordinate; values are interpolated in the element around it.
    Point(Vec<f64>),
}
}

fn frames() -> usize {
    60
}

specs! {
/// Rayleigh damping C = `mass` M + `stiffness` K.
#[derive(Default)]
#[serde(default)]
pub struct DampingSpec {
    /// Share of the mass, zero or positive, in one over time.
    #[schemars(extend("minimum" = 0))]
    pub mass: f64,
    /// Share of the stiffness, zero or positive, in time.
    #[schemars(extend("minimum" = 0))]
    pub stiffness: f64,
}

/// Initial displacement and velocity of one body or of all.
pub struct InitialSpec {
    /// Name of a further body; all bodies if left out.
    pub body: Option<String>,
    /// Initial displacement.
    pub displacement: Option<FieldSpec>,
    /// Initial velocity.
    pub velocity: Option<FieldSpec>,
}

/// A linear field: `value + gradient . x`.
pub struct FieldSpec {
    /// Value at the origin, one entry for each coordinate.
    pub value: Vec<f64>,
    /// Rows of the gradient, one row for each component of the field, with one entry for each coordinate; zero if left
    /// out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub gradient: Vec<Vec<f64>>,
}

/// The choices for nodes that start inside an obstacle.
#[derive(Copy, Default, Eq)]
pub enum PenetrationSpec {
    /// An error with the node and the depth.
    #[default]
    Refuse,
    /// The nodes are moved onto the surface before the start.
    Project,
}

/// The change of one load with time.
pub struct LoadInTimeSpec {
    /// Number of the entry of `loads`, from 0.
    pub load: usize,
    /// Its factor over time.
    pub factor: FactorSpec,
}

/// The motion of one rigid obstacle, as that of a cam or of a shaker.
pub struct ObstacleInTimeSpec {
    /// Number of the entry of `obstacles`, from 0.
    pub obstacle: usize,
    /// Its displacement along its approach direction when the factor has grown by 1 since the start, in length; a
    /// negative shift moves it towards the body.
    pub shift: f64,
    /// The factor over time.
    pub factor: FactorSpec,
}

/// A factor over time.
pub enum FactorSpec {
    /// Straight lines between points; constant before the first and after the last.
    Table(FactorTableSpec),
    /// The factor `sin(2 pi frequency t + phase)`.
    Sine(SineSpec),
    /// A straight line from 0 at `start` to 1 at `end`; constant before and after.
    Ramp(IntervalSpec),
    /// Half a sine wave from `start` to `end`; 0 before and after.
    Pulse(IntervalSpec),
}

/// Points of a factor over time.
pub struct FactorTableSpec {
    /// Times, at least one, increasing.
    #[schemars(extend("minItems" = 1))]
    pub times: Vec<f64>,
    /// The factor at each time.
    #[schemars(extend("minItems" = 1))]
    pub factors: Vec<f64>,
}

/// A sine over time.
pub struct SineSpec {
    /// Frequency, positive, in one over time.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub frequency: f64,
    /// Phase at t = 0, in radians.
    #[serde(default)]
    pub phase: f64,
}

/// An interval of time.
pub struct IntervalSpec {
    /// Start of the interval.
    #[serde(default)]
    pub start: f64,
    /// End of the interval, later than its start.
    pub end: f64,
}
}
