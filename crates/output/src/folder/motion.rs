//! The output of a motion in a folder while it runs: its history, a series of fields for ParaView, and a checkpoint.
//!
//! Everything is written at the end of a frame: the lines of the history since the last one, the fields, the list of
//! the series, and finally the checkpoint. If a run is stopped at any time, its files can be read, and the run can be
//! resumed. The memory does not grow with the number of steps.

use std::fmt::Write as _;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use signorini_qp as qp;

use super::fields::fields;
use super::motion_table::MotionTable;
use crate::draw::animation::animate;
use crate::file::{remove_files, write_atomically};
use crate::json::compact_json;
use crate::page::{About, MotionFrames, write_motion_page};
use crate::picture::body::{ContactPicture, FieldPanel, common_window};
use crate::picture::plane_scene::{PlaneScene, lines};
use crate::plots::medium::Medium;
use crate::plots::plot::line_plots_for;
use crate::plots::ticks::amount;
use crate::view::curves::history_plots;
use crate::view::field::Source;
use signorini_mechanics::Error;
use signorini_mechanics::motion::{Observation, State};
use signorini_mechanics::scene::{Answer, Model, Resultant, Scene, WatchedPoint};
use signorini_qp::ContactSet;
use signorini_qp::file::read_text_capped;
use signorini_study::MotionSummary;

/// Most bytes of a table of a motion: more than any motion that can be kept writes.
const MOST_OF_TABLE: u64 = 4 << 30;

const HISTORY: &str = "history.csv";
const WATCH: &str = "watch.csv";
const RESULTANTS: &str = "resultants.csv";
const CHECKPOINT: &str = "checkpoint.json";
const HEADING: &str = "time,force,closed,penetration,kinetic,strain,potential,energy,mean_force\n";

/// Largest number of points of a plot over time; if there are more steps, some are left out.
const MOST_POINTS: usize = 4000;

/// Pixels of the animation for one pixel of the drawing, and the duration of one frame.
const SCALE: f64 = 0.5;
const MILLISECONDS: u16 = 80;

/// The folder of a run: a history of each step, fields for ParaView, and a checkpoint from which the run can be
/// resumed.
#[derive(Debug)]
pub struct MotionFolder {
    folder: PathBuf,
    /// The scene in one line: a run resumes only from its own checkpoint.
    scene: String,
    history: MotionTable,
    /// The resultant of each obstacle and support.
    resultants: MotionTable,
    /// The watched points with their table; `None` if the scene names no points.
    watch: Option<(Vec<WatchedPoint>, MotionTable)>,
    /// Times of the frames so far.
    times: Vec<f64>,
}

/// A written state.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Frame {
    time: f64,
    displacement: Vec<f64>,
    multiplier: Vec<f64>,
    closed: Vec<usize>,
    /// How far each obstacle has moved; empty if none moves by a table.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    moved: Vec<f64>,
}

/// The state of a run.
#[derive(Debug, Serialize, Deserialize)]
struct Checkpoint {
    scene: String,
    #[serde(flatten)]
    state: State,
    closed: Vec<usize>,
    history_bytes: u64,
    resultants_bytes: u64,
    watch_bytes: u64,
    frame_times: Vec<f64>,
    summary: MotionSummary,
}

impl MotionFolder {
    /// A new run of `scene` in `folder`, with the watched points of `model`; it overwrites the files of an earlier run.
    ///
    /// # Errors
    /// [`qp::LinearError::File`].
    pub fn new(folder: &Path, scene: &Scene, model: &Model, watched: &[WatchedPoint]) -> Result<Self, Error> {
        let scene = compact_json(scene)?;
        // A checkpoint of an earlier run would belong to another history, and so would its table of points.
        remove_files(folder, &[CHECKPOINT, WATCH])?;
        MotionFolder::with_tables(folder, scene, model, watched, |path, heading, _| MotionTable::new(path, heading))
    }

    /// A run without frames, whose tables `open` opens: each at its path, with its heading, by its number.
    fn with_tables(
        folder: &Path,
        scene: String,
        model: &Model,
        watched: &[WatchedPoint],
        open: impl Fn(PathBuf, &str, usize) -> Result<MotionTable, Error>,
    ) -> Result<Self, Error> {
        let history = open(folder.join(HISTORY), HEADING, 0)?;
        let resultants = open(folder.join(RESULTANTS), &resultants_heading(model), 1)?;
        let watch = match watch_heading(model, watched) {
            Some(heading) => Some((watched.to_vec(), open(folder.join(WATCH), &heading, 2)?)),
            None => None,
        };
        Ok(MotionFolder { folder: folder.into(), scene, history, resultants, watch, times: Vec::new() })
    }

    /// The run of `scene` in `folder`, with its state and its numbers; lines after its checkpoint are cut off. The
    /// duration and the frames of the scene may differ from those of the earlier run.
    ///
    /// # Errors
    /// [`qp::LinearError::File`] if there is no run, [`Error::Scene`] for the run of another scene or a checkpoint that
    /// cannot be read.
    pub fn resume(
        folder: &Path,
        scene: &Scene,
        model: &Model,
        watched: &[WatchedPoint],
    ) -> Result<(Self, State, MotionSummary), Error> {
        let scene = compact_json(scene)?;
        let path = folder.join(CHECKPOINT);
        let text = read_text_capped(&path, MOST_OF_TABLE).map_err(|error| match error {
            qp::LinearError::File { path, source, .. } => qp::LinearError::File { action: "resume from", path, source },
            other => other,
        })?;
        let wrong = |message: String| qp::LinearError::FileSyntax { file: path.clone(), line: 1, message };
        let found: Checkpoint =
            serde_json::from_str(&text).map_err(|error| not_ours(&path, "checkpoint of a motion", &error))?;
        if found.scene != scene && undated(&found.scene) != undated(&scene) {
            return Err(wrong("it belongs to another scene; give that scene, or another folder".into()).into());
        }
        let bytes = [found.history_bytes, found.resultants_bytes, found.watch_bytes];
        let run = MotionFolder::with_tables(folder, scene, model, watched, |path, heading, table| {
            MotionTable::resume(path, heading, bytes[table])
        })?;
        let mut state = found.state;
        state.contact_set = closed_of(state.multiplier.len(), &found.closed);
        Ok((MotionFolder { times: found.frame_times, ..run }, state, found.summary))
    }

    /// Adds a line to the history, to the resultants, and to the watched points: `seen` with the mean force over the
    /// window of the peak, the current state of `integrator`, and the `resultants` of its last step, as
    /// [`Dynamics::resultants`](signorini_mechanics::scene::Dynamics::resultants).
    ///
    /// # Errors
    /// [`qp::LinearError::File`]; [`qp::LinearError::Length`] for the state of another model.
    pub fn observe(
        &mut self,
        model: &Model,
        (seen, mean_force): (&Observation, f64),
        state: &State,
        resultants: &[Resultant],
    ) -> Result<(), Error> {
        let Observation { time, force, closed, penetration, kinetic, strain, potential, .. } = seen;
        let energy = seen.energy();
        self.history.add(&format!(
            "{time:e},{force:e},{closed},{penetration:e},{kinetic:e},{strain:e},{potential:e},{energy:e},{mean_force:e}"
        ))?;
        self.resultants.add(&resultants_line(model, seen.time, resultants))?;
        let Some((watched, table)) = &mut self.watch else { return Ok(()) };
        let nodal = [
            model.nodal_displacement(&state.displacement)?,
            model.nodal_velocity(&state.velocity)?,
            model.contact_forces(&state.multiplier)?,
        ];
        let mut line = format!("{time:e}");
        for value in
            watched.iter().flat_map(|point| nodal.each_ref().map(|of| point.value(of, model.mesh().dimension())))
        {
            for component in value {
                let _ = write!(line, ",{component:e}");
            }
        }
        table.add(&line)
    }

    /// Writes a frame of the series with the velocities, the table lines up to this frame, and the checkpoint.
    ///
    /// # Errors
    /// [`qp::LinearError::File`], and those of the recovery of stresses.
    pub fn frame(
        &mut self,
        model: &Arc<Model>,
        time: f64,
        state: &State,
        summary: &MotionSummary,
    ) -> Result<(), Error> {
        self.history.write()?;
        self.resultants.write()?;
        self.watch.as_mut().map_or(Ok(()), |(_, table)| table.write())?;
        let (number, closed) = (self.times.len(), state.contact_set.iter().collect::<Vec<usize>>());
        let answer = Answer::new(model.clone(), &state.displacement, &state.multiplier, &state.contact_set)?;
        let vtu = fields(&Source { answer: &answer, velocity: Some(&model.nodal_velocity(&state.velocity)?) })?;
        write_atomically(&self.folder.join(vtu_name(number)), vtu.as_bytes())?;
        let frame = Frame {
            time,
            displacement: state.displacement.clone(),
            multiplier: state.multiplier.clone(),
            closed: closed.clone(),
            moved: model.moved_obstacles().to_vec(),
        };
        write_atomically(&self.frame_path(number), compact_json(&frame)?.as_bytes())?;
        self.times.push(time);
        write_atomically(&self.folder.join("series.pvd"), self.series().as_bytes())?;
        let checkpoint = Checkpoint {
            scene: self.scene.clone(),
            state: state.clone(),
            closed,
            history_bytes: self.history.bytes(),
            resultants_bytes: self.resultants.bytes(),
            watch_bytes: self.watch.as_ref().map_or(0, |(_, table)| table.bytes()),
            frame_times: self.times.clone(),
            summary: summary.clone(),
        };
        write_atomically(&self.folder.join(CHECKPOINT), compact_json(&checkpoint)?.as_bytes())
    }

    /// The list of the series for ParaView.
    fn series(&self) -> String {
        let mut text = String::from(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n<Collection>\n",
        );
        for (number, time) in self.times.iter().enumerate() {
            let _ = writeln!(text, "<DataSet timestep=\"{:e}\" part=\"0\" file=\"{}\"/>", time, vtu_name(number));
        }
        text + "</Collection>\n</VTKFile>\n"
    }

    fn frame_path(&self, number: usize) -> PathBuf {
        self.folder.join(format!("frames/{number:05}.json"))
    }

    fn read_frame(&self, model: &Arc<Model>, number: usize) -> Result<(f64, Answer), Error> {
        let path = self.frame_path(number);
        let text = read_text_capped(&path, MOST_OF_TABLE)?;
        let frame: Frame = serde_json::from_str(&text).map_err(|error| not_ours(&path, "frame of a motion", &error))?;
        let set = closed_of(model.rows().len(), &frame.closed);
        let model = match frame.moved.is_empty() {
            true => model.clone(),
            false => Arc::new(model.with_moved_obstacles(&frame.moved)?),
        };
        Ok((frame.time, Answer::new(model, &frame.displacement, &frame.multiplier, &set)?))
    }

    /// Draws force and energies over time (`history`), and an animation of a body in the plane (`motion.png`).
    ///
    /// # Errors
    /// [`qp::LinearError::File`], and those of the recovery of stresses and of the rasteriser.
    pub fn draw(&self, model: &Arc<Model>) -> Result<(), Error> {
        self.draw_for(model, Medium::Screen)
    }

    /// The same for a screen or for paper; the animation is the same for both.
    ///
    /// # Errors
    /// Those of [`Self::draw`].
    pub fn draw_for(&self, model: &Arc<Model>, medium: Medium) -> Result<(), Error> {
        let history = self.read_history()?;
        let plots = history_plots(model, &history);
        line_plots_for(medium, model.title(), &plots).write(&self.folder, "history")?;
        if model.mesh().dimension() != 2 {
            return Ok(());
        }
        let scene = |number: usize| -> Result<PlaneScene, Error> {
            let (time, shown) = self.read_frame(model, number)?;
            let title = format!("{}, t = {}", model.title(), amount(time, model.units().time()));
            Ok(PlaneScene::new(&shown, title)?.in_place())
        };
        // First the limits that all frames share, then the frames: only one is in memory at a time.
        let (mut limits, mut window) = ([f64::INFINITY, f64::NEG_INFINITY], None);
        for number in 0..self.times.len() {
            let shown = scene(number)?;
            let fields = shown.fields();
            let [low, high] = fields[0].limits;
            limits = [limits[0].min(low), limits[1].max(high)];
            let outlines = shown.obstacles(1.0);
            let lines = lines(&outlines);
            window = Some(common_window(window.into_iter().chain([shown.picture(&[], &lines, 1.0).window()])));
        }
        let animation = animate(self.times.len(), SCALE, MILLISECONDS, |number| {
            let shown = scene(number)?;
            let outlines = shown.obstacles(1.0);
            let lines = lines(&outlines);
            let field = shown.fields().into_iter().take(1).map(|field| FieldPanel { limits, ..field });
            let fields: Vec<FieldPanel> = field.collect();
            ContactPicture { window, ..shown.picture(&fields, &lines, 1.0) }.draw()
        })?;
        write_atomically(&self.folder.join("motion.png"), &animation)
    }

    /// Writes `report.html`, with the same report object as in `report.json`.
    ///
    /// # Errors
    /// [`qp::LinearError::File`], and those of the recovery of stresses.
    pub fn write_page(&self, model: &Arc<Model>, about: &About, report: &impl Serialize) -> Result<(), Error> {
        let answer = |number: usize| self.read_frame(model, number).map(|(_, answer)| answer);
        let history = self.read_history()?;
        let frames = MotionFrames { history: &history, times: &self.times, answer: &answer };
        write_motion_page(&self.folder, about, model, report, &frames)
    }

    /// The rows of the history; if it is long, only some rows, each with the largest force since the previous one.
    fn read_history(&self) -> Result<Vec<[f64; 9]>, Error> {
        let path = self.folder.join(HISTORY);
        let fail = |source| qp::LinearError::File { action: "read", path: path.clone(), source };
        let open = || std::fs::File::open(&path).map(BufReader::new).map_err(fail);
        let count = open()?.lines().count();
        let every = count.div_ceil(MOST_POINTS).max(1);
        let (mut rows, mut force) = (Vec::new(), 0.0_f64);
        for (number, line) in open()?.lines().enumerate().skip(1) {
            let line = line.map_err(fail)?;
            let mut row = [f64::NAN; 9];
            row.iter_mut().zip(line.split(',')).for_each(|(value, text)| *value = text.parse().unwrap_or(f64::NAN));
            force = force.max(row[1]);
            if number % every == 0 || every == 1 {
                row[1] = force;
                force = 0.0;
                rows.push(row);
            }
        }
        Ok(rows)
    }
}

/// The contact set of `rows` rows with the rows of `closed` closed; an index beyond the last row is ignored.
fn closed_of(rows: usize, closed: &[usize]) -> ContactSet {
    let mut set = ContactSet::open(rows);
    closed.iter().for_each(|&row| set.insert(row));
    set
}

/// The columns of the resultants: force, moment and centre of each obstacle, of each support, and of each spring, and
/// the travel of an obstacle with a mass.
fn resultants_heading(model: &Model) -> String {
    let axes = &["x", "y", "z"][..model.mesh().dimension()];
    let turns: &[&str] = match (axes.len(), model.body().formulation().is_axisymmetric()) {
        (2, false) => &["z"],
        (3, _) => axes,
        _ => &[],
    };
    let mut heading = String::from("time");
    let travels = model.obstacles().iter().map(|obstacle| obstacle.inertia().is_some()).chain(std::iter::repeat(false));
    let names = model.obstacle_names().into_iter().chain(model.support_names()).chain(model.spring_names());
    for (name, has_travel) in names.zip(travels) {
        for (quantity, axes) in [("f", axes), ("m", turns), ("c", axes)] {
            axes.iter().for_each(|axis| {
                let _ = write!(heading, ",{name} {quantity}_{axis}");
            });
        }
        if has_travel {
            let _ = write!(heading, ",{name} travel");
        }
    }
    heading + "\n"
}

/// A line of the resultants at one time: first the obstacles, then the supports, then the springs; cells are empty for
/// resultants that are not given.
fn resultants_line(model: &Model, time: f64, resultants: &[Resultant]) -> String {
    let mut line = format!("{time:e}");
    for of in resultants {
        // A zero force has no centre.
        let centre = (0..of.force.len()).map(|axis| of.centre.as_ref().map(|at| at[axis]));
        for value in of.force.iter().chain(&of.moment).copied().map(Some).chain(centre).chain(of.travel.map(Some)) {
            let _ = match value {
                Some(value) => write!(line, ",{value:e}"),
                None => write!(line, ","),
            };
        }
    }
    let columns = resultants_heading(model).matches(',').count();
    let missing = columns.saturating_sub(line.matches(',').count());
    line + &",".repeat(missing)
}

/// The heading of the table of points, `time` and then u, v and f of each along the axes; `None` without points.
fn watch_heading(model: &Model, watched: &[WatchedPoint]) -> Option<String> {
    let axes = &["x", "y", "z"][..model.mesh().dimension()];
    let columns = |point: &WatchedPoint| -> String {
        let of =
            |quantity: &str| axes.iter().map(|axis| format!(",{} {quantity}_{axis}", point.name)).collect::<String>();
        ["u", "v", "f"].map(of).concat()
    };
    (!watched.is_empty()).then(|| format!("time{}\n", watched.iter().map(columns).collect::<String>()))
}

/// Error for a file that is not the output of a run; it quotes no content, which may be private.
fn not_ours(path: &Path, what: &str, error: &serde_json::Error) -> Error {
    let message = format!("it is not a {what} (column {})", error.column());
    qp::LinearError::FileSyntax { file: path.into(), line: error.line().max(1), message }.into()
}

/// The scene without the fields that may differ when a run is resumed: duration and number of frames.
fn undated(scene: &str) -> Option<serde_json::Value> {
    let mut scene: serde_json::Value = serde_json::from_str(scene).ok()?;
    let motion = scene.pointer_mut("/analysis/dynamic")?.as_object_mut()?;
    ["duration", "frames"].iter().for_each(|field| drop(motion.remove(*field)));
    Some(scene)
}

fn vtu_name(number: usize) -> String {
    format!("series-{number:05}.vtu")
}
