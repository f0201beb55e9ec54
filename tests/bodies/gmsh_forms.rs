//! One mesh in every form of `.msh`, ASCII and binary, is read as the same mesh to the last bit.

use std::path::Path;

use signorini::fem::{GmshFile, Mesh};

use support::gmsh_forms::{Drawing, FORMS, Form, Part};

/// Numbers in [0, 1) from a seed.
fn random(mut state: u64) -> impl FnMut() -> f64 {
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Nodes with tags that have gaps and no order, each near a point of a lattice.
fn nodes(seed: u64, lattice: &[[i32; 3]], axes: usize) -> Vec<(u64, [f64; 3])> {
    let mut random = random(seed);
    let mut tags: Vec<u64> = (0..lattice.len() as u64).map(|place| 3 * place + 7).collect();
    for place in (1..tags.len()).rev() {
        tags.swap(place, (random() * (place + 1) as f64) as usize);
    }
    let mut near = |at: &[i32; 3]| {
        let mut axis = 0;
        at.map(|value| {
            axis += 1;
            if axis > axes { 0.0 } else { (f64::from(value) + 0.2 * random()) / 3.0 }
        })
    };
    tags.into_iter().zip(lattice.iter().map(&mut near)).collect()
}

/// Three-node triangles in 4 x 3 cells, with a group on two sides and elements without a group on the third.
pub fn plane(seed: u64) -> Drawing {
    let lattice: Vec<[i32; 3]> = (0..4).flat_map(|y| (0..5).map(move |x| [x, y, 0])).collect();
    let nodes = nodes(seed, &lattice, 2);
    let tag = |x: usize, y: usize| nodes[5 * y + x].0;
    let cells = (0..3).flat_map(|y| (0..4).map(move |x| (x, y)));
    let triangles = cells.flat_map(|(x, y)| {
        let [a, b, c, d] = [tag(x, y), tag(x + 1, y), tag(x + 1, y + 1), tag(x, y + 1)];
        [vec![a, b, c], vec![a, c, d]]
    });
    let body = Part { dimension: 2, entity: 4, group: 9, number: 2, elements: triangles.collect() };
    let line = |entity, group, elements| Part { dimension: 1, entity, group, number: 1, elements };
    let along = |y: usize| (0..4).map(|x| vec![tag(x, y), tag(x + 1, y)]).collect();
    let parts = vec![
        line(1, 2, along(0)),
        line(2, 5, (0..3).map(|y| vec![tag(0, y), tag(0, y + 1)]).collect()),
        line(3, 0, along(3)),
        body,
    ];
    Drawing { names: vec![(1, 2, "floor"), (2, 9, "body")], nodes, parts }
}

/// Eight-node bricks, 2 x 2 x 2, with a group at the bottom.
pub fn space(seed: u64) -> Drawing {
    let lattice: Vec<[i32; 3]> = (0..27).map(|place| [place % 3, place / 3 % 3, place / 9]).collect();
    let nodes = nodes(seed, &lattice, 3);
    let tag = |x: usize, y: usize, z: usize| nodes[9 * z + 3 * y + x].0;
    let ring = |x, y, z| [tag(x, y, z), tag(x + 1, y, z), tag(x + 1, y + 1, z), tag(x, y + 1, z)];
    let cells = (0..8).map(|place| [place % 2, place / 2 % 2, place / 4]);
    let bricks = cells.map(|[x, y, z]| [ring(x, y, z), ring(x, y, z + 1)].concat()).collect();
    let floor = (0..4).map(|place| ring(place % 2, place / 2, 0).to_vec()).collect();
    let parts = vec![
        Part { dimension: 2, entity: 11, group: 3, number: 3, elements: floor },
        Part { dimension: 3, entity: 1, group: 4, number: 5, elements: bricks },
    ];
    Drawing { names: vec![(2, 3, "floor"), (3, 4, "body")], nodes, parts }
}

/// The whole content of a file.
#[derive(PartialEq)]
struct Said {
    mesh: Mesh,
    /// The coordinates of the nodes, bit by bit.
    bits: Vec<[u64; 3]>,
    /// Dimension, tag and name of each physical group, as they were read.
    groups: Vec<(usize, u64, String)>,
    bodies: Vec<String>,
}

fn said(content: &[u8], name: &str) -> Said {
    let file = GmshFile::parse(content, name).unwrap_or_else(|error| panic!("{error}"));
    let mesh = file.mesh(&[], 1.0).unwrap_or_else(|error| panic!("{error}"));
    let bits = mesh.nodes().iter().map(|at| at.map(f64::to_bits)).collect();
    let groups = file.groups().iter().map(|group| (group.dimension, group.tag, group.name.clone())).collect();
    Said { mesh, bits, groups, bodies: file.bodies() }
}

#[test]
fn six_forms_of_a_mesh_give_the_same_bits() {
    for seed in 1..=10 {
        for (drawing, boundaries) in [(plane(seed), &["floor", "5"][..]), (space(seed), &["floor"])] {
            let [first, others @ ..] = FORMS.map(|form| (form, drawing.written(form)));
            let expected = said(&first.1, "first");
            let names: Vec<&str> = expected.mesh.boundaries().iter().map(|boundary| boundary.name.as_str()).collect();
            assert_eq!((names.as_slice(), expected.bodies.as_slice()), (boundaries, &["body".to_string()][..]));
            for (form, content) in &others {
                assert!(said(content, "other") == expected, "{form:?}, seed {seed}");
            }
            // A change of one bit gives another mesh.
            let mut other = drawing;
            other.nodes[0].1[0] = other.nodes[0].1[0].next_up();
            assert!(FORMS.iter().all(|form| said(&other.written(*form), "moved").bits != expected.bits));
        }
    }
}

#[test]
fn binary_files_are_not_valid_text() {
    let drawing = plane(1);
    let [little, big] = [Form::Little, Form::Big].map(|form| drawing.written((4.1, form)));
    assert!(little != big && little.len() == big.len());
    assert!(std::str::from_utf8(&little).is_err() && std::str::from_utf8(&big).is_err());
}

#[test]
fn four_files_of_gmsh_contain_the_same_cube() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes");
    let [first, others @ ..] = ["4.1-ascii", "4.1-binary", "2.2-ascii", "2.2-binary"]
        .map(|form| (form, std::fs::read(folder.join(format!("cube-tet4-{form}.msh"))).unwrap()));
    let expected = said(&first.1, first.0);
    assert_eq!((expected.mesh.nodes().len(), expected.mesh.boundaries().len()), (14, 6));
    for (form, content) in &others {
        assert!(said(content, form) == expected, "{form}");
    }
}

#[test]
fn a_comment_that_is_not_valid_text_is_skipped() {
    let content = plane(1).written((2.2, Form::Ascii));
    let commented = [b"$Comments\nbr\xfccke \xff\n$EndComments\n".as_slice(), &content].concat();
    assert!(said(&commented, "commented") == said(&content, "plain"));
}
