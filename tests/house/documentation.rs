//! Documentation of what users see: it says more than a name, every array has its shape, its unit and its sign, and
//! every function that can fail names its errors. No two items of the crates, public or not, begin with the same
//! sentence.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use crate::imports::{CRATES, House, Source, rust_files};

/// Words that carry no information beside a name.
const EMPTY: [&str; 28] = [
    "a", "an", "and", "are", "as", "at", "be", "by", "each", "for", "from", "has", "have", "in", "is", "it", "its",
    "of", "on", "one", "or", "that", "the", "their", "these", "this", "to", "with",
];

/// Words by which an array has a length and an order.
const SHAPE: [&str; 11] =
    ["length", "entry", "entries", "each", "every", "per", "order", "increasing", "facet", "component", "x"];

/// Words that are a unit, or the lack of one.
const UNIT: [&str; 9] =
    ["unit", "units", "dimensionless", "relative", "degrees", "seconds", "bytes", "pixels", "weights"];

/// Words that are a unit after `in`, as in `in length`.
const IN_UNIT: [&str; 9] = ["length", "force", "time", "area", "mass", "energy", "strain", "m", "N"];

/// Words by which a number has a sign.
const SIGN: [&str; 7] = ["negative", "positive", "compression", "tension", "sign", "<=", ">="];

/// A public item with its documentation.
#[derive(Default)]
struct Item {
    /// File and line.
    place: String,
    /// The type or variant that it belongs to; empty for an item of a module.
    owner: String,
    name: String,
    /// Its first lines of code: type or signature.
    declaration: String,
    documentation: String,
}

impl Item {
    /// The documentation before its errors, without examples.
    fn prose(&self) -> String {
        let text = self.documentation.split("# Errors").next().unwrap();
        text.split("```").step_by(2).collect()
    }

    fn words(&self) -> Vec<String> {
        let prose = self.prose();
        let bare = |word: &str| word.trim_matches(|c: char| !c.is_alphanumeric() && !"<>=".contains(c)).to_string();
        prose
            .split(|c: char| c.is_whitespace() || "/-,".contains(c))
            .map(bare)
            .filter(|word| !word.is_empty())
            .collect()
    }

    fn has(&self, words: &[&str]) -> bool {
        self.words().iter().any(|word| words.contains(&word.as_str()))
    }

    fn has_unit(&self) -> bool {
        let words = self.words();
        let is_after = |pair: &[String]| pair[0] == "in" && IN_UNIT.contains(&pair[1].as_str());
        self.has(&UNIT) || words.windows(2).any(is_after) || self.prose().contains("force per")
    }

    /// Words that follow neither from the name nor from grammar.
    fn further_words(&self) -> BTreeSet<String> {
        let own: BTreeSet<String> = parts(&self.name).chain(parts(&self.owner)).collect();
        let words = self.words().into_iter().map(|word| singular(&word.to_lowercase()));
        words.filter(|word| !own.contains(word) && !EMPTY.contains(&word.as_str())).collect()
    }

    /// What a reader misses in it.
    fn faults(&self) -> Vec<&'static str> {
        let is_page = self.owner.is_empty();
        let has_example = self.documentation.contains("```");
        let first = self.words().into_iter().next().unwrap_or_default();
        let errors = self.documentation.split_once("# Errors").map(|(_, errors)| errors);
        let is_array = ["Vec<f64>", "[f64", "[[f64", "Vec<[f64", "Vec<usize>", "[usize]"];
        let is_array = is_array.iter().any(|array| self.declaration.contains(array));
        // Matrices and vectors of `qp/linear` may have any unit.
        let needs_unit = is_array && self.declaration.contains("f64") && !self.place.contains("qp/linear");
        let needs_sign = needs_unit && ["gap", "multiplier", "pressure"].iter().any(|name| self.name.ends_with(name));
        let names_errors = |errors: &str| errors.contains('`') || self.declaration.contains(", String>");
        [
            ("repeats its name", self.further_words().len() < if is_page { 6 } else { 2 } && !has_example),
            ("asks", self.prose().contains('?') || ["What", "Which", "How", "Where", "Why"].contains(&first.as_str())),
            ("has no `# Errors`", self.declaration.contains("-> Result<") && !errors.is_some_and(names_errors)),
            ("has an array without a length or an order", is_array && !self.has(&SHAPE) && !self.prose().contains('[')),
            ("has an array without a unit", needs_unit && !self.has_unit()),
            ("has an array without a sign", needs_sign && !self.has(&SIGN)),
        ]
        .into_iter()
        .filter_map(|(fault, is_there)| is_there.then_some(fault))
        .collect()
    }
}

/// The words of a name: `contact_rows` and `ContactRow` have `contact` and `row`.
fn parts(name: &str) -> impl Iterator<Item = String> {
    let spaced: String = name.chars().flat_map(|c| c.is_uppercase().then_some(' ').into_iter().chain([c])).collect();
    spaced.split([' ', '_', ':']).map(|part| singular(&part.to_lowercase())).collect::<Vec<_>>().into_iter()
}

fn singular(word: &str) -> String {
    let is_plural = word.len() > 3 && word.ends_with('s') && !word.ends_with("ss");
    word[..word.len() - usize::from(is_plural)].to_string()
}

/// The leading word of a code.
fn name_in(code: &str) -> String {
    code.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
}

/// The type of an inherent `impl`.
fn implemented(line: &str) -> Option<String> {
    let rest = line.strip_prefix("impl").filter(|_| !line.contains(" for "))?;
    let rest = match rest.strip_prefix('<') {
        Some(generic) => generic.split_once("> ")?.1,
        None => rest.trim_start(),
    };
    Some(name_in(rest))
}

/// What a line of code declares to every user, inside `owner`: its name, and what it opens for the lines inside it.
fn declared(code: &str, indent: usize, owner: &str, inside: &str) -> Option<String> {
    let public = code.strip_prefix("pub ");
    let item = |code: &str| {
        let code = ["unsafe ", "const fn ", "fn ", "const ", "struct ", "enum ", "trait ", "type "]
            .iter()
            .find_map(|kind| code.strip_prefix(kind))?;
        Some(name_in(code))
    };
    let is_field = |code: &str| code.contains(": ") && code.starts_with(|c: char| c.is_lowercase() || c == '_');
    match (indent, inside) {
        (0, _) => public.and_then(item),
        (4, "impl") => public.and_then(item),
        (4, "trait") => item(code),
        (4, "struct") => public.filter(|code| is_field(code)).map(name_in),
        (4, "enum") => code.starts_with(char::is_uppercase).then(|| name_in(code)),
        (8, "enum") if owner.contains("::") => is_field(code).then(|| name_in(code)),
        _ => None,
    }
}

/// The public items of a formatted file, of those types and functions for which `is_seen` returns `true`.
fn items(file: &Path, text: &str, is_seen: impl Fn(&str) -> bool) -> Vec<Item> {
    let (mut items, mut documentation, mut is_hidden) = (Vec::new(), String::new(), false);
    // The type around a line, its kind, and the variant around it.
    let (mut owner, mut inside, mut variant) = (String::new(), "", String::new());
    let lines: Vec<&str> = text.split("#[cfg(test)]\nmod").next().unwrap().lines().collect();
    let mut at = 0;
    while at < lines.len() {
        let code = lines[at].trim_start();
        let indent = lines[at].len() - code.len();
        at += 1;
        if code.is_empty() {
            documentation.clear();
            continue;
        }
        if let Some(text) = code.strip_prefix("///") {
            documentation += text;
            documentation.push('\n');
            continue;
        }
        if code.starts_with("#[") {
            is_hidden |= code == "#[doc(hidden)]";
            // An attribute of several lines ends at its own depth.
            while !lines[at - 1].trim_end().ends_with(']') {
                at += 1;
            }
            continue;
        }
        if indent == 0 && code.starts_with('}') {
            (owner, inside) = (String::new(), "");
        }
        let around = if indent == 8 { format!("{owner}::{variant}") } else { owner.clone() };
        let found = declared(code, indent, &around, inside);
        if indent == 0 {
            let kinds = ["struct", "enum", "trait"];
            let kind = kinds.into_iter().find(|kind| code.starts_with(&format!("pub {kind} ")));
            let implemented = implemented(code);
            inside = kind.unwrap_or(if implemented.is_some() { "impl" } else { "" });
            owner = if kind.is_some() { found.clone().unwrap_or_default() } else { implemented.unwrap_or_default() };
        } else if indent == 4 && inside == "enum" {
            variant = found.clone().unwrap_or_default();
        }
        if let Some(name) = found.filter(|name| !is_hidden && is_seen(if indent == 0 { name } else { &owner })) {
            let declaration = declaration(&lines[at - 1..]);
            let owner = if indent == 0 { String::new() } else { around };
            let place = format!("src/{}:{at}", file.display());
            items.push(Item { place, owner, name, declaration, documentation: documentation.clone() });
        }
        documentation.clear();
        is_hidden = false;
    }
    items
}

/// The first lines of code up to the brace, comma or semicolon that ends them.
fn declaration(lines: &[&str]) -> String {
    let end =
        lines.iter().position(|line| line.ends_with(['{', '}', ';']) || (line.ends_with(',') && line.contains(": ")));
    let of_function = lines.iter().position(|line| line.ends_with(['{', '}', ';']));
    let end = if lines[0].contains("fn ") { of_function } else { end };
    lines[..=end.unwrap_or(0)].join(" ")
}

/// The items that a user sees, file by file: those of all crates, with their fields, variants and methods.
fn front(house: &House) -> Vec<Item> {
    let mut seen: BTreeSet<(Vec<String>, String)> = BTreeSet::new();
    for module in house.public_modules() {
        let source = &house.files[&module];
        seen.extend(source.exports.iter().map(|(name, path)| (house.file_of(path), name.clone())));
        let own = source.text.lines().filter_map(|line| declared(line, 0, "", ""));
        seen.extend(own.map(|name| (module.clone(), name)));
    }
    let of_file = |(module, source): (&Vec<String>, &Source)| {
        items(&source.path, &source.text, |name| {
            let origin = house.origin(module, name);
            seen.contains(&(origin, name.to_string()))
        })
    };
    house.files.iter().flat_map(of_file).collect()
}

/// The first sentence of each comment of documentation, with the number of its first line and the code below it.
fn first_sentences(text: &str) -> Vec<(String, usize, &str)> {
    let sign = |line: &str| ["///", "//!"].into_iter().find(|sign| line.trim_start().starts_with(*sign));
    let lines: Vec<&str> = text.lines().collect();
    let (mut found, mut at) = (Vec::new(), 0);
    for comment in lines.chunk_by(|a, b| sign(a) == sign(b)) {
        let first = at + 1;
        at += comment.len();
        let Some(sign) = sign(comment[0]) else { continue };
        let text: Vec<&str> = comment.iter().map(|line| line.trim_start()[sign.len()..].trim()).collect();
        let text = text.join(" ");
        let sentence = text.split(". ").next().unwrap().trim_end_matches('.').to_string();
        let code = lines[at..].iter().map(|line| line.trim()).find(|line| !line.starts_with('#'));
        found.push((sentence, first, code.unwrap_or_default()));
    }
    found
}

/// The help of options is left out: an option of several commands has the same help in each.
#[test]
fn no_two_items_of_the_crates_begin_with_the_same_sentence() {
    let text = "/// The rows that\n/// are closed. Increasing.\n#[inline]\npub fn a() {}\n    /// The rows that are closed.\n    b: B,";
    let sentence = || "The rows that are closed".to_string();
    assert_eq!(first_sentences(text), [(sentence(), 1, "pub fn a() {}"), (sentence(), 5, "b: B,")]);
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut places: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for path in CRATES.iter().flat_map(|of_crate| rust_files(&root.join(of_crate.0))) {
        let file = path.strip_prefix(root).unwrap();
        if file.starts_with("src/cli/options") {
            continue;
        }
        for (sentence, line, code) in first_sentences(&fs::read_to_string(&path).unwrap()) {
            places.entry(sentence).or_default().push(format!("{}:{line}: {code}", file.display()));
        }
    }
    assert!(places.len() > 6000, "{} sentences", places.len());
    // A comment that begins with a heading, such as `# Errors`, has no sentence before it.
    let is_sentence = |text: &str| !text.starts_with('#') && text.split_whitespace().count() >= 3;
    let repeated = places.iter().filter(|(sentence, places)| is_sentence(sentence) && places.len() > 1);
    let repeated: Vec<String> =
        repeated.map(|(sentence, places)| format!("{sentence}\n  {}", places.join("\n  "))).collect();
    assert!(repeated.is_empty(), "{} sentences stand twice:\n{}", repeated.len(), repeated.join("\n"));
}

/// Lines of code, formulas and tables in a comment may be longer: they have no place to break.
#[test]
fn no_line_of_a_comment_is_longer_than_120_letters() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut long = Vec::new();
    let mut comments = 0;
    for path in
        ["crates", "src", "tests", "studies", "python", "examples"].iter().flat_map(|at| rust_files(&root.join(at)))
    {
        let text = fs::read_to_string(&path).unwrap();
        let mut is_code = false;
        for (number, line) in text.lines().enumerate() {
            let Some(comment) = line.trim_start().strip_prefix("//") else {
                is_code = false;
                continue;
            };
            let comment = comment.trim_start_matches(['/', '!']).trim();
            is_code ^= comment.starts_with("```");
            comments += 1;
            if line.chars().count() > 120 && !is_code && !comment.starts_with('|') {
                long.push(format!("{}:{}", path.display(), number + 1));
            }
        }
    }
    assert!(comments > 20_000, "{comments} lines");
    assert!(long.is_empty(), "{} lines are longer:\n{}", long.len(), long.join("\n"));
}

#[test]
fn public_documentation_says_more_than_names_and_gives_shape_unit_sign_and_errors() {
    let items = front(&House::read());
    let pages = items.iter().filter(|item| item.owner.is_empty()).count();
    assert!(pages > 140 && items.len() > 1000, "{pages} pages, {} items", items.len());
    let arrays = items.iter().filter(|item| item.declaration.contains("f64]") || item.declaration.contains("Vec<f64>"));
    let failing = items.iter().filter(|item| item.declaration.contains("-> Result<"));
    let (arrays, failing) = (arrays.count(), failing.count());
    assert!(arrays > 100 && failing > 110, "{arrays} arrays, {failing} functions that can fail");
    let wrong: Vec<String> = items
        .iter()
        .flat_map(|item| item.faults().into_iter().map(move |fault| (item, fault)))
        .map(|(item, fault)| format!("{}: {} {} {fault}", item.place, item.owner, item.name))
        .collect();
    assert!(wrong.is_empty(), "{} faults:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn documentation_that_lacks_something_is_found() {
    let text = r#"
/// The rows of contact.
#[derive(Debug)]
pub struct ContactRows {
    /// The node of the mesh that the first row holds.
    pub node: usize,
    /// The gap of every row.
    pub gap: Vec<f64>,
    /// Distances to the obstacle, one entry per row, in length.
    pub remaining_gap: Vec<f64>,
    /// Nodes of the body that the rows hold.
    pub nodes: Vec<usize>,
    secret: f64,
}

impl ContactRows {
    /// Which rows are closed at the end of the solve?
    pub fn closed(
        &self,
    ) -> usize {
        0
    }

    /// Reads all rows from a file of the user.
    ///
    /// # Errors
    /// Several.
    pub fn read(file: &str) -> Result<Self, Error> {
        Err(file)
    }

    /// Secret.
    #[doc(hidden)]
    pub fn secret(&self) {}
}

/// The events on the way from one gap to another: a row touches, or it releases.
pub enum Event {
    /// A row touches the obstacle.
    Touch {
        /// Its row.
        row: usize,
    },
}
"#;
    let found = items(Path::new("rows.rs"), text, |_| true);
    let faults: Vec<(&str, Vec<&str>)> = found.iter().map(|item| (item.name.as_str(), item.faults())).collect();
    let expected = [
        ("ContactRows", vec!["repeats its name"]),
        ("node", vec![]),
        ("gap", vec!["repeats its name", "has an array without a unit", "has an array without a sign"]),
        ("remaining_gap", vec!["has an array without a sign"]),
        ("nodes", vec!["has an array without a length or an order"]),
        ("closed", vec!["asks"]),
        ("read", vec!["has no `# Errors`"]),
        ("Event", vec![]),
        ("Touch", vec![]),
        ("row", vec!["repeats its name"]),
    ];
    assert_eq!(faults, expected);
}
