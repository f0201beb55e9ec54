//! The arguments. Types of the argument parser are used only here and in `shell`, which describes them to shells and
//! manuals.

mod choice;
mod limits;

use std::path::PathBuf;
use std::str::FromStr;

use clap::{ArgGroup, Args, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;

use super::line::{Line, parse_line};
use super::memory::parse_size;
use crate::output::{Medium, Pictures, Wanted};
use crate::qp::Method;
use crate::study::TotalErrorGoal;
use choice::{choice, extrapolation, precision};
use limits::DeckOptions;
pub(super) use limits::Limits;

/// Frictionless contact of elastic bodies with obstacles: a convex QP, cross-checked and certified.
#[derive(Debug, Parser)]
#[command(name = "signorini", version, arg_required_else_help = true)]
#[command(after_help = "\
Exit codes: 0 certified, 1 bad input or file, 2 usage, 3 infeasible, unbounded or not held,
            4 not certified or an unstable motion, 130 interrupted, with the results so far.

Example: signorini compare examples/indentation.json --out indentation")]
pub(super) struct Arguments {
    /// Print each step on a line of standard error as it begins
    #[arg(long, global = true, conflicts_with = "quiet")]
    pub progress: bool,
    /// Show no progress on a terminal; warnings and errors remain
    #[arg(long, global = true)]
    pub quiet: bool,
    #[command(subcommand)]
    pub command: Command,
}

/// The meaning of three similar options.
const KNOBS: &str = "\
--tolerance bounds the violation of the contact conditions, --accuracy the error of the displacement,
--time the seconds of the program.";

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Write a first scene for a mesh of Gmsh: its groups, a support, a plate that a force presses
    #[command(after_help = "Example: signorini new part.msh --out part.json")]
    New(New),
    /// Draw a scene before it is solved: body, mesh, supports, loads, obstacles, gap
    #[command(after_help = "Example: signorini draw examples/indentation.json --out set-up.png")]
    Draw(Draw),
    /// Solve a scene, a problem directory or a complementarity problem, and certify the answer
    #[command(after_help = format!("\
Example: signorini solve examples/ball.json --accuracy 1e-3 --time 10 --out ball
         signorini solve problem --explain --start earlier

{KNOBS}"))]
    Solve(Solve),
    /// Solve by three methods and print their differences
    #[command(after_help = "Example: signorini compare examples/indentation.json --out indentation")]
    Compare(Compare),
    /// Solve a scene at several gaps or forces, or a problem directory on the way to another end
    #[command(after_help = "\
Example: signorini sweep examples/indentation.json --gaps -0.01:-0.10:10 --out sweep
         signorini sweep problem --points 11

A problem directory is swept from g.mtx and f.mtx to g1.mtx and f1.mtx, on a straight line.")]
    Sweep(Sweep),
    /// Solve a scene, and print the derivatives of its outputs with respect to its numbers, with the proof that they
    /// exist
    #[command(after_help = "\
Example: signorini sensitivity examples/indentation.json --of force,width --to gap,young,obstacles[0].radius
         signorini sensitivity examples/indentation.json --of stress@0.5,0.4:xx --to nodes --out derivatives

A name that does not exist is answered with those that do.")]
    Sensitivity(Sensitivity),
    /// Solve a scene or a problem directory by every method, and print the seconds that each digit costs
    #[command(after_help = "Example: signorini tradeoff examples/indentation.json --refinements 2 --time 60")]
    Tradeoff(Tradeoff),
    /// Solve a deck as the program ccx of CalculiX does: NAME.inp is answered by NAME.frd, NAME.dat, NAME.sta and the
    /// folder NAME.signorini
    #[command(arg_required_else_help = false)]
    #[command(after_help = "\
Example: signorini ccx -i cube

The program does the same if it is called ccx: through a link or a copy of that name.")]
    Ccx(Ccx),
    /// Write the problem of a scene as Matrix Market or PETSc files
    #[command(after_help = "\
Example: signorini export examples/ball.json ball
         signorini export examples/ball.json ball --format petsc

Before it begins it prints the number of bytes that it writes on standard error; they go to the files piece by piece.")]
    Export(Export),
    /// Certify an answer of another program
    #[command(after_help = "\
Example: signorini verify problem --displacement u.mtx --multiplier lambda.mtx
         signorini verify lcp --z z.mtx

The energy error is bounded with a factor of the stiffness if that fits into the memory and the time; else by multigrid,
and the bound then rests on a measured eigenvalue.")]
    Verify(Verify),
    /// Print the JSON Schema of a scene
    #[command(after_help = "\
Example: signorini schema > scene.schema.json
An editor completes and checks a scene that begins with {\"$schema\": \"scene.schema.json\", ...")]
    Schema,
    /// Print the completions of a shell
    #[command(after_help = "\
Example: signorini completions bash > ~/.local/share/bash-completion/completions/signorini")]
    Completions(Completions),
    /// Print the page of the manual, in roff
    #[command(after_help = "\
Example: signorini man > ~/.local/share/man/man1/signorini.1")]
    Man,
}

#[derive(Debug, Args)]
pub(super) struct Completions {
    /// The shell
    #[arg(value_enum)]
    pub shell: Shell,
}

#[derive(Debug, Args)]
pub(super) struct Draw {
    /// Scene (a JSON file, - for standard input)
    pub scene: PathBuf,
    /// File for the picture; its ending, png or svg, says which
    #[arg(long, value_name = "FILE", value_parser = parse_picture)]
    pub out: Picture,
    #[command(flatten)]
    pub limits: Limits,
}

/// A file for a picture.
#[derive(Clone, Debug)]
pub(super) enum Picture {
    Png(PathBuf),
    Svg(PathBuf),
}

fn parse_picture(text: &str) -> Result<Picture, String> {
    let path = PathBuf::from(text);
    match path.extension().map(|ending| ending.to_ascii_lowercase()) {
        Some(ending) if ending == "png" => Ok(Picture::Png(path)),
        Some(ending) if ending == "svg" => Ok(Picture::Svg(path)),
        _ => Err("the name of the picture must end in .png or .svg".to_string()),
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Format {
    /// For reading
    Text,
    /// One object, for other programs
    Json,
}

impl Common {
    /// The pictures to draw; `usual` without the option.
    pub fn wanted(&self, usual: Pictures) -> Wanted {
        Wanted { pictures: self.pictures.unwrap_or(usual), medium: self.style }
    }
}

#[derive(Debug, Args)]
pub(super) struct Solve {
    /// Scene (a JSON file, - for standard input), deck of CalculiX (a .inp file), problem directory (with K.mtx,
    /// f.mtx, B.mtx, g.mtx, or the same as .petsc) or directory of a complementarity problem (with M.mtx, q.mtx, and
    /// for bounds other than 0 and infinity lower.mtx, upper.mtx)
    pub input: PathBuf,
    /// Method that finds the contact set
    #[arg(long, value_parser = choice::<Method>(), default_value = "auto")]
    pub method: Method,
    /// Allowed relative error in the energy norm, certified; or `exact`: the linear solve with the final contact set
    #[arg(long, value_name = "A", allow_negative_numbers = true, value_parser = parse_accuracy)]
    pub accuracy: Option<Accuracy>,
    /// Seconds after which the best answer so far is returned, or a motion ends
    #[arg(long, visible_alias = "time-limit", value_name = "T", allow_negative_numbers = true, value_parser = parse_seconds)]
    pub time: Option<f64>,
    /// Print the estimated seconds and memory of each method, and the reason for the choice
    #[arg(long)]
    pub explain: bool,
    /// Print what would be tried, in order, each with its condition and its reason, and solve nothing
    #[arg(long, conflicts_with_all = ["total_error", "resume"])]
    pub plan: bool,
    /// Start from the answer that an earlier run with --out wrote into this folder (u.mtx, lambda.mtx)
    #[arg(long, value_name = "FOLDER", conflicts_with_all = ["total_error", "resume"])]
    pub start: Option<PathBuf>,
    /// Precision of the sparse factor, which is double
    #[arg(long, hide = true, value_parser = precision)]
    pub precision: Option<()>,
    /// Do not prove which rows are open and closed
    #[arg(long)]
    pub no_proof: bool,
    /// Extrapolate the penalty answer to an infinite penalty, which no method does
    #[arg(long, hide = true, num_args = 0, default_missing_value = "", value_parser = extrapolation)]
    pub extrapolate: Option<()>,
    /// Refine the mesh until the error against the continuum, relative in the energy norm, is below E: guaranteed,
    /// but estimated for several bodies in space and for a few keys; the report says which
    #[arg(long, value_name = "E", allow_negative_numbers = true, value_parser = parse_total_error,
          conflicts_with_all = ["accuracy", "resume"])]
    pub total_error: Option<f64>,
    /// Refine further until the contact force is guaranteed to this relative error
    #[arg(long, value_name = "E", allow_negative_numbers = true, value_parser = parse_total_error, requires = "total_error")]
    pub force_error: Option<f64>,
    /// Write the answer along a line into along.csv and onto the page: displacement, stress, and the pressure on a
    /// contact. In space X1,Y1,Z1:X2,Y2,Z2; may be given several times
    #[arg(long, value_name = "X1,Y1:X2,Y2", allow_hyphen_values = true, value_parser = parse_line, requires = "out",
          conflicts_with_all = ["total_error", "resume", "plan"])]
    pub along: Vec<Line>,
    /// Estimate the errors of peak force, impulse and release of a motion by two more runs: with half the step, and
    /// with half the cells too
    #[arg(long, conflicts_with_all = ["total_error", "plan"])]
    pub refine_in_time: bool,
    /// Continue the motion in the folder of --out; the scene may have a longer duration than before
    #[arg(long, requires = "out")]
    pub resume: bool,
    #[command(flatten)]
    pub common: Common,
}

#[derive(Debug, Args)]
pub(super) struct New {
    /// Mesh (a .msh file of Gmsh), or an input deck of CalculiX (a .inp file)
    pub mesh: PathBuf,
    #[command(flatten)]
    pub deck: DeckOptions,
    /// File for the scene; standard output if it is left out
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(super) struct Compare {
    /// Scene (a JSON file), problem directory (with K.mtx, f.mtx, B.mtx, g.mtx, or the same as .petsc) or directory of
    /// a complementarity problem (with M.mtx, q.mtx)
    pub input: PathBuf,
    #[command(flatten)]
    pub common: Common,
}

#[derive(Debug, Args)]
#[command(group(ArgGroup::new("over").required(true).args(["gaps", "forces", "points"])))]
pub(super) struct Sweep {
    /// Scene (a JSON file) or problem directory (with K.mtx, f.mtx, B.mtx, g.mtx, or the same as .petsc, and g1.mtx or
    /// f1.mtx or both for its other end)
    pub scene: PathBuf,
    /// Gaps from the first to the last, and their number, such as -0.01:-0.10:10
    #[arg(long, value_name = "FIRST:LAST:COUNT", allow_hyphen_values = true, value_parser = parse_gaps)]
    pub gaps: Option<Gaps>,
    /// Forces on the obstacle that a force presses, from the first to the last, and their number, such as 0:10e3:11
    #[arg(long, value_name = "FIRST:LAST:COUNT", allow_hyphen_values = true, value_parser = parse_forces)]
    pub forces: Option<Gaps>,
    /// Number of points between the two ends of a problem directory, both ends included
    #[arg(long, value_name = "COUNT", value_parser = parse_points)]
    pub points: Option<usize>,
    /// Method that finds the contact sets
    #[arg(long, value_parser = choice::<Method>(), default_value = "auto")]
    pub method: Method,
    #[command(flatten)]
    pub common: Common,
}

/// The gaps, or the forces, of a sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Gaps {
    pub first: f64,
    pub last: f64,
    pub count: usize,
}

/// A sweep keeps every answer in memory: more points than this would not fit.
const MOST_GAPS: usize = 10_000;

fn parse_gaps(text: &str) -> Result<Gaps, String> {
    parse_range(text, "gap", "it must be FIRST:LAST:COUNT, such as -0.01:-0.10:10")
}

fn parse_points(text: &str) -> Result<usize, String> {
    allowed(text, |points| (2..=MOST_GAPS).contains(points), || format!("a whole number from 2 to {MOST_GAPS}"))
}

fn parse_forces(text: &str) -> Result<Gaps, String> {
    let form = "it must be FIRST:LAST:COUNT, such as 0:10e3:11";
    let forces = parse_range(text, "force", form)?;
    match forces.first.min(forces.last) {
        least if least < 0.0 => Err(format!("{least} would pull the obstacle away: forces are 0 or positive; {form}")),
        _ => Ok(forces),
    }
}

fn parse_range(text: &str, of: &str, form: &str) -> Result<Gaps, String> {
    let parts: Vec<&str> = text.split(':').collect();
    let [first, last, count] = parts[..] else { return Err(form.to_string()) };
    let number = |part: &str| match part.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("`{part}` is not a finite number; {form}")),
    };
    let count = match count.parse() {
        Ok(count) if (1..=MOST_GAPS).contains(&count) => count,
        _ => return Err(format!("`{count}` is not a whole number from 1 to {MOST_GAPS}; {form}")),
    };
    let gaps = Gaps { first: number(first)?, last: number(last)?, count };
    if count == 1 && gaps.first != gaps.last {
        return Err(format!("one {of} cannot be both {first} and {last}; {form}"));
    }
    Ok(gaps)
}

fn parse_seconds(text: &str) -> Result<f64, String> {
    let form = || "a positive number of seconds, such as 2.5".to_string();
    allowed(text, |value: &f64| value.is_finite() && *value > 0.0, form)
}

/// The value of an option, or the form that it must have.
fn allowed<T: FromStr>(text: &str, is_allowed: fn(&T) -> bool, form: impl Fn() -> String) -> Result<T, String> {
    text.parse().ok().filter(is_allowed).ok_or_else(|| format!("it must be {}", form()))
}

/// A relative error above this has no meaning.
const LARGEST_TOLERANCE: f64 = 0.1;

fn parse_tolerance(text: &str) -> Result<f64, String> {
    let form = || format!("a number above 0 and at most {LARGEST_TOLERANCE}, such as 1e-9: it is a relative error");
    allowed(text, |&value| value > 0.0 && value <= LARGEST_TOLERANCE, form)
}

fn parse_total_error(text: &str) -> Result<f64, String> {
    allowed(text, |&value| TotalErrorGoal::is_allowed(value), || TotalErrorGoal::ALLOWED.to_string())
}

/// The value of `--accuracy`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Accuracy {
    /// The direct solution with a factor and the settled contact set.
    Exact,
    /// This error, relative in the energy norm.
    Within(f64),
}

fn parse_accuracy(text: &str) -> Result<Accuracy, String> {
    match text {
        "exact" => Ok(Accuracy::Exact),
        number => parse_tolerance(number).map(Accuracy::Within).map_err(|_| {
            format!("it must be a number above 0 and at most {LARGEST_TOLERANCE}, such as 1e-3, or `exact`")
        }),
    }
}

/// More threads than any machine has would only cost memory.
const MOST_THREADS: usize = 1024;

fn parse_threads(text: &str) -> Result<usize, String> {
    allowed(text, |threads| (1..=MOST_THREADS).contains(threads), || format!("a whole number from 1 to {MOST_THREADS}"))
}

/// The options of every solving command.
#[derive(Debug, Args)]
pub(super) struct Common {
    /// Relative tolerance of the certificate
    #[arg(long, default_value = "1e-9", value_name = "T", allow_negative_numbers = true, value_parser = parse_tolerance)]
    pub tolerance: f64,
    /// Let the methods work on all dofs instead of those of the contact rows
    #[arg(long)]
    pub no_condense: bool,
    /// Threads [default: those of the machine, up to 8, where they pay, and one elsewhere]
    #[arg(long, value_name = "N", value_parser = parse_threads)]
    pub threads: Option<usize>,
    #[command(flatten)]
    pub limits: Limits,
    /// Folder for pictures, fields and answers
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Pictures in that folder [default: answer; of compare and sweep: all]
    #[arg(long, value_parser = choice::<Pictures>(), value_name = "WHICH")]
    pub pictures: Option<Pictures>,
    /// Use of the pictures: on a screen, or printed on paper
    #[arg(long, value_parser = choice::<Medium>(), default_value = "screen")]
    pub style: Medium,
    /// Form of the report
    #[arg(long, value_enum, default_value_t = Format::Text)]
    pub format: Format,
}

#[derive(Debug, Args)]
pub(super) struct Sensitivity {
    /// Scene (a JSON file, - for standard input)
    pub scene: PathBuf,
    /// Outputs, such as force, width, peak-pressure, obstacles[0].travel, pressure@0.5,1, stress@0.5,0.4:xx
    #[arg(long, value_name = "OUTPUTS", required = true)]
    pub of: Vec<String>,
    /// Parameters, such as gap, young, loads[0], obstacles[0].radius, or nodes for the places of all nodes [default:
    /// all numbers]
    #[arg(long, value_name = "PARAMETERS")]
    pub to: Vec<String>,
    /// Name the rows that make a kink, or that the proof leaves undecided
    #[arg(long)]
    pub explain: bool,
    /// Method that finds the contact set
    #[arg(long, value_parser = choice::<Method>(), default_value = "auto")]
    pub method: Method,
    #[command(flatten)]
    pub common: Common,
}

#[derive(Debug, Args)]
pub(super) struct Tradeoff {
    /// Scene (a JSON file) or problem directory (with K.mtx, f.mtx, B.mtx, g.mtx; it has no mesh to refine)
    pub input: PathBuf,
    /// Finer meshes beside the scene's own, each with half the cells; 1 if neither this nor --time is given
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(0..=8))]
    pub refinements: Option<u8>,
    /// Begin no finer mesh that would end later than T seconds after the start; without --refinements the time alone
    /// limits the meshes
    #[arg(long, value_name = "T", allow_negative_numbers = true, value_parser = parse_seconds)]
    pub time: Option<f64>,
    /// Runs of each point, of which the fastest counts
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub runs: u16,
    /// Meshes of more dofs are solved on the contact boundary only
    #[arg(long, value_name = "DOFS", default_value_t = 10_000)]
    pub most_full_dofs: usize,
    #[command(flatten)]
    pub limits: Limits,
    /// Folder for the table, its values and the pictures
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Pictures in that folder; answer and all are the same here
    #[arg(long, value_parser = choice::<Pictures>(), value_name = "WHICH", default_value = "answer")]
    pub pictures: Pictures,
    /// Use of the pictures: on a screen, or printed on paper
    #[arg(long, value_parser = choice::<Medium>(), default_value = "screen")]
    pub style: Medium,
    /// Form of the report
    #[arg(long, value_enum, default_value_t = Format::Text)]
    pub format: Format,
}

#[derive(Clone, Debug, Args)]
pub(super) struct Ccx {
    /// Name of the deck, with or without its ending .inp
    #[arg(short = 'i', value_name = "NAME", conflicts_with = "deck")]
    pub job: Option<PathBuf>,
    /// The same without -i
    #[arg(value_name = "NAME")]
    pub deck: Option<PathBuf>,
    /// Print the version of CalculiX whose decks and files these are
    #[arg(short = 'v')]
    pub version: bool,
    #[command(flatten)]
    pub limits: Limits,
}

impl Ccx {
    /// The options of `solve` for the same deck, with a folder for its page.
    pub fn solve(&self, input: PathBuf, out: PathBuf) -> Option<Solve> {
        let words = ["signorini", "solve", "--", "deck.inp"];
        let Command::Solve(mut options) = Arguments::try_parse_from(words).ok()?.command else { return None };
        (options.input, options.common.out) = (input, Some(out));
        options.common.limits = self.limits.clone();
        Some(options)
    }
}

#[derive(Debug, Args)]
pub(super) struct Export {
    /// Scene (a JSON file); for the form lcp also a problem directory
    pub scene: PathBuf,
    /// Folder for K, f, B, g and the other files of the problem; made if missing
    pub directory: PathBuf,
    /// Form of the files
    #[arg(long, value_enum, default_value_t = Form::MatrixMarket)]
    pub format: Form,
    #[command(flatten)]
    pub limits: Limits,
}

/// The form of an exported problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Form {
    /// Text: K.mtx, f.mtx, B.mtx, g.mtx, near_null.mtx
    MatrixMarket,
    /// The complementarity problem of the forces z = -lambda, dense: M.mtx, q.mtx, and rows.mtx with the contact row of
    /// each z; for bodies that only contact holds also lower.mtx, upper.mtx, and the motions R.mtx
    Lcp,
    /// Binary, in blocks of nodes: K.petsc, f.petsc, B.petsc, g.petsc, coordinates.petsc, free.petsc, near_null.petsc
    Petsc,
}

#[derive(Debug, Args)]
pub(super) struct Verify {
    /// Problem directory (with K.mtx, f.mtx, B.mtx, g.mtx, or the same as .petsc) or directory of a complementarity
    /// problem (with M.mtx, q.mtx)
    pub directory: PathBuf,
    /// Displacement u of the free dofs
    #[arg(long, value_name = "u.mtx", required_unless_present = "z")]
    pub displacement: Option<PathBuf>,
    /// Contact multiplier lambda of the contact rows, negative in compression
    #[arg(long, value_name = "lambda.mtx", required_unless_present = "z")]
    pub multiplier: Option<PathBuf>,
    /// Unknowns z of a complementarity problem
    #[arg(long, value_name = "z.mtx", conflicts_with_all = ["displacement", "multiplier", "equality_multiplier"])]
    pub z: Option<PathBuf>,
    /// Multiplier mu of the equality rows of E.mtx, of either sign
    #[arg(long, value_name = "mu.mtx")]
    pub equality_multiplier: Option<PathBuf>,
    /// Relative tolerance of the certificate
    #[arg(long, default_value = "1e-9", value_name = "T", allow_negative_numbers = true, value_parser = parse_tolerance)]
    pub tolerance: f64,
    /// Most seconds that a factor of the stiffness may take, by an estimate
    #[arg(long, default_value = "60", value_name = "T", allow_negative_numbers = true, value_parser = parse_seconds)]
    pub factor_time: f64,
    /// Threads of the factorisation and of multigrid [default: as `solve`]
    #[arg(long, value_name = "N", value_parser = parse_threads)]
    pub threads: Option<usize>,
    /// Refuse a problem that needs more memory, such as 500MB or 1.5GB [default: what the machine has available]
    #[arg(long, value_name = "SIZE", value_parser = parse_size)]
    pub max_memory: Option<f64>,
    /// Form of the report
    #[arg(long, value_enum, default_value_t = Format::Text)]
    pub format: Format,
}

impl Command {
    /// The form in which this command reports.
    pub fn format(&self) -> Format {
        match self {
            Command::Solve(Solve { common, .. })
            | Command::Compare(Compare { common, .. })
            | Command::Sweep(Sweep { common, .. })
            | Command::Sensitivity(Sensitivity { common, .. }) => common.format,
            Command::Tradeoff(options) => options.format,
            Command::Verify(options) => options.format,
            Command::New(_) | Command::Ccx(_) | Command::Draw(_) | Command::Export(_) => Format::Text,
            Command::Schema | Command::Completions(_) | Command::Man => Format::Text,
        }
    }

    /// The number of threads that was asked for.
    pub fn threads(&self) -> Option<usize> {
        match self {
            Command::Solve(Solve { common, .. })
            | Command::Compare(Compare { common, .. })
            | Command::Sweep(Sweep { common, .. })
            | Command::Sensitivity(Sensitivity { common, .. }) => common.threads,
            Command::Verify(options) => options.threads,
            _ => None,
        }
    }
}
