//! The content of files written by Gmsh itself (`reference/meshes.py`).

use std::path::{Path, PathBuf};

use signorini::fem::{ElasticBody, ElementKind, Formulation, GmshFile, Material, Mesh, tributary_areas};

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes").join(name)
}

fn mesh(name: &str) -> Mesh {
    GmshFile::read(path(name)).unwrap().mesh(&[], 1.0).unwrap()
}

/// Asserts that the nodes of a boundary are exactly those at which `off` is zero.
fn lies(mesh: &Mesh, name: &str, off: impl Fn([f64; 3]) -> f64) {
    let mut nodes = mesh.boundary(name).unwrap_or_else(|| panic!("no boundary {name}")).nodes();
    nodes.sort_unstable();
    let there: Vec<usize> = (0..mesh.nodes().len()).filter(|&node| off(mesh.nodes()[node]).abs() < 1e-9).collect();
    assert_eq!(nodes, there, "{name}");
}

#[test]
fn unordered_tags_are_resolved_and_unused_nodes_are_removed() {
    for name in ["block-t3.msh", "box-tet4.msh", "box-hex8.msh"] {
        let text = std::fs::read_to_string(path(name)).unwrap();
        // In version 4.1, the tag of a corner point is alone in its line, after `0 <point> 0 1`.
        let mut lines = text.lines().skip_while(|line| *line != "$Nodes");
        let mut tags = Vec::new();
        while let Some(line) = lines.next().filter(|line| *line != "$EndNodes") {
            if line.starts_with("0 ") && line.ends_with(" 0 1") {
                tags.extend(lines.next().and_then(|tag| tag.trim().parse::<usize>().ok()));
            }
        }
        assert!(tags.len() > 4 && !tags.is_sorted(), "{name}: {tags:?}");
        assert!(text.contains("\"stray\""));
        let mesh = mesh(name);
        assert!(
            mesh.nodes().iter().all(|at| at.iter().all(|&value| value <= 2.0)),
            "{name}: the stray node is still in the mesh"
        );
        assert!(mesh.boundary("stray").is_none());
    }
}

#[test]
fn an_unstructured_block_has_its_four_sides() {
    let block = mesh("block-t3.msh");
    assert_eq!(block.kind_of(0), ElementKind::T3);
    assert_eq!(block.extent(), ([0.0; 3], [2.0, 1.0, 0.0]));
    lies(&block, "bottom", |[_, y, _]| y);
    lies(&block, "top", |[_, y, _]| y - 1.0);
    lies(&block, "left", |[x, ..]| x);
    lies(&block, "right", |[x, ..]| x - 2.0);
}

#[test]
fn one_of_two_groups_of_elements_can_be_read_as_a_body() {
    let file = GmshFile::read(path("two-parts-q8.msh")).unwrap();
    let (both, second) = (file.mesh(&[], 1.0).unwrap(), file.mesh(&["second"], 1.0).unwrap());
    assert_eq!(both.kind_of(0), ElementKind::Q8);
    assert_eq!(both.extent(), ([0.0; 3], [2.0, 1.0, 0.0]));
    lies(&both, "interface", |[x, ..]| x - 1.0);
    assert_eq!(second.extent(), ([1.0, 0.0, 0.0], [2.0, 1.0, 0.0]));
    assert_eq!(both.element_count(), 2 * second.element_count());
    // A boundary that both parts share is restricted to the part; a boundary elsewhere is left out.
    lies(&second, "bottom", |[_, y, _]| y);
    lies(&second, "interface", |[x, ..]| x - 1.0);
    assert!(second.boundary("left").is_none());
}

#[test]
fn mid_side_nodes_of_a_half_disc_are_on_the_arc_in_their_order() {
    let disc = mesh("half-disc-t6.msh");
    assert_eq!(disc.kind_of(0), ElementKind::T6);
    lies(&disc, "cut", |[_, y, _]| y - 1.0);
    lies(&disc, "arc", |[x, y, _]| x.hypot(y - 1.0) - 1.0);
    let arc = disc.boundary("arc").unwrap().nodes();
    assert!(
        arc.windows(2).all(|pair| disc.nodes()[pair[0]][0] < disc.nodes()[pair[1]][0]),
        "the nodes are not ordered along the arc"
    );
    for facet in disc.boundary("arc").unwrap().facets() {
        let [a, b, middle] = [0, 1, 2].map(|local| disc.nodes()[facet[local]]);
        let distance = |p: [f64; 3]| (p[0] - middle[0]).hypot(p[1] - middle[1]);
        assert!((distance(a) - distance(b)).abs() < 1e-6, "the mid-side node is not the last node of the edge");
    }
}

/// Gmsh and VTK order the mid-side nodes of solids differently; each must lie between the corners that the element
/// names.
#[test]
fn mid_side_nodes_of_solids_are_between_their_corners() {
    for name in ["box-tet10.msh", "box-hex20.msh"] {
        let solid = mesh(name);
        let element = solid.kind_of(0).reference();
        for nodes in solid.elements() {
            for (&middle, &[a, b]) in nodes[element.corners..].iter().zip(element.mid_sides) {
                let [at, one, two] = [middle, nodes[a], nodes[b]].map(|node| solid.nodes()[node]);
                assert!((0..3).all(|axis| (2.0 * at[axis] - one[axis] - two[axis]).abs() < 1e-9), "{name}");
            }
        }
    }
}

#[test]
fn nodes_and_area_of_a_half_ball_of_quadratic_tetrahedra_are_those_of_a_sphere() {
    let ball = mesh("half-ball-tet10.msh");
    assert_eq!(ball.kind_of(0), ElementKind::Tet10);
    lies(&ball, "round", |[x, y, z]| x.hypot(y).hypot(z - 1.0) - 1.0);
    lies(&ball, "cut", |[_, _, z]| z - 1.0);
    let body = ElasticBody::new(ball, Material::new(1.0, 0.3).unwrap(), Formulation::Space).unwrap();
    let area: f64 = tributary_areas(&body, body.mesh().boundary("round").unwrap()).iter().map(|(_, area)| area).sum();
    // The exact area is 2 pi. The error of curved quadratic faces is of fourth order in the cell size, which is at most
    // 0.7.
    assert!((area / std::f64::consts::TAU - 1.0).abs() < 2e-3, "{area}");
}

#[test]
fn boxes_have_six_sides_with_outward_facets() {
    use ElementKind::{Hex8, Hex20, Tet4, Tet10};
    let boxes = [("box-tet4.msh", Tet4), ("box-hex8.msh", Hex8), ("box-tet10.msh", Tet10), ("box-hex20.msh", Hex20)];
    for (name, kind) in boxes {
        let solid = mesh(name);
        assert_eq!((solid.kind_of(0), solid.boundaries().len()), (kind, 6));
        for (side, axis, at) in [
            ("left", 0, 0.0),
            ("right", 0, 1.0),
            ("front", 1, 0.0),
            ("back", 1, 1.0),
            ("bottom", 2, 0.0),
            ("top", 2, 1.0),
        ] {
            lies(&solid, side, |node| node[axis] - at);
            for facet in solid.boundary(side).unwrap().facets() {
                let [a, b, c] = [0, 1, 2].map(|local| solid.nodes()[facet[local]]);
                let (p, q) = ((axis + 1) % 3, (axis + 2) % 3);
                let normal = (b[p] - a[p]) * (c[q] - a[q]) - (b[q] - a[q]) * (c[p] - a[p]);
                assert!(normal * (at - 0.5) > 0.0, "{name}: {side}");
            }
        }
    }
}
