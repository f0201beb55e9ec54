//! Every scene in `examples/` is read and built without a warning, and agrees with its description.

use signorini::Scene;
use signorini::fem::ElementKind;

use crate::sources::files_below;

fn scene(name: &str) -> Scene {
    Scene::read(format!("{}/examples/{name}.json", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

#[test]
fn every_example_builds_without_a_warning() {
    let examples = files_below("examples", ".json");
    for path in examples.iter().filter(|path| path.parent().unwrap().ends_with("examples")) {
        let model = Scene::read(path).unwrap().build().unwrap_or_else(|error| panic!("{path:?}: {error}"));
        assert_eq!(model.warnings(), [], "{path:?}");
        assert!(!model.title().is_empty() && !model.rows().is_empty(), "{path:?}");
    }
    assert!(examples.len() >= 7);
}

#[test]
fn the_indentation_has_one_row_per_top_node_with_a_parabolic_gap() {
    let model = scene("indentation").build().unwrap();
    assert_eq!((model.problem().dofs(), model.problem().rows()), (1640, 41));
    assert_eq!((model.mesh().element_count(), model.mesh().kind_of(0)), (800, ElementKind::Q4));
    for (row, gap) in model.rows().iter().zip(model.problem().gap()) {
        let [x, y, _] = model.mesh().nodes()[row.node];
        assert_eq!((y, row.normal), (0.5, [0.0, 1.0, 0.0]));
        // u_y <= gap + (x - 0.5)^2/2
        assert!((gap - (-0.01 + (x - 0.5).powi(2) / 2.0)).abs() < 1e-16);
    }
    let total: f64 = model.rows().iter().map(|row| row.tributary_area).sum();
    assert!((total - 1.0).abs() < 1e-14);
}

#[test]
fn the_inclined_plane_gives_rows_of_two_entries() {
    let model = scene("inclined").build().unwrap();
    assert_eq!(model.problem().contact().entries(), 2 * model.problem().rows());
}

#[test]
fn the_body_between_two_obstacles_has_no_support_along_y() {
    let model = scene("between").build().unwrap();
    let supported_y = (0..model.mesh().nodes().len()).filter(|node| model.dofs().number(2 * node + 1).is_none());
    assert_eq!(supported_y.count(), 0);
    assert!(model.rows().iter().any(|row| row.obstacle == 0) && model.rows().iter().any(|row| row.obstacle == 1));
}

#[test]
fn each_contact_node_of_the_two_cylinders_has_an_opposite_node() {
    let model = scene("two_cylinders").build().unwrap();
    assert_eq!(model.body().regions().len(), 2);
    for row in model.rows() {
        let [one, other] = [row.node, row.partner().unwrap()].map(|node| model.mesh().nodes()[node]);
        assert!((one[0] - other[0]).abs() < 1e-12 && (row.gap - (one[1] - other[1])).abs() < 1e-12);
    }
}
