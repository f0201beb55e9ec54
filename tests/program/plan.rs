//! GOAL: `solve --plan` says what would be tried, in order, without solving; `--method`, `--memory` and the kind of
//! problem show in it.

use serde_json::Value;

use crate::blocks::{block, cube, pressed};
use support::program::Desk;

/// The plan of a scene, after a check that nothing was solved.
fn plan(desk: &Desk, scene: &Value, options: &[&str]) -> String {
    desk.write("scene.json", scene.to_string());
    let run = desk.run(&[&["solve", "scene.json", "--plan"], options].concat()).ends_with(0);
    assert!(!run.stdout.contains("certif") && run.stdout.contains("because"), "{}", run.stdout);
    run.stdout
}

/// The place of each of these words in a plan: they must come in this order.
fn comes_in_order(plan: &str, words: &[&str]) {
    let mut rest = plan;
    for word in words {
        let (_, after) = rest.split_once(word).unwrap_or_else(|| panic!("no `{word}` in its place in\n{plan}"));
        rest = after;
    }
}

#[test]
fn the_plan_of_ten_kinds_of_problem_is_printed_without_solving_them() {
    let desk = Desk::new();
    let square = block([20, 20], "q4");
    let last = ["existence and uniqueness", "if an answer has no bound", "K + rho E"];
    let of_factor = ["meets a motion", "no set is settled", "dual active-set", "refinement", "repair"];

    let by_choice = plan(&desk, &square, &[]);
    comes_in_order(
        &by_choice,
        &[&["1. auto with a factor"], &of_factor[..], &["on all dofs", "mprgp"], &last].concat(),
    );
    assert!(by_choice.contains("The factor of 1: active-set, condensed to 21 dofs"), "{by_choice}");
    let forms = ["condensed to the contact dofs, if that pays; ", "those of the rows last; ", "one factor at a time"];
    comes_in_order(&by_choice, &forms);

    let by_name = plan(&desk, &square, &["--method", "active-set"]);
    comes_in_order(&by_name, &[&["1. active-set", "it was requested"], &of_factor[..], &last].concat());
    assert!(!by_name.contains("mprgp"), "{by_name}");
    let polished = plan(&desk, &square, &["--method", "qp"]);
    comes_in_order(&polished, &[&["1. qp with a factor", "it was requested"], &of_factor[..], &last].concat());
    let penalty = plan(&desk, &square, &["--method", "penalty"]);
    comes_in_order(&penalty, &[&["1. penalty with a factor", "it was requested"], &of_factor[..], &last].concat());

    let by_cycles = plan(&desk, &square, &["--method", "mprgp"]);
    comes_in_order(&by_cycles, &[&["1. mprgp with a multigrid", "it was requested"], &last[..]].concat());
    assert!(!by_cycles.contains("factor"), "{by_cycles}");

    let on_all_dofs = plan(&desk, &square, &["--no-condense"]);
    assert!(!on_all_dofs.contains("condensed"), "{on_all_dofs}");

    let of_goal = plan(&desk, &square, &["--accuracy", "1e-4"]);
    comes_in_order(&of_goal, &["1. auto with a factor", "2. active-set with a factor", "The factor of 1: "]);
    let in_space = plan(&desk, &cube(16, "hex8"), &[]);
    comes_in_order(
        &in_space,
        &[&["1. mprgp", "2. auto with a factor", "if multigrid falls short"], &last[..]].concat(),
    );
    let floating = plan(&desk, &pressed(block([20, 20], "q4"), 2.0), &[]);
    comes_in_order(&floating, &[&["1. auto with a factor"], &of_factor[..], &last].concat());
}

#[test]
fn a_motion_has_no_plan_and_a_goal_of_refinement_excludes_one() {
    let desk = Desk::new();
    desk.write("scene.json", block([4, 4], "q4").to_string());
    desk.run(&["solve", "scene.json", "--plan", "--total-error", "0.1"]).ends_with(2);
    desk.run(&["solve", "missing.json", "--plan"]).ends_with(1);
}
