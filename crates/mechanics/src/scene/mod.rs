//! Scenes: a JSON text becomes a checked model of bodies, supports, loads and obstacles.
//!
//! ```
//! let text = r#"{
//!     "body": {"rectangle": {"x": {"points": [0, 1], "divisions": [4]}, "y": {"points": [0, 1], "divisions": [4]}}},
//!     "material": {"young": 1e7, "poisson": 0.3},
//!     "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
//!     "obstacles": [{"boundary": "top", "approach": "+y", "shape": {"plane": {"point": [0, 1], "normal": [0, 1]}}}],
//!     "gap": -0.01
//! }"#;
//! let model = signorini_mechanics::Scene::from_json(text, "scene")?.build()?;
//! assert_eq!(model.problem().dofs(), 40);
//! assert_eq!(model.problem().gap(), [-0.01; 5]);
//! # Ok::<(), signorini_mechanics::Error>(())
//! ```

#[doc(hidden)]
pub mod answers;
#[doc(hidden)]
pub mod derivatives;
#[doc(hidden)]
pub mod input;
#[doc(hidden)]
pub mod models;
mod modes;
mod motions;

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use crate::error::Error;
use derivatives::parameter;
use input::absent::absent;
use input::schema::{AnalysisSpec, DynamicSpec, ModesSpec};
use input::{parse, size};
use models::build;
use models::start::first_scene;
use modes::modal_analysis;
use motions::dynamics::dynamics;
use signorini_qp::Settings;

pub use answers::answer::Answer;
pub use answers::segments::{ContactExtent, Segment};
pub use derivatives::sensitivity::{ByParameter, Sensitivities, Sensitivity, outputs_of};
pub use input::body::{Sides, bar, cuboid, disc, half_ball, half_disc, rectangle, ring};
#[doc(hidden)]
pub use input::entry::refused;
pub use input::obstacle::{Inertia, Obstacle, ObstacleRow, PlacedObstacle};
pub use input::schema::{Rule, Scene, Units};
pub use input::size::Size;
pub use input::warning::Warning;
pub use models::model::Model;
pub use models::resultants::Resultant;
pub use models::rows::ContactRow;
pub use models::set_up::{Forces, HeldNode, Hold};
pub use models::unknowns::Meaning;
pub use modes::ModalAnalysis;
pub use motions::dynamics::Dynamics;
pub use motions::moving_supports::WatchedPoint;
use signorini_deck::{DeckScene, Reading};
pub use signorini_deck::{RequestedTable, Requests};

impl Scene {
    /// Reads a scene from JSON text, in which lines that begin with `//` are comments; errors begin with `source_name`.
    ///
    /// # Errors
    /// [`Error::SceneSyntax`] for text that is not JSON, or does not have the form of a scene.
    pub fn from_json(text: &str, source_name: &str) -> Result<Scene, Error> {
        parse::scene_of(text, source_name)
    }

    /// Reads a scene from a JSON file, or from a deck of CalculiX, whose name ends with `.inp`; relative names of other
    /// files start in its folder.
    ///
    /// # Errors
    /// [`File`](signorini_qp::LinearError::File) for a file that cannot be read, and as [`Scene::from_json`] and
    /// [`Scene::read_deck`].
    pub fn read(path: impl AsRef<Path>) -> Result<Scene, Error> {
        parse::read(path.as_ref())
    }

    /// The JSON Schema of scenes, as indented text: fields, choices and the ranges of single numbers. Only
    /// [`Scene::build`] checks conditions between several fields.
    pub fn json_schema() -> String {
        parse::json_schema()
    }

    /// An error of a value with its line and column, if the scene was read from a file that can be read again. Errors
    /// of decks have their lines.
    pub fn located(error: Error, file: &Path) -> Error {
        parse::located(error, file)
    }

    /// The sentence that a scene with this unknown name is answered with, if other programs give the name to a thing
    /// that is not modelled here.
    pub fn not_modelled(name: &str) -> Option<&'static str> {
        absent(name)
    }

    /// The text of a scene for the mesh `file`, with comment lines; `named` is the name of the file in the scene. The
    /// scene is built before it is returned, so that it is not refused later.
    ///
    /// Groups of elements that share nodes are one body, and the others are further bodies. One is held, one is
    /// pressed, and weak springs keep those that no support holds.
    ///
    /// # Errors
    /// As [`GmshFile::read`](crate::fem::GmshFile::read) and [`GmshFile::mesh`](crate::fem::GmshFile::mesh);
    /// [`Error::Fem`] for a mesh of which no boundary can be held while another is pressed.
    pub fn start(file: &Path, named: &str) -> Result<String, Error> {
        first_scene(file, named)
    }

    /// Reads a deck of CalculiX as a scene, at the end of a step from 1, or of the last one; relative names of files
    /// start in its folder. Files that it includes may lie outside its folder if `permits` has `outside`, and
    /// friction is left out with a warning if it has `friction`.
    ///
    /// # Errors
    /// [`File`](signorini_qp::LinearError::File) for a file that cannot be read;
    /// [`FileSyntax`](signorini_qp::LinearError::FileSyntax) with the line for what is wrong, and for what changes the
    /// answer and is not modelled.
    pub fn read_deck(path: impl AsRef<Path>, permits: &[&str], step: Option<usize>) -> Result<Scene, Error> {
        parse::read_deck(path.as_ref(), Reading { permits, step, earlier: &[] }).map(|(scene, ..)| scene)
    }

    /// Reads one step of a deck, from 1, as [`Scene::read_deck`] does, and what it asks for. `earlier` are the
    /// displacements at the ends of the steps before it, in length and radians, of all nodes by their numbers, which a
    /// card `*BOUNDARY, FIXED` holds
    /// ([`Answer::displacements_of_deck`](crate::scene::Answer::displacements_of_deck)).
    ///
    /// # Errors
    /// As [`Scene::read_deck`]; [`FileSyntax`](signorini_qp::LinearError::FileSyntax) with the line for results of a
    /// set that does not exist.
    pub fn read_step(
        path: impl AsRef<Path>,
        permits: &[&str],
        step: usize,
        earlier: &[HashMap<usize, [f64; 6]>],
    ) -> Result<(Scene, Requests), Error> {
        let (scene, deck, references) =
            parse::read_deck(path.as_ref(), Reading { permits, step: Some(step), earlier })?;
        Ok((scene, Requests::of(&deck, references)?))
    }

    /// The text of the scene of a deck, with comment lines; `named` is the name of the deck in the scene. The scene is
    /// not built.
    pub fn text_of_deck(file: &Path, named: &str, permits: &[&str], step: Option<usize>) -> Result<String, Error> {
        DeckScene::read(file, named, Reading { permits, step, earlier: &[] })
            .map(|scene| scene.text)
            .map_err(Error::from)
    }

    /// Returns `true` for the name of an input deck, which ends with `.inp`: such a file is read by
    /// [`Scene::read_deck`].
    pub fn is_deck(file: impl AsRef<Path>) -> bool {
        signorini_deck::is_deck(file.as_ref())
    }

    /// Estimates the size of the scene without building it; of a named file only the length is read.
    pub fn size(&self) -> Size {
        size::estimated(self)
    }

    /// Refuses a scene that would take more than `most` bytes. [`Scene::build`] refuses a scene with too many nodes at
    /// its divisions.
    ///
    /// # Errors
    /// [`qp::Error::TooLarge`](signorini_qp::Error::TooLarge).
    pub fn check_size(&self, most: f64) -> Result<(), Error> {
        let size = self.size();
        size.check([size.bytes, size.factor_entries], most)
    }

    /// As [`Scene::check_size`], for methods that may do without a factor.
    ///
    /// # Errors
    /// [`qp::Error::TooLarge`](signorini_qp::Error::TooLarge).
    pub fn check_size_without_factor(&self, most: f64) -> Result<(), Error> {
        let size = self.size();
        size.check([size.bytes.min(size.multigrid_bytes), 0.0], most)
    }

    /// As [`Scene::check_size`], for commands that only build the model and solve nothing.
    ///
    /// # Errors
    /// [`qp::Error::TooLarge`](signorini_qp::Error::TooLarge).
    pub fn check_size_of_model(&self, most: f64) -> Result<(), Error> {
        let size = self.size();
        size.check([size.model_bytes, 0.0], most)
    }

    /// The scene with every cell of its bodies cut into `times` parts along each edge; graded meshes are nested.
    ///
    /// # Errors
    /// [`Error::Scene`] for `times` 0, and for a body from a mesh file, which cannot be refined.
    pub fn refined(&self, times: usize) -> Result<Scene, Error> {
        size::refined(self, times)
    }

    /// Discretises the scene and sets up its contact problem.
    ///
    /// # Errors
    /// [`Error::Scene`] for a value that describes no problem; of a deck
    /// [`qp::LinearError::FileSyntax`](signorini_qp::LinearError::FileSyntax) with its line;
    /// [`qp::Error::UnderHeld`](signorini_qp::Error::UnderHeld) for a rigid-body mode that neither supports nor
    /// obstacles resist.
    pub fn build(&self) -> Result<Model, Error> {
        self.build_with(&[])
    }

    /// The same with user-defined obstacles after those of the scene, each with the name of the boundary that may touch
    /// it.
    ///
    /// # Errors
    /// As [`Scene::build`]; [`Error::Scene`] for a boundary that does not exist, and for a direction or a normal that
    /// is not of unit length or leads out of the model.
    pub fn build_with(&self, further: &[(&str, Arc<dyn Obstacle>)]) -> Result<Model, Error> {
        build::within(self, f64::INFINITY, further)
    }

    /// As [`Scene::build`], for a scene that may take at most `most` bytes.
    ///
    /// # Errors
    /// As [`Scene::build`]; [`qp::Error::TooLarge`](signorini_qp::Error::TooLarge) before the assembly of bodies that
    /// are too large.
    pub fn build_within(&self, most: f64) -> Result<Model, Error> {
        build::within(self, most, &[])
    }

    /// The specification of the motion, if the scene has one.
    pub fn dynamic(&self) -> Option<&DynamicSpec> {
        let Some(AnalysisSpec::Dynamic(spec)) = &self.analysis else { return None };
        Some(spec)
    }

    /// The motion of `model`, which this scene built; `None` for a static scene.
    ///
    /// # Errors
    /// [`Error::Scene`] for a value that describes no motion, an initial penetration, a step beyond the stable one.
    pub fn dynamics(&self, model: &Model) -> Result<Option<Dynamics>, Error> {
        dynamics(self, model)
    }

    /// The request for modes, if the scene has one.
    pub fn modes(&self) -> Option<&ModesSpec> {
        let Some(AnalysisSpec::Modes(spec)) = &self.analysis else { return None };
        Some(spec)
    }

    /// The `count` lowest natural vibrations of the scene about its equilibrium.
    ///
    /// ```
    /// use signorini_mechanics::Scene;
    /// use signorini_qp::Settings;
    ///
    /// // A bar of length 1 with waves of speed 1, held at one end: f = 1/4, 3/4, 5/4, ...
    /// let scene = Scene::from_json(
    ///     r#"{
    ///         "model": "bar",
    ///         "body": {"bar": {"area": 1, "x": {"points": [0, 1], "divisions": [100]}}},
    ///         "material": {"young": 1, "poisson": 0, "density": 1},
    ///         "supports": [{"on": {"boundary": "left"}, "x": 0}],
    ///         "analysis": {"modes": {"count": 2}}
    ///     }"#,
    ///     "bar",
    /// )?;
    /// let found = scene.modal_analysis(2, &Settings::default())?;
    /// assert!((found.modes[0].frequency - 0.25).abs() < 1e-5 && (found.modes[1].frequency - 0.75).abs() < 1e-3);
    /// # Ok::<(), signorini_mechanics::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Scene`] for a count of zero or above 1000, and for a material without density; those of
    /// [`Scene::build`], of the equilibrium, and of the factorisations.
    pub fn modal_analysis(&self, count: usize, settings: &Settings) -> Result<ModalAnalysis, Error> {
        modal_analysis(self, count, settings)
    }

    /// The names of all numbers of the scene by which outputs have derivatives, and `nodes`.
    pub fn parameters(&self) -> Vec<String> {
        parameter::all(self).into_iter().map(|parameter| parameter.name).collect()
    }

    /// The same scene with another value of the parameter of this name; `loads[0]` is a factor of that load.
    ///
    /// # Errors
    /// [`Error::Scene`] for a name that does not exist, with those that do, and for a value that the scene does not
    /// allow.
    pub fn with_parameter(&self, name: &str, value: f64) -> Result<Scene, Error> {
        parameter::named(self, name).and_then(|found| parameter::varied(self, &found, value - found.value))
    }

    /// The names of the outputs that have derivatives; `X,Y` stands for the coordinates of a place.
    pub fn outputs(&self) -> Result<Vec<String>, Error> {
        self.build().map(|model| outputs_of(&model))
    }

    /// Solves the scene, and gives the derivatives of `outputs` with respect to `parameters`, by their names: see
    /// [`Scene::parameters`] and [`Scene::outputs`].
    ///
    /// ```
    /// use signorini_mechanics::Scene;
    /// use signorini_qp::{Derivative, Settings};
    ///
    /// // A bar of 2 m and 5000 N/m, pulled with 20 N towards a wall at 0.001 m: the wall takes 20 - 5000 x 0.001 = 15 N.
    /// let scene = Scene::from_json(
    ///     r#"{
    ///         "model": "bar", "gap": 0.001,
    ///         "body": {"bar": {"area": 0.01, "x": {"points": [0, 2], "divisions": [4]}}},
    ///         "material": {"young": 1e6, "poisson": 0},
    ///         "supports": [{"on": {"boundary": "left"}, "x": 0}],
    ///         "loads": [{"traction": {"boundary": "right", "value": [2000]}}],
    ///         "obstacles": [{"boundary": "right", "approach": "+x", "shape": {"plane": {"point": [2], "normal": [1]}}}]
    ///     }"#,
    ///     "bar",
    /// )?;
    /// let found = scene.sensitivity(&["force"], &["gap", "young", "loads[0]"], &Settings::default())?;
    /// let of = |place: usize| match found.outputs[0].by[place].derivative {
    ///     Derivative::Proven(value) => value,
    ///     _ => f64::NAN,
    /// };
    /// assert!((of(0) + 5000.0).abs() < 1e-6 && (of(1) + 5e-6).abs() < 1e-15 && (of(2) - 20.0).abs() < 1e-9);
    /// # Ok::<(), signorini_mechanics::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Scene`] for a name that does not exist, with those that do, and for a scene of a motion; those of
    /// [`Scene::build`] and of [`signorini_qp::solve`].
    pub fn sensitivity(
        &self,
        outputs: &[&str],
        parameters: &[&str],
        settings: &Settings,
    ) -> Result<Sensitivities, Error> {
        Sensitivities::of(self, Arc::new(self.build()?), outputs, parameters, settings)
    }
}
