//! The library refuses parts that do not match, each in a sentence that names both.

use signorini::fem::{
    self, DofMap, ElasticBody, ElementKind, Formulation, Integration, MassForm, Material, Mesh, discretisation_error,
    mass, stress,
};
use signorini::motion::DynamicProblem;
use signorini::scene::{bar, cuboid, rectangle, ring};
use signorini::{
    ContactProblem, Error, InteriorPoint, Method, Penalty, Settings, SparseMatrix, SymmetricMatrix, solve,
};

const LINES: [f64; 3] = [0.0, 1.0, 2.0];

#[track_caller]
fn refused<T>(result: Result<T, impl Into<Error>>, code: &str, phrases: &[&str]) {
    let error: Error = result.map(drop).unwrap_err().into();
    assert_eq!(error.code(), code, "{error}");
    phrases.iter().for_each(|phrase| assert!(error.to_string().contains(phrase), "{phrase}: {error}"));
}

fn square(kind: ElementKind) -> Mesh {
    rectangle(&LINES, &LINES, kind).unwrap()
}

fn body(mesh: Mesh, formulation: Formulation) -> Result<ElasticBody, fem::Error> {
    ElasticBody::new(mesh, Material::new(1.0, 0.3)?, formulation)
}

const STRAIN: Formulation = Formulation::PlaneStrain { thickness: 1.0 };
const STRESS: Formulation = Formulation::PlaneStress { thickness: 1.0 };

#[test]
fn elements_of_another_dimension_are_refused() {
    refused(rectangle(&LINES, &LINES, ElementKind::Hex8), "mesh", &["a rectangle cannot have a mesh of Hex8"]);
    refused(
        ring([0.0; 2], &[1.0, 2.0], &[0.0, 90.0], ElementKind::Tet4),
        "mesh",
        &["a ring cannot have a mesh of Tet4"],
    );
    refused(cuboid(&LINES, &LINES, &LINES, ElementKind::Q4), "mesh", &["a box cannot have a mesh of Q4"]);
    refused(body(square(ElementKind::Q4), Formulation::Space), "mesh", &["a mesh of Q4 does not fit"]);
    refused(body(bar(&LINES).unwrap(), STRAIN), "mesh", &["a mesh of Line2 does not fit plane strain"]);
}

#[test]
fn bodies_of_different_formulations_or_dimensions_cannot_be_combined() {
    let one = || body(square(ElementKind::Q4), STRAIN).unwrap();
    let phrases = ["the same formulation and cross-section", "plane strain and plane stress"];
    refused(one().beside(&body(square(ElementKind::Q4), STRESS).unwrap(), "base"), "mesh", &phrases);
    refused(square(ElementKind::T6).beside(&bar(&[0.0, 1.0]).unwrap(), "base"), "mesh", &["here T6 and Line2"]);
    let mixed = one().beside(&body(square(ElementKind::T6), STRAIN).unwrap(), "base").unwrap();
    assert!(mixed.mesh().kinds().eq([ElementKind::Q4, ElementKind::T6]));
    refused(mixed.with_integration(Integration::MeanDilatation), "mesh", &["not for T6"]);
}

#[test]
fn vectors_of_another_length_are_refused() {
    let one = body(square(ElementKind::Q4), STRAIN).unwrap();
    let field = stress(&one, &[0.0; 18]).unwrap();
    refused(stress(&one, &[0.0; 17]), "length", &["17", "18 nodal dofs"]);
    refused(discretisation_error(&one, &[0.0; 16], &field), "length", &["16", "18 nodal dofs"]);
    let mut shorter = field.clone();
    shorter.nodes.pop();
    refused(discretisation_error(&one, &[0.0; 18], &shorter), "length", &["nodal stress has length 8", "9 nodes"]);
    let dofs = DofMap::new(vec![None; 18]).unwrap();
    refused(dofs.restrict(&[0.0; 19]), "length", &["nodal vector has length 19", "18 nodal dofs"]);
    let nowhere = DofMap::new(vec![None, Some(f64::INFINITY)]);
    refused(nowhere, "not-finite", &["prescribed displacement has the value inf at dof 1"]);
    refused(mass(&one, &dofs, MassForm::Lumped, &[]), "setting", &["density"]);
}

fn penalty(change: fn(&mut Penalty)) -> Method {
    let mut ladder = Penalty::default();
    change(&mut ladder);
    Method::Penalty(ladder)
}

#[test]
fn each_setting_out_of_its_range_is_refused_by_name() {
    let one = |value| SparseMatrix::from_triplets(1, 1, &[(0, 0, value)]);
    let problem = || {
        let stiffness = SymmetricMatrix::from_lower(one(1.0).unwrap()).unwrap();
        ContactProblem::new(stiffness, vec![2.0], one(1.0).unwrap(), vec![1.0]).unwrap()
    };
    assert!(solve(&problem(), &Settings::default()).is_ok());
    type Change = fn(&mut Settings);
    let cases: [(Change, &str); 12] = [
        (|settings| settings.tolerance = Some(0.0), "tolerance is 0"),
        (|settings| settings.tolerance = Some(f64::NAN), "tolerance is NaN"),
        (|settings| settings.accuracy = Some(-1.0), "accuracy is -1"),
        (
            |settings| settings.method = Method::Qp(InteriorPoint { polish: true, tolerance: f64::INFINITY }),
            "tolerance of the interior point is inf",
        ),
        (|settings| settings.method = penalty(|ladder| ladder.first = 0.0), "first penalty is 0"),
        (|settings| settings.method = penalty(|ladder| ladder.last = -1.0), "last penalty is -1"),
        (|settings| settings.method = penalty(|ladder| ladder.first = 1e9), "it must be at most the last"),
        (|settings| settings.method = penalty(|ladder| ladder.penetration_threshold = -1.0), "threshold is -1"),
        (|settings| settings.method = penalty(|ladder| ladder.penetration_threshold = f64::NAN), "threshold is NaN"),
        (|settings| settings.threads = Some(0), "threads is 0"),
        (|settings| settings.max_iterations = 0, "max_iterations is 0"),
        (|settings| settings.accuracy = Some(f64::NAN), "accuracy is NaN"),
    ];
    for (change, phrase) in cases {
        let mut settings = Settings::default();
        change(&mut settings);
        refused(solve(&problem(), &settings), "setting", &[phrase, "must be"]);
    }
}

#[test]
fn an_upper_triangle_is_refused_as_lower_and_accepted_as_upper() {
    let entries = [(0, 0, 3.0), (0, 1, -1.0), (1, 1, 2.0)];
    let upper = || SparseMatrix::from_triplets(2, 2, &entries).unwrap();
    refused(SymmetricMatrix::from_lower(upper()), "not-symmetric", &["entry (0, 1) is -1"]);
    let symmetric = SymmetricMatrix::from_upper(&upper()).unwrap();
    assert_eq!(symmetric.mul(&[1.0, 10.0]), [-7.0, 19.0]);
    let wide = SparseMatrix::from_triplets(2, 3, &[]).unwrap();
    refused(SymmetricMatrix::from_lower(wide), "shape", &["2 x 3"]);
    let contact = ContactProblem::new(symmetric, vec![0.0; 2], upper(), vec![1.0; 2]).unwrap();
    let three = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(3, 3, &[]).unwrap()).unwrap();
    refused(DynamicProblem::new(contact, three), "shape", &["mass is 3 x 3", "2 x 2"]);
}

/// In a full matrix whose triangles have entries at different places, only zeros may lack a counterpart.
#[test]
fn triangles_of_a_full_matrix_are_compared_entry_by_entry() {
    let full = |entries: &[(usize, usize, f64)]| {
        SymmetricMatrix::from_full(&SparseMatrix::from_triplets(3, 3, entries).unwrap())
    };
    let right = [(0, 0, 2.0), (0, 2, -1.0), (2, 0, -1.0), (1, 1, 1.0), (2, 2, 3.0)];
    let with = |more: &[(usize, usize, f64)]| full(&[&right[..], more].concat());
    assert_eq!(with(&[]).unwrap().mul(&[1.0, 2.0, 3.0]), [-1.0, 2.0, 8.0]);
    for zeros in [[(1, 0, 0.0), (2, 1, 0.0)], [(0, 1, 0.0), (1, 2, 0.0)]] {
        assert_eq!(with(&zeros).unwrap().mul(&[1.0, 2.0, 3.0]), [-1.0, 2.0, 8.0]);
    }
    for (row, column) in [(1, 0), (0, 1), (2, 1), (1, 2)] {
        refused(
            with(&[(row, column, 0.5)]),
            "not-symmetric",
            &["5e-1", "0e0", "give both triangles with equal entries"],
        );
    }
    refused(with(&[(2, 0, -0.5)]), "not-symmetric", &["-1.5e0", "-1e0"]);
}
