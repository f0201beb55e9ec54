//! Structured meshes: geometry, boundaries, and refused input.

use signorini::fem::Error;
use signorini::fem::{Axis, Boundary, ElasticBody, ElementKind, FacetKind, Formulation, Material, Mesh};
use signorini::scene::rectangle;

fn axis(points: &[f64], divisions: &[usize], ratios: &[f64]) -> Axis {
    Axis { points: points.into(), divisions: divisions.into(), ratios: ratios.into() }
}

#[test]
fn cells_grow_by_a_constant_factor_from_first_to_last() {
    for ratio in [0.1, 0.5, 1.0, 1.000_000_01, 4.0, 1000.0] {
        let lines = axis(&[2.0, 5.0], &[7], &[ratio]).coordinates().unwrap();
        let cells: Vec<f64> = lines.windows(2).map(|pair| pair[1] - pair[0]).collect();
        assert_eq!((lines.len(), lines[0], lines[7]), (8, 2.0, 5.0));
        // A cell size is a difference of coordinates up to 5: its rounding error is about 1e-15, which matters in a
        // cell of 1e-3.
        assert!((cells[6] / cells[0] / ratio - 1.0).abs() < 1e-11, "{ratio}: {cells:?}");
        let growth = cells[1] / cells[0];
        assert!(cells.windows(2).all(|pair| (pair[1] / pair[0] / growth - 1.0).abs() < 1e-11), "{ratio}: {cells:?}");
    }
}

#[test]
fn breakpoints_are_exact_and_each_interval_is_graded_separately() {
    let lines = axis(&[0.0, 0.1, 0.7, 1.0], &[2, 3, 1], &[3.0, 1.0, 5.0]).coordinates().unwrap();
    assert_eq!(lines.len(), 7);
    assert_eq!((lines[2], lines[5], lines[6]), (0.1, 0.7, 1.0));
    assert!((lines[1] - 0.025).abs() < 1e-16);
    assert!((lines[3] - 0.3).abs() < 1e-15);
}

#[test]
fn equal_cells_have_the_expected_decimal_coordinates() {
    let lines = axis(&[0.0, 1.0], &[40], &[]).coordinates().unwrap();
    assert!(lines.iter().enumerate().all(|(i, &x)| x == i as f64 / 40.0));
}

#[test]
fn an_invalid_axis_is_refused_with_the_faulty_field() {
    let huge = usize::MAX;
    for (axis, field, phrase) in [
        (axis(&[0.0], &[], &[]), "points", "at least two points"),
        (axis(&[0.0, f64::NAN], &[1], &[]), "points[1]", "not finite"),
        (axis(&[0.0, 1.0, 1.0], &[1, 1], &[]), "points[2]", "must increase"),
        (axis(&[-1.5e308, 1.5e308], &[1], &[]), "points", "length"),
        (axis(&[0.0, 1.0], &[1, 2], &[]), "divisions", "length 2, but must have 1"),
        (axis(&[0.0, 1.0], &[0], &[]), "divisions[0]", "at least 1"),
        (axis(&[0.0, 1.0, 2.0], &[huge, huge], &[]), "divisions[0]", "an axis may have"),
        (axis(&[0.0, 1.0], &[2], &[1.0, 1.0]), "ratios", "length 2, but must have 1"),
        (axis(&[0.0, 1.0], &[2], &[0.0]), "ratios[0]", "positive"),
        (axis(&[0.0, 1.0], &[9], &[1e300]), "divisions[0]", "fall together"),
        (axis(&[1.0, 1.0 + 1e-15], &[9], &[]), "divisions[0]", "fall together"),
    ] {
        let error = axis.coordinates().unwrap_err();
        assert_eq!(error.field, field, "{error}");
        assert!(error.message.contains(phrase), "{error}");
    }
}

#[test]
fn triangles_are_cut_from_lower_left_to_upper_right() {
    let mesh = rectangle(&[0.0, 1.0, 2.0], &[0.0, 1.0], ElementKind::T3).unwrap();
    let elements: Vec<&[usize]> = mesh.elements().collect();
    assert_eq!(elements, [[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]]);
}

#[test]
fn boundaries_are_named_and_ordered_by_increasing_coordinates() {
    let mesh = rectangle(&[0.0, 1.0, 2.0], &[0.0, 1.0], ElementKind::Q4).unwrap();
    for (name, nodes) in
        [("left", vec![0, 3]), ("right", vec![2, 5]), ("bottom", vec![0, 1, 2]), ("top", vec![3, 4, 5])]
    {
        assert_eq!(mesh.boundary(name).unwrap().nodes(), nodes, "{name}");
    }
    assert!(mesh.boundary("roof").is_none());
}

#[test]
fn a_rectangle_beyond_the_size_limit_is_refused_before_it_is_built() {
    let lines: Vec<f64> = (0..10_001).map(f64::from).collect();
    let error = rectangle(&lines, &lines, ElementKind::Q4).map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("10000 x 10000"), "{error}");
}

#[test]
fn an_inconsistent_mesh_is_refused() {
    let square = || vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let side = |name: &str| Boundary::new(name, FacetKind::Line2, vec![0, 1]);
    let mut far = square();
    far[2][0] = f64::INFINITY;
    let beyond = Boundary::new("b", FacetKind::Line2, vec![0, 9]);
    let mut lone = square();
    lone.push([5.0, 5.0, 0.0]);
    for (nodes, connectivity, boundaries, phrase) in [
        (vec![], vec![], vec![], "no elements"),
        (far, vec![0, 1, 2, 3], vec![], "node 2"),
        (square(), vec![0, 1, 2], vec![], "not a multiple"),
        (square(), vec![0, 1, 2, 7], vec![], "node 7"),
        (square(), vec![0, 1, 2, 3], vec![beyond], "node 9"),
        (lone, vec![0, 1, 2, 3], vec![], "node 4 belongs to no element"),
        (square(), vec![0, 1, 2, 3], vec![side("a"), side("a")], "two boundaries"),
    ] {
        let error = Mesh::new(nodes, ElementKind::Q4, connectivity, boundaries).unwrap_err();
        assert!(matches!(&error, Error::Mesh { message } if message.contains(phrase)), "{error}");
    }
}

#[test]
fn an_inverted_element_or_one_without_area_is_named() {
    let nodes: Vec<[f64; 3]> =
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [2.0, 0.0], [2.0, 1.0]].map(|[x, y]| [x, y, 0.0]).to_vec();
    let material = Material::new(1.0, 0.3).unwrap();
    let formulation = Formulation::PlaneStrain { thickness: 1.0 };
    let second = |corners: [usize; 4], at: [f64; 2]| {
        let mut nodes = nodes.clone();
        nodes[5] = [at[0], at[1], 0.0];
        let connectivity = [[0, 1, 2, 3], corners].concat();
        ElasticBody::new(Mesh::new(nodes, ElementKind::Q4, connectivity, vec![]).unwrap(), material, formulation)
    };
    assert!(second([1, 4, 5, 2], [2.0, 1.0]).is_ok());
    for body in [
        second([2, 5, 4, 1], [2.0, 1.0]), // clockwise
        second([1, 4, 5, 2], [1.0, 0.5]), // a corner on the opposite edge
        second([1, 4, 5, 2], [1.2, 0.2]), // a re-entrant corner: positive at all quadrature points but one
    ] {
        let error = body.unwrap_err().to_string();
        assert!(error.contains("element 1") && error.contains("Jacobian"), "{error}");
    }
}
