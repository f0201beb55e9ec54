//! Runs the built program in temporary folders, and provides its input.

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{self, Receiver};

use serde_json::Value;
use tempfile::TempDir;

/// The built program. Cargo tells its path only to the tests of its own package, and builds it for them into the folder
/// above that of the tests.
pub fn program() -> PathBuf {
    let test = std::env::current_exe().unwrap();
    let folder = test.ancestors().nth(2).unwrap();
    let program = folder.join(format!("signorini{}", std::env::consts::EXE_SUFFIX));
    assert!(program.exists(), "there is no program at {}", program.display());
    program
}

/// Result of a run.
pub struct Run {
    pub code: i32,
    pub stdout: String,
    pub stderr: String,
}

impl Run {
    /// Standard output as one JSON value.
    pub fn json(&self) -> Value {
        serde_json::from_str(&self.stdout).unwrap_or_else(|error| panic!("{error}: {:?}", self.stdout))
    }

    /// Asserts the exit code, and that nothing panicked.
    #[track_caller]
    pub fn ends_with(self, code: i32) -> Self {
        assert!(!self.stderr.contains("panicked"), "{}", self.stderr);
        assert_eq!(self.code, code, "stdout: {}\nstderr: {}", self.stdout, self.stderr);
        self
    }

    /// Asserts the exit code, and that standard error is one sentence which contains each of `phrases`.
    #[track_caller]
    pub fn fails_with(self, code: i32, phrases: &[&str]) -> Self {
        let run = self.ends_with(code);
        // A line that announces what an export writes is not an error.
        let is_fault = |line: &&str| !line.starts_with("warning: ") && !line.starts_with("writing ");
        let sentences: Vec<&str> = run.stderr.lines().filter(is_fault).collect();
        let [sentence] = sentences[..] else { panic!("standard error is not one sentence: {:?}", run.stderr) };
        assert!(sentence.starts_with("error: "), "{sentence}");
        says(sentence, phrases);
        run
    }
}

/// Asserts that `sentence` is one, is not too long, and contains each of `phrases`.
#[track_caller]
pub fn says(sentence: &str, phrases: &[&str]) {
    assert!(sentence.chars().count() < 1000, "{sentence}");
    assert!(!sentence.chars().any(char::is_control), "{sentence:?}");
    for phrase in phrases {
        assert!(sentence.contains(phrase), "{sentence:?} does not contain {phrase:?}");
    }
}

/// A temporary folder in which the program runs.
pub struct Desk(TempDir);

impl Default for Desk {
    fn default() -> Self {
        Desk(tempfile::tempdir().unwrap())
    }
}

impl Desk {
    pub fn new() -> Self {
        Desk::default()
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        let path = self.path(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, content).unwrap();
    }

    /// Writes a problem directory with the texts of its files.
    pub fn problem(&self, name: &str, files: &Problem) {
        for (file, text) in [("K", &files.k), ("f", &files.f), ("B", &files.b), ("g", &files.g)] {
            self.write(&format!("{name}/{file}.mtx"), text);
        }
    }

    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(program());
        command.args(arguments).current_dir(self.0.path()).stdin(Stdio::null());
        command
    }

    /// The largest resident size of the program until its end, in bytes, as the system counts it.
    pub fn peak(&self, arguments: &[&str]) -> f64 {
        let script = "import os, sys
silent = [(os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0)]
child = os.posix_spawn(sys.argv[1], sys.argv[1:], os.environ, file_actions=silent)
_, status, usage = os.wait4(child, 0)
print(usage.ru_maxrss)
sys.exit(os.waitstatus_to_exitcode(status))";
        // Without it, threads that wait for each other get heaps of their own, a megabyte now and then.
        let output = self.by_python(script).args(arguments).env("MALLOC_ARENA_MAX", "1").output().unwrap();
        assert!(output.status.success(), "{output:?}");
        1024.0 * String::from_utf8(output.stdout).unwrap().trim().parse::<f64>().unwrap()
    }

    /// Starts Python with a script whose first argument is the program. Without `site` and in isolated mode Python is
    /// small: until the program is loaded, its size is counted as that of the program.
    pub fn by_python(&self, script: &str) -> Command {
        let mut python = Command::new("python3");
        python.args(["-I", "-S", "-c", script]).arg(program()).current_dir(self.0.path());
        python
    }

    /// Starts the program with `--progress`, so that a test can follow its steps.
    pub fn start(&self, arguments: &[&str]) -> UnderWay {
        let mut command = self.command(arguments);
        let mut child = command.arg("--progress").stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let said = BufReader::new(child.stderr.take().unwrap());
        let (sender, lines) = mpsc::channel();
        // Standard error is read all the time, so that the program never waits for the test.
        std::thread::spawn(move || said.lines().map_while(Result::ok).try_for_each(|line| sender.send(line)));
        UnderWay { child, lines, stderr: String::new() }
    }

    pub fn run(&self, arguments: &[&str]) -> Run {
        let output = self.command(arguments).output().unwrap();
        Run {
            code: output.status.code().expect("the program ends with an exit code, not by a signal"),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }
}

/// A run of the program that reports its steps.
pub struct UnderWay {
    child: Child,
    lines: Receiver<String>,
    /// Standard error except the steps.
    stderr: String,
}

impl UnderWay {
    /// Waits until the program prints `phrase` on standard error. Returns `false` if the program ends first.
    pub fn waits_for(&mut self, phrase: &str) -> bool {
        std::iter::from_fn(|| self.next_line()).any(|line| line.contains(phrase))
    }

    /// The next line of standard error; `None` if standard error is closed.
    fn next_line(&mut self) -> Option<String> {
        let line = self.lines.recv().ok()?;
        if !line.starts_with("progress: ") {
            self.stderr += &format!("{line}\n");
        }
        Some(line)
    }

    /// Waits until the program begins to print its report. If the report is larger than the buffer of a pipe, the
    /// program then waits for a reader.
    pub fn waits_for_report(&mut self) {
        self.child.stdout.as_mut().unwrap().read_exact(&mut [0]).unwrap();
    }

    /// Interrupts the program as a terminal does; does nothing if it has ended.
    pub fn interrupt(&self) {
        assert!(Command::new("kill").args(["-INT", &self.child.id().to_string()]).status().unwrap().success());
    }

    /// Waits until the program ends; its report is read only if `is_read` is `true`.
    pub fn ends(mut self, is_read: bool) -> Run {
        let mut report = self.child.stdout.take().unwrap();
        let mut stdout = String::new();
        if is_read {
            report.read_to_string(&mut stdout).unwrap();
        }
        let code = self.child.wait().unwrap().code().expect("the program ends with an exit code, not by a signal");
        while self.next_line().is_some() {}
        Run { code, stdout, stderr: self.stderr }
    }
}

/// The files of a problem directory.
#[derive(Clone)]
pub struct Problem {
    pub k: String,
    pub f: String,
    pub b: String,
    pub g: String,
}

/// A vector as a Matrix Market file.
pub fn vector(values: &[&str]) -> String {
    format!("%%MatrixMarket matrix array real general\n{} 1\n{}\n", values.len(), values.join("\n"))
}

/// A sparse matrix as a Matrix Market file: `symmetry`, sizes, entries.
pub fn matrix(symmetry: &str, sizes: &str, entries: &[&str]) -> String {
    let lines = entries.join("\n");
    format!("%%MatrixMarket matrix coordinate real {symmetry}\n{sizes} {}\n{lines}\n", entries.len())
}

impl Problem {
    /// K = [[2, -1], [-1, 2]], f = (1, 1), u_2 <= 0.1: u = (0.55, 0.1), lambda = 2 * 0.1 - 0.55 - 1 = -1.35.
    pub fn right() -> Self {
        Problem {
            k: matrix("symmetric", "2 2", &["1 1 2", "2 1 -1", "2 2 2"]),
            f: vector(&["1", "1"]),
            b: matrix("general", "1 2", &["1 2 1"]),
            g: vector(&["0.1"]),
        }
    }

    /// u_1 <= -1 and u_1 >= 1.
    pub fn infeasible() -> Self {
        let b = matrix("general", "2 2", &["1 1 1", "2 1 -1"]);
        Problem { b, g: vector(&["-1", "-1"]), ..Problem::right() }
    }

    /// The second dof has no support, and its load pulls it away from its obstacle.
    pub fn unbounded() -> Self {
        Problem { k: matrix("symmetric", "2 2", &["1 1 1"]), f: vector(&["1", "-1"]), ..Problem::right() }
    }

    /// The second dof has no support, and no load moves it.
    pub fn under_held() -> Self {
        let b = matrix("general", "1 2", &["1 1 1"]);
        Problem { k: matrix("symmetric", "2 2", &["1 1 1"]), f: vector(&["1", "0"]), b, ..Problem::right() }
    }
}

/// The path of an example scene.
pub fn example(name: &str) -> String {
    let path = crate::root().join("examples").join(format!("{name}.json"));
    path.to_str().unwrap().to_string()
}

/// The names of all example scenes.
pub fn examples() -> Vec<String> {
    let folder = fs::read_dir(crate::root().join("examples")).unwrap();
    let paths = folder.map(|entry| entry.unwrap().path());
    let scenes = paths.filter(|path| path.extension().is_some_and(|extension| extension == "json"));
    let mut names: Vec<String> = scenes.map(|path| path.file_stem().unwrap().to_str().unwrap().to_string()).collect();
    names.sort();
    assert!(names.len() >= 6);
    names
}

/// A small valid scene: a block of 4 x 2 cells under a parabola.
pub fn scene() -> Value {
    serde_json::json!({
        "title": "Small block",
        "body": {"rectangle": {
            "x": {"points": [0, 1], "divisions": [4]},
            "y": {"points": [0, 0.5], "divisions": [2]}
        }},
        "material": {"young": 1e7, "poisson": 0.3},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
        "loads": [{"traction": {"boundary": "top", "value": [0, 1]}}],
        "obstacles": [
            {"boundary": "top", "approach": "+y", "shape": {"parabola": {"apex": [0.5, 0.5], "radius": 1}}}
        ],
        "gap": -0.01
    })
}
