//! Documentation of what users see: every array has its shape, its unit and its sign.

use std::fs;

use syn::visit::{self, Visit};
use syn::{
    Attribute, Expr, ExprLit, GenericArgument, Ident, ImplItem, Item, ItemImpl, Lit, Meta, MetaNameValue,
    PathArguments, PathSegment, Signature, TraitItem, Type, Visibility,
};

use crate::sources::{Sources, crates, is_hidden, root};

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

/// The arrays in the type of a field or in a signature.
#[derive(Default)]
struct Arrays {
    of_numbers: bool,
    of_indices: bool,
}

impl<'a> Visit<'a> for Arrays {
    fn visit_type(&mut self, one: &'a Type) {
        let entry = match one {
            Type::Slice(slice) => Some(&*slice.elem),
            Type::Array(array) => Some(&*array.elem),
            Type::Path(path) => match path.path.segments.last() {
                Some(PathSegment { ident, arguments: PathArguments::AngleBracketed(list) }) if ident == "Vec" => list
                    .args
                    .first()
                    .and_then(|one| if let GenericArgument::Type(one) = one { Some(one) } else { None }),
                _ => None,
            },
            _ => None,
        };
        let is_of = |name: &str| matches!(entry, Some(Type::Path(path)) if path.path.is_ident(name));
        self.of_numbers |= is_of("f64");
        self.of_indices |= is_of("usize") && !matches!(one, Type::Array(_));
        visit::visit_type(self, one);
    }
}

/// The documentation of an item before its errors, without examples.
fn prose(attributes: &[Attribute]) -> String {
    let line = |attribute: &Attribute| match &attribute.meta {
        Meta::NameValue(MetaNameValue { value: Expr::Lit(ExprLit { lit: Lit::Str(line), .. }), .. }) => {
            line.value() + "\n"
        }
        _ => String::new(),
    };
    let text: String = attributes.iter().filter(|one| one.path().is_ident("doc")).map(line).collect();
    text.split("# Errors").next().unwrap().split("```").step_by(2).collect()
}

/// What a reader misses in the documentation of an item with arrays.
fn faults(name: &str, arrays: &Arrays, prose: &str, may_have_any_unit: bool) -> Vec<&'static str> {
    let bare = |word: &str| word.trim_matches(|c: char| !c.is_alphanumeric() && !"<>=".contains(c)).to_string();
    let words: Vec<String> = prose.split(|c: char| c.is_whitespace() || "/-,".contains(c)).map(bare).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).filter(|word| !word.is_empty()).collect();
    let says = |some: &[&str]| words.iter().any(|word| some.contains(word));
    let in_unit = words.windows(2).any(|pair| pair[0] == "in" && IN_UNIT.contains(&pair[1]));
    let has_unit = says(&UNIT) || in_unit || prose.contains("force per");
    let is_array = arrays.of_numbers || arrays.of_indices;
    let needs_unit = arrays.of_numbers && !may_have_any_unit;
    let needs_sign = needs_unit && ["gap", "multiplier", "pressure"].iter().any(|end| name.ends_with(end));
    let faults = [
        ("length or order", is_array && !says(&SHAPE) && !prose.contains('[')),
        ("unit", needs_unit && !has_unit),
        ("sign", needs_sign && !says(&SIGN)),
    ];
    faults.into_iter().filter_map(|(fault, is_there)| is_there.then_some(fault)).collect()
}

/// Fields and functions: name, documentation and arrays of each.
#[derive(Default)]
struct Found(Vec<(String, String, Arrays)>);

impl Found {
    fn add(&mut self, name: &Ident, attributes: &[Attribute], visit: impl Fn(&mut Arrays)) {
        if !is_hidden(attributes) {
            let mut arrays = Arrays::default();
            visit(&mut arrays);
            self.0.push((name.to_string(), prose(attributes), arrays));
        }
    }

    fn add_function(&mut self, signature: &Signature, attributes: &[Attribute]) {
        self.add(&signature.ident, attributes, |arrays| arrays.visit_signature(signature));
    }

    /// Those of an item of a file, if `is_seen` returns `true` for its type or function.
    fn read(&mut self, item: &Item, is_seen: impl Fn(&Ident) -> bool) {
        let is_public = |visibility: &Visibility| matches!(visibility, Visibility::Public(_));
        match item {
            Item::Fn(one) if is_seen(&one.sig.ident) => self.add_function(&one.sig, &one.attrs),
            Item::Struct(one) if is_seen(&one.ident) => {
                for field in one.fields.iter().filter(|field| is_public(&field.vis)) {
                    self.add(field.ident.as_ref().unwrap_or(&one.ident), &field.attrs, |of| of.visit_field(field));
                }
            }
            Item::Enum(one) if is_seen(&one.ident) => {
                for (variant, field) in one.variants.iter().flat_map(|one| one.fields.iter().map(move |f| (one, f))) {
                    // A field without a name has the documentation of its variant.
                    let attributes = if field.ident.is_some() { &field.attrs } else { &variant.attrs };
                    self.add(field.ident.as_ref().unwrap_or(&variant.ident), attributes, |of| of.visit_field(field));
                }
            }
            Item::Trait(one) if is_seen(&one.ident) => {
                for item in &one.items {
                    let TraitItem::Fn(one) = item else { continue };
                    self.add_function(&one.sig, &one.attrs);
                }
            }
            Item::Impl(ItemImpl { trait_: None, self_ty, items, .. }) => {
                let Type::Path(of) = &**self_ty else { return };
                for item in items.iter().filter(|_| is_seen(&of.path.segments[0].ident)) {
                    match item {
                        ImplItem::Fn(one) if is_public(&one.vis) => self.add_function(&one.sig, &one.attrs),
                        _ => {}
                    }
                }
            }
            _ => {}
        }
    }
}

#[test]
fn public_documentation_gives_shape_unit_and_sign_of_arrays() {
    let sources = Sources::of(&crates());
    let exported = sources.exported();
    let (mut wrong, mut arrays) = (Vec::new(), 0);
    for (module, source) in &sources.files {
        let file = syn::parse_file(&fs::read_to_string(root().join(&source.path)).unwrap()).unwrap();
        // Matrices and vectors may have any unit.
        let may_have_any_unit = source.path.starts_with("crates/linear/src");
        let mut found = Found::default();
        let is_seen = |name: &Ident| exported.contains(&sources.meant(module, &name.to_string()));
        file.items.iter().for_each(|item| found.read(item, is_seen));
        for (name, prose, of) in found.0 {
            arrays += usize::from(of.of_numbers || of.of_indices);
            let faults = faults(&name, &of, &prose, may_have_any_unit);
            wrong.extend(faults.iter().map(|fault| format!("{}: {name}: no {fault}", source.path.display())));
        }
    }
    assert!(wrong.is_empty(), "{} faults of arrays:\n{}", wrong.len(), wrong.join("\n"));
    assert!(arrays > 200, "{arrays} arrays");
}

#[test]
fn documentation_that_lacks_something_is_found() {
    let text = "
        pub struct ContactRows {
            /// The gap of the rows.
            pub gap: Vec<f64>,
            /// Distances to the obstacle, one entry per row, in length.
            pub remaining_gap: Vec<f64>,
            /// Nodes of the body that the rows hold.
            pub nodes: Vec<usize>,
            secret: Vec<f64>,
        }
        impl ContactRows {
            /// Sums, one per row, in force; negative under compression.
            pub fn pressure(&self, of: &[[f64; 2]]) -> Result<f64, Error> {}
            #[doc(hidden)]
            pub fn hidden(&self) -> [f64; 2] {}
        }";
    let mut all = Found::default();
    syn::parse_file(text).unwrap().items.iter().for_each(|item| all.read(item, |_| true));
    let found = all.0.iter().map(|(name, prose, arrays)| format!("{name}: {:?}", faults(name, arrays, prose, false)));
    let expected = [
        r#"gap: ["length or order", "unit", "sign"]"#,
        r#"remaining_gap: ["sign"]"#,
        r#"nodes: ["length or order"]"#,
        "pressure: []",
    ];
    assert_eq!(found.collect::<Vec<_>>(), expected);
}
