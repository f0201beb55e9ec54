//! Loads on facets: nodal shares of a uniform load, pressures along the outward normal, and the structured meshes used
//! for both.
//!
//! REFERENCE: shares of line2 1/2; line3 1/6, 4/6, 1/6; Q4 1/4; T3 1/3; of a conical surface, weighted by the radius.

use signorini::fem::{
    Boundary, ElasticBody, ElementKind, FacetKind, Formulation, Material, Mesh, add_pressure, add_traction,
    tributary_areas,
};
use signorini::scene::{bar, cuboid, rectangle};

const ROUNDING: f64 = 1e-14;

fn body(mesh: Mesh) -> ElasticBody {
    let formulation = match mesh.dimension() {
        1 => Formulation::Bar { area: 0.25 },
        2 => Formulation::PlaneStress { thickness: 0.25 },
        _ => Formulation::Space,
    };
    ElasticBody::new(mesh, Material::new(1.0, 0.0).unwrap(), formulation).unwrap()
}

fn one_cell(kind: ElementKind) -> ElasticBody {
    body(match kind.dimension() {
        1 => bar(&[0.0, 2.0]).unwrap(),
        2 => rectangle(&[0.0, 2.0], &[0.0, 1.0], kind).unwrap(),
        _ => cuboid(&[0.0, 2.0], &[0.0, 1.0], &[0.0, 3.0], kind).unwrap(),
    })
}

const ALL: [ElementKind; 7] = [
    ElementKind::Line2,
    ElementKind::T3,
    ElementKind::T6,
    ElementKind::Q4,
    ElementKind::Q8,
    ElementKind::Tet4,
    ElementKind::Hex8,
];

#[test]
fn nodes_of_a_uniformly_loaded_facet_get_their_known_shares() {
    for (kind, area, shares) in [
        (ElementKind::T3, 0.5, vec![0.5, 0.5]),
        (ElementKind::Q4, 0.5, vec![0.5, 0.5]),
        (ElementKind::T6, 0.5, vec![1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0]),
        (ElementKind::Q8, 0.5, vec![1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0]),
        (ElementKind::Hex8, 2.0, vec![0.25; 4]),
        // Two triangles share the diagonal: the corners off the diagonal get 1/6 of the whole, those on it twice as
        // much.
        (ElementKind::Tet4, 2.0, vec![1.0 / 3.0, 1.0 / 6.0, 1.0 / 3.0, 1.0 / 6.0]),
        (ElementKind::Line2, 0.25, vec![1.0]),
    ] {
        let body = one_cell(kind);
        let name = if kind == ElementKind::Line2 { "right" } else { "top" };
        let found = tributary_areas(&body, body.mesh().boundary(name).unwrap());
        assert_eq!(found.len(), shares.len(), "{kind:?}");
        for ((node, found), share) in found.iter().zip(shares) {
            assert!((found - area * share).abs() < ROUNDING, "{kind:?}, node {node}: {found}");
        }
    }
}

#[test]
fn rings_are_loaded_in_proportion_to_their_circumference() {
    // Integrals of (1 - s), s and the quadratic functions over [0, 1], times 2 pi (1 + s).
    let turn = std::f64::consts::TAU;
    for (kind, shares) in [
        (ElementKind::Q4, vec![2.0 / 3.0, 5.0 / 6.0]),
        (ElementKind::T3, vec![2.0 / 3.0, 5.0 / 6.0]),
        (ElementKind::Q8, vec![1.0 / 6.0, 1.0, 1.0 / 3.0]),
        (ElementKind::T6, vec![1.0 / 6.0, 1.0, 1.0 / 3.0]),
    ] {
        let mesh = rectangle(&[1.0, 2.0], &[0.0, 1.0], kind).unwrap();
        let body = ElasticBody::new(mesh, Material::new(1.0, 0.0).unwrap(), Formulation::Axisymmetric).unwrap();
        let found = tributary_areas(&body, body.mesh().boundary("bottom").unwrap());
        for ((_, found), share) in found.iter().zip(&shares) {
            assert!((found - turn * share).abs() < 10.0 * ROUNDING, "{kind:?}: {found} {share}");
        }
    }
}

#[test]
fn pressure_acts_against_the_outward_normal_and_has_no_resultant_on_a_closed_surface() {
    for kind in ALL {
        let body = one_cell(kind);
        let dimension = body.dimension();
        let mut all = vec![0.0; body.nodal_dofs()];
        for boundary in body.mesh().boundaries() {
            let mut load = vec![0.0; body.nodal_dofs()];
            add_pressure(&body, boundary, 3.0, &mut load);
            let (axis, sense) = match (boundary.name.as_str(), dimension) {
                ("left", _) => (0, 1.0),
                ("right", _) => (0, -1.0),
                ("front", _) | ("bottom", 2) => (1, 1.0),
                ("back", _) | ("top", 2) => (1, -1.0),
                ("bottom", _) => (2, 1.0),
                _ => (2, -1.0),
            };
            let area: f64 = tributary_areas(&body, boundary).iter().map(|entry| entry.1).sum();
            let mut same = vec![0.0; body.nodal_dofs()];
            let mut traction = [0.0; 3];
            traction[axis] = 3.0 * sense;
            add_traction(&body, boundary, traction, &mut same);
            assert!(area > 0.1, "{kind:?} {}", boundary.name);
            for (found, expected) in load.iter().zip(&same) {
                assert!((found - expected).abs() < 10.0 * ROUNDING, "{kind:?} {}: {load:?}", boundary.name);
            }
            all.iter_mut().zip(&load).for_each(|(sum, entry)| *sum += entry);
        }
        for axis in 0..dimension {
            let total: f64 = all.iter().skip(axis).step_by(dimension).sum();
            assert!(total.abs() < 10.0 * ROUNDING, "{kind:?}: {total:e}");
        }
    }
}

#[test]
fn structured_meshes_have_the_volume_and_the_sides_of_their_body() {
    let lines = [0.0, 0.2, 0.9, 1.0];
    for (kind, volume) in ALL.map(|kind| (kind, if kind.dimension() == 1 { 0.25 } else { 1.0 })) {
        let mesh = match kind.dimension() {
            1 => bar(&lines).unwrap(),
            2 => rectangle(&lines, &lines, kind).unwrap(),
            _ => cuboid(&lines, &lines, &lines, kind).unwrap(),
        };
        let (sides, corners, dimension) = (mesh.boundaries().len(), kind.corners(), mesh.dimension());
        assert_eq!(sides, 2 * dimension, "{kind:?}");
        for element in mesh.elements().filter(|_| kind.is_quadratic()) {
            for side in 0..corners {
                let (a, b) = (mesh.nodes()[element[side]], mesh.nodes()[element[(side + 1) % corners]]);
                let middle = mesh.nodes()[element[corners + side]];
                assert!((0..3).all(|axis| (middle[axis] - (a[axis] + b[axis]) / 2.0).abs() < ROUNDING), "{kind:?}");
            }
        }
        let body = body(mesh);
        let thickness = if dimension == 2 { 0.25 } else { 1.0 };
        let mut load = vec![0.0; body.nodal_dofs()];
        signorini::fem::add_body_force(&body, [1.0, 0.0, 0.0], &mut load);
        let found: f64 = load.iter().sum();
        assert!((found - volume * thickness).abs() < 10.0 * ROUNDING, "{kind:?}: {found}");
        for boundary in body.mesh().boundaries() {
            assert!(body.mesh().faces_of(boundary).iter().all(Option::is_some));
            let area: f64 = tributary_areas(&body, boundary).iter().map(|entry| entry.1).sum();
            let expected = if dimension == 1 { 0.25 } else { thickness };
            assert!((area - expected).abs() < 10.0 * ROUNDING, "{kind:?} {}: {area}", boundary.name);
        }
    }
}

#[test]
fn tetrahedra_of_neighbouring_cells_share_their_faces() {
    let mesh = cuboid(&[0.0, 1.0, 2.0], &[0.0, 1.0, 2.0], &[0.0, 1.0, 2.0], ElementKind::Tet4).unwrap();
    let mut faces = std::collections::HashMap::new();
    for element in mesh.elements() {
        for face in ElementKind::Tet4.reference().faces {
            let mut nodes: Vec<usize> = face.iter().map(|&local| element[local]).collect();
            nodes.sort_unstable();
            *faces.entry(nodes).or_insert(0) += 1;
        }
    }
    // Each of the six sides has four cells of two triangles.
    assert_eq!(faces.values().filter(|&&count| count == 1).count(), 48);
    assert!(faces.values().all(|&count| count <= 2));
}

#[test]
fn facets_that_do_not_match_their_mesh_are_refused() {
    let square = |boundary| {
        let nodes = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| [x, y, 0.0]).to_vec();
        Mesh::new(nodes, ElementKind::Q4, vec![0, 1, 2, 3], vec![boundary])
    };
    assert!(square(Boundary::new("side", FacetKind::Line2, vec![1, 0])).is_ok());
    for (boundary, phrase) in [
        (Boundary::new("across", FacetKind::Line2, vec![0, 2]), "facet 0 (nodes [0, 2], from 0) is not a face"),
        (Boundary::new("curved", FacetKind::Line3, vec![0, 1, 2]), "faces of Q4 are Line2"),
        (Boundary::new("odd", FacetKind::Line2, vec![0, 1, 2]), "3 node numbers"),
    ] {
        let error = square(boundary).unwrap_err().to_string();
        assert!(error.contains(phrase), "{error}");
    }
    let lifted = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.5], [0.0, 1.0, 0.0]];
    let error = Mesh::new(lifted, ElementKind::T3, vec![0, 1, 2], vec![]).unwrap_err().to_string();
    assert!(error.contains("node 1") && error.contains("z must be 0"), "{error}");
}
