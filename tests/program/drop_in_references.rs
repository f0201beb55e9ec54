//! Nodes that are no nodes of the mesh, in the tables of `signorini ccx`: U, and RF, the force on them from outside.

use support::program::Desk;

/// Two cubes side by side of stiffness EA/L = 1000, with the nodes 51, 52 and 61.
const CUBES: &str = "*NODE
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 0., 0., 1.
6, 1., 0., 1.
7, 1., 1., 1.
8, 0., 1., 1.
11, 2., 0., 0.
12, 3., 0., 0.
13, 3., 1., 0.
14, 2., 1., 0.
15, 2., 0., 1.
16, 3., 0., 1.
17, 3., 1., 1.
18, 2., 1., 1.
51, .5, .5, 1.
52, .5, .5, 1.
61, .5, .5, 3.
*ELEMENT, TYPE=C3D8, ELSET=E
1, 1, 2, 3, 4, 5, 6, 7, 8
2, 11, 12, 13, 14, 15, 16, 17, 18
*NSET, NSET=BASE
1, 2, 3, 4, 11, 12, 13, 14
*NSET, NSET=TOP
5, 6, 7, 8
*NSET, NSET=TOPS
5, 6, 7, 8, 15, 16, 17, 18
*NSET, NSET=REF
51
*NSET, NSET=FAR
61
*SURFACE, NAME=FACE
1, S2
*MATERIAL, NAME=M
*ELASTIC
1000., 0.
*SOLID SECTION, ELSET=E, MATERIAL=M
*BOUNDARY
BASE, 1, 3
";

/// The third value of the only line of each table with this title.
fn thirds(dat: &str, title: &str) -> Vec<f64> {
    let tables = dat.split(title).skip(1);
    let values = tables.map(|table| table.lines().nth(2).unwrap_or_else(|| panic!("{dat}")).split_whitespace());
    values.map(|mut line| line.next_back().and_then(|word| word.parse().ok()).unwrap_or(f64::NAN)).collect()
}

#[track_caller]
fn near(found: &[f64], expected: &[f64], what: &str) {
    let fits =
        found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= 1e-6 * b.abs());
    assert!(fits, "{what}: {found:?} instead of {expected:?}");
}

/// The reference node moves by -0.01, or is pressed by as much as that takes.
#[test]
fn displacement_and_force_of_a_reference_node_are_in_the_tables() {
    let equations: String = (5..9).map(|node| format!("2\n{node}, 3, 1., 51, 3, -1.\n")).collect();
    let coupling = "*COUPLING, CONSTRAINT NAME=C, REF NODE=51, SURFACE=FACE\n";
    let rigid =
        |set: &str| format!("*RIGID BODY, NSET={set}, REF NODE=51, ROT NODE=52\n*BOUNDARY\n51, 1, 2\n52, 1, 3\n");
    for (cards, moved, force) in [
        (rigid("TOP"), "51", -10.0),
        (rigid("TOPS"), "51", -20.0),
        (format!("{coupling}*KINEMATIC\n3\n*BOUNDARY\n51, 4, 6\n"), "51", -10.0),
        (format!("{coupling}*KINEMATIC\n*BOUNDARY\n51, 1, 2\n51, 4, 6\n"), "51", -10.0),
        (format!("{coupling}*DISTRIBUTING\n1, 3\n*BOUNDARY\n51, 1, 2\n"), "51", -10.0),
        (format!("*EQUATION\n{equations}"), "51", -10.0),
        (rigid("TOPS") + "*EQUATION\n2\n51, 3, 1., 61, 3, -1.\n", "61", -20.0),
    ] {
        for load in [format!("*BOUNDARY\n{moved}, 3, 3, -0.01\n"), format!("*CLOAD\n{moved}, 3, {force}\n")] {
            let desk = Desk::new();
            let set = if moved == "51" { "REF" } else { "FAR" };
            let asked = format!("*NODE PRINT, NSET=REF\nU\n*NODE PRINT, NSET={set}, TOTALS=YES\nRF\n*END STEP\n");
            desk.write("cubes.inp", format!("{CUBES}{cards}*STEP\n*STATIC\n{load}{asked}"));
            let run = desk.run(&["ccx", "cubes"]).ends_with(0);
            assert!(!run.stdout.contains("are not written") && !run.stdout.contains("single node"), "{}", run.stdout);
            let dat = std::fs::read_to_string(desk.path("cubes.dat")).unwrap();
            near(&thirds(&dat, "displacements"), &[-0.01], &format!("{cards}{load}"));
            near(&thirds(&dat, "total force"), &[force], &format!("{cards}{load}"));
            near(&thirds(&dat, "forces"), &[force], &format!("{cards}{load}"));
        }
    }
}

/// A rotation of 0.01 about x takes the moment of the linear traction, and a spring of 50 pulls at the node that moves.
#[test]
fn moments_and_forces_of_springs_are_those_of_reference_nodes() {
    let desk = Desk::new();
    let cards = "*RIGID BODY, NSET=TOP, REF NODE=51, ROT NODE=52\n*EQUATION\n2\n51, 3, 1., 61, 3, -1.\n*BOUNDARY\n51, 1, 3\n52, 2, 3\n\
                 *NSET, NSET=TURNS\n52\n*NODE\n71, .5, .5, 2.\n*ELEMENT, TYPE=SPRINGA, ELSET=S\n9, 51, 71\n*SPRING, ELSET=S\n\n50.\n\
                 *BOUNDARY\n71, 1, 2\n*NSET, NSET=LAST\n71\n";
    let step =
        "*STEP\n*STATIC\n*BOUNDARY\n71, 3, 3, 0.02\n*NODE PRINT, NSET=LAST\nRF\n*NODE PRINT, NSET=REF\nRF\n*END STEP\n";
    desk.write("cubes.inp", format!("{CUBES}{cards}{step}"));
    desk.run(&["ccx", "cubes"]).ends_with(0);
    let dat = std::fs::read_to_string(desk.path("cubes.dat")).unwrap();
    near(&thirds(&dat, "forces"), &[1.0, -1.0], &dat);
}

/// The second step holds what the first one gave, under another load; the third has nothing to hold a cube.
#[test]
fn fixed_holds_the_displacement_of_the_step_before_and_a_failed_step_keeps_those_before_it() {
    let desk = Desk::new();
    let asked = "*NODE PRINT, NSET=REF\nU, RF\n*END STEP\n";
    let steps = format!(
        "*STEP\n*STATIC\n*CLOAD\n51, 3, -10.\n{asked}*STEP\n*STATIC\n*CLOAD\n51, 3, 5.\n*BOUNDARY, FIXED\n51, 3\n{asked}\
         *STEP\n*STATIC\n*BOUNDARY, OP=NEW\n11, 1\n*END STEP\n"
    );
    for free in ["51, 1, 2\n52, 1, 3\n", "51, 1, 2\n51, 4, 6\n52, 1\n"] {
        let cards = format!("*RIGID BODY, NSET=TOP, REF NODE=51, ROT NODE=52\n*BOUNDARY\n{free}");
        desk.write("cubes.inp", format!("{CUBES}{cards}{steps}"));
        let said = desk.run(&["ccx", "cubes"]).ends_with(3).stdout;
        assert!(said.contains("*ERROR: step 3: "), "{said}");
        let dat = std::fs::read_to_string(desk.path("cubes.dat")).unwrap();
        near(&thirds(&dat, "displacements"), &[-0.01, -0.01], &dat);
        near(&thirds(&dat, "forces"), &[-10.0, -10.0], &dat);
        assert!(desk.path("cubes.frd").exists());
    }
}

/// A step after FIXED that is refused has the line of the card in its sentence.
#[test]
fn a_refused_step_after_fixed_names_the_line_of_the_deck() {
    let desk = Desk::new();
    let load = "5, 3, -1.\n6, 3, -1.\n7, 3, -1.\n8, 3, -1.\n";
    let steps = format!(
        "*STEP\n*STATIC\n*CLOAD\n{load}*END STEP\n*STEP\n*STATIC\n*BOUNDARY, FIXED\n5, 3\n*BOUNDARY\n8, 3, 3, 0.5\n*END STEP\n"
    );
    desk.write("cubes.inp", format!("{CUBES}*EQUATION\n2\n5, 3, 1., 8, 3, -1.\n{steps}"));
    let said = desk.run(&["ccx", "cubes"]).ends_with(1).stdout;
    let line = CUBES.lines().count() + 2;
    assert!(said.contains("step 2: "), "{said}");
    assert!(said.contains(&format!("cubes.inp:{line}: at `ties[0]")), "{said}");
}
