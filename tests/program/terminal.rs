//! The command line at a terminal: help, standard input and output, and titles with control characters.

use std::fs;
use std::io::Read;
use std::process::Stdio;

use serde_json::json;
use support::program::{Desk, example, scene};

const COMMANDS: [&str; 9] = ["solve", "compare", "sweep", "draw", "export", "verify", "schema", "completions", "man"];

#[test]
fn a_call_without_arguments_shows_the_help() {
    let run = Desk::new().run(&[]).ends_with(2);
    for command in COMMANDS {
        assert!(run.stderr.contains(command), "{}", run.stderr);
    }
    assert!(run.stderr.contains("Exit codes: 0 certified, 1 bad input or file, 2 usage"));
}

#[test]
fn help_of_every_command_names_its_arguments() {
    let desk = Desk::new();
    let common = ["--tolerance <T>", "--out <DIR>", "--format <FORMAT>", "[default: 1e-9]"];
    for (command, arguments) in [
        ("solve", &["<INPUT>", "--method <METHOD>", "active-set", "penalty"][..]),
        ("compare", &["<INPUT>"]),
        ("sweep", &["<SCENE>", "--gaps <FIRST:LAST:COUNT>"]),
        ("export", &["<SCENE>", "<DIRECTORY>"]),
        ("verify", &["<DIRECTORY>", "--displacement <u.mtx>", "--multiplier <lambda.mtx>", "--tolerance <T>"]),
        ("schema", &[]),
    ] {
        let help = desk.run(&[command, "--help"]).ends_with(0).stdout;
        let shared = if ["solve", "compare", "sweep"].contains(&command) { &common[..] } else { &[] };
        for argument in arguments.iter().chain(shared) {
            assert!(help.contains(argument), "{command}: {help}");
        }
    }
    assert!(desk.run(&["--version"]).ends_with(0).stdout.contains(env!("CARGO_PKG_VERSION")));
}

#[test]
fn a_schema_address_a_byte_order_mark_and_standard_input_are_accepted() {
    let desk = Desk::new();
    let mut addressed = scene();
    addressed["$schema"] = json!("scene.schema.json");
    desk.write("addressed.json", format!("\u{feff}{addressed}"));
    desk.run(&["solve", "addressed.json"]).ends_with(0);
    #[cfg(unix)]
    {
        let stdin = fs::File::open(desk.path("addressed.json")).unwrap();
        assert!(desk.command(&["solve", "/dev/stdin"]).stdin(stdin).output().unwrap().status.success());
    }
}

#[test]
fn control_characters_in_a_title_are_escaped() {
    let desk = Desk::new();
    let mut loud = scene();
    loud["title"] = json!("red \u{1b}[31m\nand\u{7} loud \u{202e}duol");
    loud["units"] = json!({"length": "m\n", "force": "N"});
    desk.write("loud.json", loud.to_string());
    for arguments in
        [&["solve", "loud.json"][..], &["compare", "loud.json"], &["sweep", "loud.json", "--gaps", "0:0:1"]]
    {
        let text = desk.run(arguments).ends_with(0).stdout;
        assert!(text.starts_with("red \\u{1b}[31m\\nand\\u{7} loud \\u{202e}duol\n"), "{text:?}");
        assert!(!text.chars().any(|character| character.is_control() && character != '\n'), "{text:?}");
    }
}

#[test]
fn a_closed_reader_causes_no_panic() {
    let desk = Desk::new();
    for arguments in [&["schema"][..], &["solve", &example("indentation"), "--format", "json"], &["--help"], &[]] {
        let mut child = desk.command(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let mut stderr = String::new();
        child.stderr.take().unwrap().read_to_string(&mut stderr).unwrap();
        let code = child.wait().unwrap().code();
        assert_eq!(code, Some(if arguments.is_empty() { 2 } else { 0 }), "{arguments:?}: {stderr}");
        assert!(!stderr.contains("panicked"), "{stderr}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_device_is_reported_with_exit_code_1() {
    let desk = Desk::new();
    let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let output = desk.command(&["schema"]).stdout(full).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8(output.stderr).unwrap().starts_with("error: cannot write to standard output: "));
}
