//! The program in the place of `ccx`: decks with large displacements, and decks of several steps.

use support::decks::Block;
use support::program::Desk;

use crate::drop_in::{BRICK, read};

/// The ends of a block follow a field, and its middle with them: a rotation about z by an angle, or a stretch along x.
#[test]
fn large_displacements_are_answered_up_to_five_percent() {
    let desk = Desk::new();
    let mesh = Block { element: "C3D8", low: [0.0; 3], high: [2.0, 1.0, 1.0], cells: [2, 1, 1], after: 0 }.mesh();
    let section = "*MATERIAL, NAME=M\n*ELASTIC\n200., 0.\n*SOLID SECTION, ELSET=PART, MATERIAL=M\n*STEP, NLGEOM\n*STATIC\n*BOUNDARY\n";
    for (is_turned, size, size_in_words) in [
        (
            true,
            0.04,
            Some("at the centres of elements the largest strain is 0.00 %, the largest rotation 4.00 % (2.29 degrees)"),
        ),
        (
            false,
            0.048,
            Some("at the centres of elements the largest strain is 4.80 %, the largest rotation 0.00 % (0.00 degrees)"),
        ),
        (true, -0.06, None),
        (false, 0.051, None),
    ] {
        let mut deck = mesh.cards("PART") + section;
        for (number, [x, y, _]) in mesh.nodes.iter().filter(|(_, at)| at[0] != 1.0) {
            let [along, across] = if is_turned { [-size * y, size * x] } else { [size * x, 0.0] };
            deck += &format!("{number}, 1, 1, {along:e}\n{number}, 2, 2, {across:e}\n{number}, 3\n");
        }
        desk.write("part.inp", deck + "*END STEP\n");
        let Some(words) = size_in_words else {
            let run = desk.run(&["solve", "part.inp", "--format", "json"]).ends_with(1);
            let report: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
            assert_eq!(report["code"], "large-displacements", "{report}");
            let run = desk.run(&["ccx", "part"]).ends_with(1);
            assert!(run.stdout.contains("*ERROR") && run.stdout.contains("above 5 % of either"), "{}", run.stdout);
            assert!(!desk.path("part.frd").exists());
            let run = desk.run(&["ccx", "part", "--linear"]).ends_with(0);
            assert!(run.stdout.contains("NLGEOM is answered with small displacements"), "{}", run.stdout);
            continue;
        };
        let run = desk.run(&["solve", "part.inp"]).ends_with(0);
        let said: Vec<&str> = run.stdout.split_whitespace().collect();
        assert!(said.join(" ").contains(words), "{}", run.stdout);
    }
}

/// Fields, tables and increments of all steps are in one file each; a request of a later step replaces those before it.
#[test]
fn the_steps_of_a_deck_are_solved_in_turn() {
    let desk = Desk::new();
    let steps = "*NODE PRINT, NSET=X0, TOTALS=ONLY\nRF\n*END STEP\n\
                 *STEP\n*STATIC\n*DSLOAD\nEND, P, -6.\n*NODE FILE\nRF\n*END STEP\n\
                 *STEP\n*STATIC\n0.1, 0.25\n*DSLOAD, OP=NEW\n*NODE PRINT, NSET=X0\nU\n*CLOAD\n103, 1, 1.\n*END STEP\n";
    desk.write("brick.inp", format!("{BRICK}{steps}"));
    let run = desk.run(&["ccx", "brick"]).ends_with(0);
    assert_eq!(run.stdout.matches("certified to").count(), 3, "{}", run.stdout);
    let dat = read(&desk, "brick.dat");
    let titles: Vec<&str> = dat.lines().filter(|line| line.contains("and time")).collect();
    assert_eq!(
        titles,
        [
            " total force (fx,fy,fz) for set X0 and time  0.2000000E+01",
            " total force (fx,fy,fz) for set X0 and time  0.3000000E+01",
            " displacements (vx,vy,vz) for set X0 and time  0.3250000E+01",
        ]
    );
    assert!(dat.contains("      -3.000000E+00") && dat.contains("      -6.000000E+00"), "{dat}");
    let frd = read(&desk, "brick.frd");
    let heads: Vec<&str> = frd.lines().filter(|line| line.starts_with("  100CL")).collect();
    assert_eq!(heads[0], "  100CL  101 2.000000000           8                     0    1           1");
    assert_eq!(heads[3], "  100CL  102 3.000000000           8                     0    2           1");
    assert_eq!(heads.last(), Some(&"  100CL  103 3.250000000           8                     0    3           1"));
    assert!(frd.contains("    1PSTEP                         4           1           2          \n"), "{frd}");
    // Two fields in the first step, three in the others.
    assert_eq!((heads.len(), frd.matches(" 9999").count(), frd.matches("    2C").count()), (8, 1, 1));
    let sta: Vec<String> = read(&desk, "brick.sta").lines().skip(2).map(str::to_string).collect();
    assert_eq!(sta.len(), 3);
    assert_eq!(sta[2], "     3          1     1     1  0.325000E+01  0.250000E+00  0.250000E+00");
    for step in 1..=3 {
        assert!(desk.path(&format!("brick.signorini/step-{step}/report.json")).exists());
    }
    // A deck of one step leaves no report of the steps before it.
    desk.write("brick.inp", format!("{BRICK}*END STEP\n"));
    desk.run(&["ccx", "brick"]).ends_with(0);
    assert!(
        !desk.path("brick.signorini/step-1/report.json").exists() && desk.path("brick.signorini/report.json").exists()
    );
    desk.write("brick.inp", format!("{BRICK}{steps}"));
    // One step, as `solve` answers it.
    let run = desk.run(&["solve", "brick.inp", "--step", "2"]).ends_with(0);
    assert!(run.stdout.contains("largest 6.000000e-2 along x"), "{}", run.stdout);
    desk.write("scene.json", "{}");
    desk.run(&["solve", "scene.json", "--step", "2"])
        .fails_with(1, &["`--step`: this option is for decks of CalculiX"]);
    desk.run(&["solve", "brick.inp", "--step", "4"]).fails_with(1, &["the deck has no step 4; its steps are 1 to 3"]);
}
