//! The tutorial agrees with the program: its commands run and print the shown output.

use std::fs;
use std::path::Path;

use support::program::Desk;

/// A fenced block of a document.
struct Block {
    kind: String,
    text: String,
}

fn blocks(document: &str) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut open: Option<Block> = None;
    for line in document.lines() {
        match (line.strip_prefix("```"), &mut open) {
            (Some(_), Some(_)) => blocks.extend(open.take()),
            (Some(kind), None) => open = Some(Block { kind: kind.into(), text: String::new() }),
            (None, Some(block)) => block.text += &format!("{line}\n"),
            (None, None) => {}
        }
    }
    blocks
}

/// The words of a text, separated by single spaces, because a report breaks its lines at other places.
fn words(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn the_commands_of_the_first_part_print_what_the_tutorial_shows() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let document = fs::read_to_string(root.join("docs/first-part.md")).unwrap();
    let desk = Desk::new();
    desk.write("foot.msh", fs::read(root.join("examples/first-part/foot.msh")).unwrap());
    let (mut printed, mut shown) = (String::new(), 0);
    for block in blocks(&document) {
        match block.kind.as_str() {
            "json" => {
                desk.write("foot.json", &block.text);
                let kept = fs::read_to_string(root.join("examples/first-part/foot.json")).unwrap();
                assert_eq!(kept, block.text, "the scene of the tutorial equals the kept one");
            }
            "sh" => {
                printed.clear();
                for command in block.text.lines() {
                    let arguments: Vec<&str> = command.split_whitespace().collect();
                    assert_eq!(arguments[0], "signorini", "{command}");
                    printed += &desk.run(&arguments[1..]).ends_with(0).stdout;
                }
                printed += &fs::read_to_string(desk.path("first.json")).unwrap();
                printed = words(&printed);
            }
            "text" => {
                for line in block.text.lines() {
                    assert!(printed.contains(&words(line)), "{line:?} is not in the output: {printed}");
                    shown += 1;
                }
            }
            other => panic!("the tutorial has a block of {other}"),
        }
    }
    assert!(shown > 8, "{shown}");
    for file in ["solution.vtu", "contact.csv"] {
        assert!(desk.path("answer").join(file).exists(), "{file}");
    }
}
