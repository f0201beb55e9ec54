//! The times of PETSc for the same problems, if petsc4py is installed.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

use signorini::ContactProblem;

/// The result of a solver of PETSc for a problem.
pub struct Peer {
    pub name: String,
    pub seconds: f64,
    pub iterations: usize,
    pub closed: usize,
}

/// An interpreter that has petsc4py.
pub struct Interpreter {
    program: &'static str,
    /// Search path for its modules.
    path: OsString,
}

/// Interpreters that may have petsc4py: the first of the search path, and that of the system, for which Debian installs
/// it.
const PROGRAMS: [&str; 2] = ["python3", "/usr/bin/python3"];

/// The folders of Debian's builds of PETSc, `/usr/lib/petscdir/VERSION/BUILD`.
const BUILDS: &str = "/usr/lib/petscdir";

impl Interpreter {
    /// Returns the first interpreter that has petsc4py.
    pub fn find() -> Option<Self> {
        let inside = |folder: &Path| -> Vec<PathBuf> {
            std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()).collect()
        };
        let builds = inside(Path::new(BUILDS)).into_iter().flat_map(|version| inside(&version));
        let modules = builds.map(|build| build.join("lib/python3/dist-packages"));
        let path = std::env::join_paths(modules).unwrap_or_default();
        let interpreter = |program| Interpreter { program, path: path.clone() };
        PROGRAMS.into_iter().map(interpreter).find(|interpreter| {
            let run = interpreter.command().args(["-c", "from petsc4py import PETSc"]).output();
            run.is_ok_and(|output| output.status.success())
        })
    }

    /// Returns a command that runs the interpreter on one thread.
    fn command(&self) -> Command {
        let mut command = Command::new(self.program);
        command.env("PYTHONPATH", &self.path).env("OMP_NUM_THREADS", "1");
        command
    }
}

/// Runs all suitable solvers of PETSc on a problem. The list is empty if the rows of the problem are not simple bounds.
///
/// # Errors
/// Those of writing the problem and of starting the interpreter.
pub fn peers(interpreter: &Interpreter, problem: &ContactProblem) -> std::io::Result<Vec<Peer>> {
    let folder = std::env::temp_dir().join(format!("signorini-kinds-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    for file in &problem.files()[..4] {
        std::fs::write(folder.join(file.name), file.text())?;
    }
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("reference/petsc_bounds.py");
    let output = interpreter.command().arg(script).arg(&folder).output();
    std::fs::remove_dir_all(&folder)?;
    let printed = String::from_utf8_lossy(&output?.stdout).into_owned();
    Ok(printed.lines().filter_map(peer).collect())
}

fn peer(line: &str) -> Option<Peer> {
    let mut words = line.split_whitespace();
    let name = words.next()?.to_string();
    let seconds = words.next()?.parse().ok()?;
    Some(Peer { name, seconds, iterations: words.next()?.parse().ok()?, closed: words.next()?.parse().ok()? })
}
