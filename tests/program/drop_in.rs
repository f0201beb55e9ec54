//! The program in the place of `ccx`: decks in, the files of CalculiX out, and answers that FreeCAD and PrePoMax
//! understand.

use std::fs;
use std::os::unix::process::CommandExt;
use std::process::{Command, Output};

use support::decks::Block;
use support::program::{Desk, program};

/// A brick of 2 x 1 x 1 whose nodes are not in the order of their numbers, pulled along x by 3: sigma = 3, E = 200, nu
/// = 0.25.
pub const BRICK: &str = "*HEADING
A brick
*NODE, NSET=ALL
7, 0., 0., 0.
3, 2., 0., 0.
4, 2., 1., 0.
5, 0., 1., 0.
101, 0., 0., 1.
102, 2., 0., 1.
103, 2., 1., 1.
1234567, 0., 1., 1.
*ELEMENT, TYPE=C3D8, ELSET=Part
12, 7, 3, 4, 5, 101, 102, 103, 1234567
*NSET, NSET=X0
7, 5, 101, 1234567
*SURFACE, NAME=END
12, S4
*MATERIAL, NAME=STEEL
*ELASTIC
200., 0.25
*SOLID SECTION, ELSET=Part, MATERIAL=STEEL
*BOUNDARY
X0, 1
7, 1, 3
3, 2, 3
4, 3
5, 3
101, 2
102, 2
*STEP
*STATIC
0.5, 2.
*DSLOAD
END, P, -3.
";

/// What CalculiX 2.20 writes for the brick: only its lines about date, machine and compiler are left out.
const FIELDS: &str = "    1C
    1UA brick                                                           
    1UPGM               signorini
    1UVERSION           VERSION
    2C                             8                                     1
 -1         3 2.00000E+00 0.00000E+00 0.00000E+00
 -1         4 2.00000E+00 1.00000E+00 0.00000E+00
 -1         5 0.00000E+00 1.00000E+00 0.00000E+00
 -1         7 0.00000E+00 0.00000E+00 0.00000E+00
 -1       101 0.00000E+00 0.00000E+00 1.00000E+00
 -1       102 2.00000E+00 0.00000E+00 1.00000E+00
 -1       103 2.00000E+00 1.00000E+00 1.00000E+00
 -1   1234567 0.00000E+00 1.00000E+00 1.00000E+00
 -3
    3C                             1                                     1
 -1        12    1    0    1
 -2         7         3         4         5       101       102       103   1234567
 -3
    1PSTEP                         1           1           1          
  100CL  101 2.000000000           8                     0    1           1
 -4  DISP        4    1
 -5  D1          1    2    1    0
 -5  D2          1    2    2    0
 -5  D3          1    2    3    0
 -5  ALL         1    2    0    0    1ALL
 -1         3 3.00000E-02 0.00000E+00 0.00000E+00
 -1         4 3.00000E-02-3.75000E-03 0.00000E+00
 -1         5 0.00000E+00-3.75000E-03 0.00000E+00
 -1         7 0.00000E+00 0.00000E+00 0.00000E+00
 -1       101 0.00000E+00 0.00000E+00-3.75000E-03
 -1       102 3.00000E-02 0.00000E+00-3.75000E-03
 -1       103 3.00000E-02-3.75000E-03-3.75000E-03
 -1   1234567 0.00000E+00-3.75000E-03-3.75000E-03
 -3
    1PSTEP                         2           1           1          
  100CL  101 2.000000000           8                     0    1           1
 -4  STRESS      6    1
 -5  SXX         1    4    1    1
 -5  SYY         1    4    2    2
 -5  SZZ         1    4    3    3
 -5  SXY         1    4    1    2
 -5  SYZ         1    4    2    3
 -5  SZX         1    4    3    1
";

/// The tables of CalculiX 2.20 for the brick.
const TABLES: &str = "
 displacements (vx,vy,vz) for set X0 and time  0.2000000E+01

         5  0.000000E+00 -3.750000E-03  0.000000E+00
         7  0.000000E+00  0.000000E+00  0.000000E+00
       101  0.000000E+00  0.000000E+00 -3.750000E-03
   1234567  0.000000E+00 -3.750000E-03 -3.750000E-03

 total force (fx,fy,fz) for set X0 and time  0.2000000E+01

       -3.000000E+00  0.000000E+00  0.000000E+00

 strains (elem, integ.pnt.,exx,eyy,ezz,exy,exz,eyz) for set PART and time  0.2000000E+01

        12   1  1.500000E-02 -3.750000E-03 -3.750000E-03  0.000000E+00  0.000000E+00  0.000000E+00
        12   2  1.500000E-02 -3.750000E-03 -3.750000E-03  0.000000E+00  0.000000E+00  0.000000E+00
        12   3  1.500000E-02 -3.750000E-03 -3.750000E-03  0.000000E+00  0.000000E+00  0.000000E+00
        12   4  1.500000E-02 -3.750000E-03 -3.750000E-03  0.000000E+00  0.000000E+00  0.000000E+00
        12   5  1.500000E-02 -3.750000E-03 -3.750000E-03  0.000000E+00  0.000000E+00  0.000000E+00
        12   6  1.500000E-02 -3.750000E-03 -3.750000E-03  0.000000E+00  0.000000E+00  0.000000E+00
        12   7  1.500000E-02 -3.750000E-03 -3.750000E-03  0.000000E+00  0.000000E+00  0.000000E+00
        12   8  1.500000E-02 -3.750000E-03 -3.750000E-03  0.000000E+00  0.000000E+00  0.000000E+00

 volume (element, volume) for set PART and time  0.2000000E+01

        12  2.000000E+00

 total volume for set PART and time  0.2000000E+01

        2.000000E+00

 internal energy (element, energy) for set PART and time  0.2000000E+01

        12  4.500000E-02

 total internal energy for set PART and time  0.2000000E+01

        4.500000E-02
";

const STEP: &str = "SUMMARY OF JOB INFORMATION
  STEP      INC     ATT  ITRS     TOT TIME     STEP TIME      INC TIME
     1          1     1     1  0.200000E+01  0.200000E+01  0.200000E+01
";

/// A file whose numbers below 1e-9, which are rounding, are written as zero.
fn without_rounding(text: &str) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for place in 0..bytes.len() {
        let exponent = bytes.get(place..place + 4).map(|word| String::from_utf8_lossy(word).into_owned());
        let Some(exponent) = exponent.and_then(|word| word.strip_prefix('E')?.parse::<i32>().ok()) else { continue };
        let is_digit = |byte: u8| byte.is_ascii_digit() || byte == b'.';
        let start = bytes[..place].iter().rposition(|&byte| !is_digit(byte)).unwrap();
        if exponent <= -10 {
            bytes[start] = b' ';
            bytes[start + 1..place].iter_mut().filter(|byte| **byte != b'.').for_each(|byte| *byte = b'0');
            bytes[place..place + 4].copy_from_slice(b"E+00");
        }
    }
    String::from_utf8(bytes).unwrap()
}

pub fn read(desk: &Desk, name: &str) -> String {
    without_rounding(&fs::read_to_string(desk.path(name)).unwrap_or_else(|error| panic!("{name}: {error}")))
}

/// A field of a file: the values of each node by its number.
fn field(frd: &str, name: &str) -> Vec<(usize, Vec<f64>)> {
    let (_, rest) = frd.split_once(&format!(" -4  {name:<8}")).unwrap_or_else(|| panic!("there is no field {name}"));
    let lines = rest.lines().take_while(|line| *line != " -3").filter(|line| line.starts_with(" -1"));
    let values = |line: &str| {
        let words = line.as_bytes()[13..].chunks(12).map(|word| String::from_utf8_lossy(word).trim().parse().unwrap());
        words.collect()
    };
    lines.map(|line| (line[3..13].trim().parse().unwrap(), values(line))).collect()
}

/// Runs the program under the name `ccx`.
fn ccx(desk: &Desk, words: &[&str]) -> Output {
    Command::new(program()).arg0("/opt/bin/ccx").args(words).current_dir(desk.path("")).output().unwrap()
}

fn said(output: &Output) -> String {
    assert!(output.stderr.is_empty(), "FreeCAD takes any text for a failure: {:?}", output.stderr);
    String::from_utf8(output.stdout.clone()).unwrap()
}

#[test]
fn fields_tables_and_step_of_a_brick_are_those_of_calculix() {
    let desk = Desk::new();
    let asked = "*NODE PRINT, NSET=X0\nU\n*EL PRINT, ELSET=Part, TOTALS=YES\nEVOL, ELSE\n*EL PRINT, ELSET=PART\nE\n\
                 *NODE PRINT, NSET=X0, TOTALS=ONLY\nRF\n*NODE FILE\nU, RF\n*EL FILE\nS, E\n*END STEP\n";
    desk.write("brick.inp", format!("{BRICK}{asked}"));
    let run = desk.run(&["ccx", "-i", "brick"]).ends_with(0);
    assert!(run.stderr.is_empty() && run.stdout.contains("certified"), "{}{}", run.stdout, run.stderr);
    assert!(!run.stdout.contains("nothing touches"), "{}", run.stdout);
    let frd = read(&desk, "brick.frd");
    let expected = FIELDS.replace("VERSION\n", &format!("{}\n", env!("CARGO_PKG_VERSION")));
    assert_eq!(&frd[..expected.len()], expected);
    assert!(frd.ends_with(" -3\n 9999\n"));
    for (_, stress) in field(&frd, "STRESS") {
        assert_eq!(stress, [3.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    }
    for (_, strain) in field(&frd, "TOSTRAIN") {
        assert_eq!(strain, [0.015, -0.00375, -0.00375, 0.0, 0.0, 0.0]);
    }
    // Reactions at x = 0, loads at x = 2.
    for (number, force) in field(&frd, "FORC") {
        let along = if [3, 4, 102, 103].contains(&number) { 0.75 } else { -0.75 };
        assert_eq!(force, [along, 0.0, 0.0]);
    }
    assert!(!frd.contains("NDTEMP") && !frd.contains("CONTACT"), "{frd}");
    assert_eq!(read(&desk, "brick.dat"), TABLES);
    assert_eq!(read(&desk, "brick.sta"), STEP);
    assert!(desk.path("brick.signorini/report.html").exists() && desk.path("brick.signorini/report.json").exists());
}

#[test]
fn the_program_called_ccx_answers_as_programs_expect() {
    let desk = Desk::new();
    desk.write("brick.inp", format!("{BRICK}*NODE FILE\nU\n*END STEP\n"));
    let version = ccx(&desk, &["-v"]);
    // FreeCAD takes the first two numbers, PrePoMax and others the words.
    let words = said(&version);
    assert!(version.status.success() && words.trim_start().starts_with("This is Version 2.20 "), "{words}");
    let before = &words[..words.find("2.20").unwrap()];
    assert!(!before.contains(|letter: char| letter.is_ascii_digit()) && words.contains("signorini"), "{words}");
    let usage = ccx(&desk, &[]);
    assert!(!usage.status.success() && said(&usage).contains("CalculiX"));
    // FreeCAD passes a blank behind -i.
    for words in [&["-i ", "brick"][..], &["brick.inp"], &["brick"], &["-i", "brick.inp"]] {
        desk.write("brick.frd", "earlier");
        let run = ccx(&desk, words);
        assert!(run.status.success() && read(&desk, "brick.frd").ends_with(" 9999\n"), "{words:?}: {}", said(&run));
    }
}

#[test]
fn a_run_that_fails_leaves_no_file_of_an_earlier_one() {
    let free = BRICK.replace("X0, 1\n", "").replace("7, 1, 3\n", "7, 2, 3\n");
    for (deck, code, phrase) in [
        (BRICK.replace("200., 0.25", "200., oops"), 1, "brick.inp:20: "),
        (free, 3, "translation along x"),
        (BRICK.to_string() + "*NODE PRINT, NSET=NOWHERE\nU\n", 1, "there is no set of nodes `NOWHERE`"),
        (BRICK.to_string() + "*NODE PRINT\nU\n", 1, "*NODE PRINT names no set; write NSET=NAME"),
        (BRICK.to_string() + "*EL PRINT, ELSET=PART, TOTALS=MAYBE\nS\n", 1, "must be NO, YES or ONLY"),
    ] {
        let desk = Desk::new();
        desk.write("brick.inp", deck + "*END STEP\n");
        for name in ["brick.frd", "brick.dat", "brick.sta", "brick.signorini/report.json"] {
            desk.write(name, "earlier");
        }
        let run = ccx(&desk, &["-i", "brick"]);
        let words = said(&run);
        assert_eq!(run.status.code(), Some(code), "{words}");
        assert!(words.starts_with(" *ERROR: ") && words.contains(phrase) && words.lines().count() == 1, "{words}");
        for name in ["brick.frd", "brick.dat", "brick.sta", "brick.signorini/report.json"] {
            assert!(!desk.path(name).exists(), "{phrase}: {name}");
        }
    }
}

#[test]
fn results_that_are_not_written_are_named_once() {
    let desk = Desk::new();
    let asked = "*EL FILE\nS, PEEQ\n*NODE PRINT, NSET=X0, TOTALS=ONLY\nU\n*EL PRINT, ELSET=PART\nSVF\n\
                 *SECTION PRINT, SURFACE=END, NAME=N\nSOF\n*NODE PRINT, NSET=LOOSE\nU\n*EL PRINT, ELSET=SPRINGS\nS\n*END STEP\n";
    let loose = "*NODE, NSET=LOOSE\n900, 9., 0., 0.\n*ELEMENT, TYPE=SPRINGA, ELSET=SPRINGS\n901, 4, 900\n*SPRING, ELSET=SPRINGS\n\n1.E-9\n\
                 *BOUNDARY\nLOOSE, 1, 3\n*STEP\n";
    desk.write("brick.inp", format!("{BRICK}{asked}").replace("*STEP\n", loose));
    let run = desk.run(&["ccx", "brick"]).ends_with(0);
    let expected = " *WARNING: these results are not written: PEEQ, U (line 47), SVF (line 49), *SECTION PRINT (line 50), \
         values of springs (line 54)\n";
    assert!(run.stdout.contains(expected), "{}", run.stdout);
}

/// The mid-sides between the lower and the upper face come before those of the upper face.
#[test]
fn a_brick_of_twenty_nodes_has_the_order_of_the_file() {
    let desk = Desk::new();
    let mesh = Block { element: "C3D20", low: [0.0; 3], high: [1.0; 3], cells: [1, 1, 1], after: 0 }.mesh();
    let deck = mesh.cards("PART")
        + &mesh.set("BASE", |at| at[2] == 0.0)
        + "*MATERIAL, NAME=M\n*ELASTIC\n200., 0.25\n*SOLID SECTION, ELSET=PART, MATERIAL=M\n*BOUNDARY\nBASE, 1, 3\n\
           *STEP\n*STATIC\n*CLOAD\n20, 3, 1.\n*END STEP\n";
    desk.write("brick.inp", deck);
    desk.run(&["ccx", "brick"]).ends_with(0);
    let frd = read(&desk, "brick.frd");
    let lines: Vec<&str> = frd.lines().filter(|line| line.starts_with(" -2")).collect();
    let numbers = |words: &[usize]| words.iter().map(|number| format!("{number:>10}")).collect::<String>();
    let own = &mesh.elements[0].1;
    let of_file: Vec<usize> = own[..12].iter().chain(&own[16..]).chain(&own[12..16]).copied().collect();
    assert_eq!(lines, [format!(" -2{}", numbers(&of_file[..10])), format!(" -2{}", numbers(&of_file[10..]))]);
}

/// Two bricks, one on the other, pressed by 3.
#[test]
fn pressure_and_force_of_a_contact_are_in_both_files() {
    let desk = Desk::new();
    for cells in [[2, 3], [3, 2]] {
        let below =
            Block { element: "C3D8", low: [0.0; 3], high: [1.0; 3], cells: [cells[0], cells[0], 1], after: 0 }.mesh();
        let above = Block {
            element: "C3D8",
            low: [0.0, 0.0, 1.0],
            high: [1.0, 1.0, 2.0],
            cells: [cells[1], cells[1], 1],
            after: 100,
        };
        let above = above.mesh();
        let deck = below.cards("PART")
            + &above.cards("PART")
            + &below.set("BASE", |at| at[2] == 0.0)
            + &below.set("SIDE", |at| at[0] == 0.0 || at[1] == 0.0)
            + &below.surface("Master", |at| at[2] == 1.0)
            + &above.surface("Slave", |at| at[2] == 1.0)
            + &above.surface("TOP", |at| at[2] == 2.0)
            + &above.set("X0", |at| at[0] == 0.0)
            + &above.set("Y0", |at| at[1] == 0.0)
            + "*MATERIAL, NAME=M\n*ELASTIC\n200., 0.\n*SOLID SECTION, ELSET=PART, MATERIAL=M\n*BOUNDARY\nBASE, 1, 3\n\
           X0, 1\nY0, 2\n*SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD\n\
           *CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE\nSLAVE, MASTER\n*STEP\n*STATIC\n*DSLOAD\nTOP, P, 3.\n\
           *CONTACT PRINT, SLAVE=slave, MASTER=MASTER\nCF\n*CONTACT PRINT\nCSTR\n*END STEP\n";
        desk.write("stack.inp", deck);
        desk.run(&["ccx", "stack"]).ends_with(0);
        let contact = field(&read(&desk, "stack.frd"), "CONTACT");
        // The finer surface carries the rows.
        let finer = if cells[0] < cells[1] { &above } else { &below };
        let carries = |number: usize| finer.nodes.iter().any(|(own, at)| *own == number && at[2] == 1.0);
        assert_eq!(contact.len(), below.nodes.len() + above.nodes.len());
        for (number, values) in contact {
            assert_eq!(values, [0.0, 0.0, 0.0, if carries(number) { 3.0 } else { 0.0 }, 0.0, 0.0], "{number}");
        }
        let dat = read(&desk, "stack.dat");
        assert_eq!(
            dat.lines().filter(|line| line.ends_with("  3.000000E+00  0.000000E+00  0.000000E+00")).count(),
            16,
            "{dat}"
        );
        let (_, statistics) =
            dat.split_once(" statistics for slave set SLAVE, master set MASTER and time  0.1000000E+01\n").unwrap();
        // The force on the slave acts upward in the middle of its face, which sank by 3/200.
        let expected = "
   total surface force (fx,fy,fz) and moment about the origin (mx,my,mz)

    0.000000E+00  0.000000E+00  3.000000E+00  1.500000E+00 -1.500000E+00  0.000000E+00

   center of gravity and mean normal

    5.000000E-01  5.000000E-01  9.850000E-01  0.000000E+00  0.000000E+00 -1.000000E+00

   moment about the center of gravity(mx,my,mz)

    0.000000E+00  0.000000E+00  0.000000E+00

   area,  normal force (+ = tension) and shear force (size)

    1.000000E+00 -3.000000E+00  0.000000E+00
";
        assert!(statistics.starts_with(expected), "{statistics}");
    }
}

/// What CalculiX 2.20 prints for two nodes of the base of a cube, whose axis 1 leads away from a line along z.
const LOCAL: &str = "
 displacements (vx,vy,vz) for set HALF and time  0.1000000E+01

         2  0.000000E+00  0.000000E+00  0.000000E+00 L
         4  0.000000E+00  0.000000E+00  0.000000E+00 L

 forces (fx,fy,fz) for set HALF and time  0.1000000E+01

         2 -3.384920E+01  2.068875E+01  4.820513E+01 L
         4 -8.769195E+00  7.192481E+00  1.017949E+02 L

 total force (fx,fy,fz) for set HALF and time  0.1000000E+01

       -3.208333E+01  3.615385E+01  1.500000E+02

 forces (fx,fy,fz) for set HALF and time  0.1000000E+01

         2 -2.102335E+01  3.364240E+01  4.820513E+01
         4 -1.105998E+01  2.511447E+00  1.017949E+02
";

#[test]
fn vectors_of_nodes_with_local_axes_are_printed_along_them() {
    let desk = Desk::new();
    let cube = Block { element: "C3D8", low: [0.0; 3], high: [1.0; 3], cells: [1; 3], after: 0 }.mesh();
    let deck = cube.cards("PART")
        + &cube.set("BASE", |at| at[2] == 0.0)
        + &cube.set("HALF", |at| at[2] == 0.0 && at[0] == 1.0)
        + &cube.set("CORNER", |at| at == [1.0; 3])
        + "*MATERIAL, NAME=M\n*ELASTIC\n210000., 0.3\n*SOLID SECTION, ELSET=PART, MATERIAL=M\n\
           *TRANSFORM, NSET=HALF, TYPE=C\n0., 0.5, 0., 0., 0.5, 1.\n*BOUNDARY\nBASE, 1, 3\n*STEP\n*STATIC\n\
           *CLOAD\nCORNER, 3, -100.\nCORNER, 1, 50.\n*NODE PRINT, NSET=HALF, TOTALS=YES\nU, RF\n\
           *NODE PRINT, NSET=HALF, GLOBAL=YES\nRF\n*NODE FILE, GLOBAL=NO\nRF\n*END STEP\n";
    desk.write("cube.inp", deck);
    let run = desk.run(&["ccx", "cube"]).ends_with(0);
    assert_eq!(read(&desk, "cube.dat"), LOCAL);
    assert!(run.stdout.contains("GLOBAL=NO of *NODE FILE"), "{}", run.stdout);
}

/// The upper block is glued to the lower one and pulled up by 3: as in CalculiX, the forces of its nodes are those of
/// the load and of the tie, and cancel; the base pulls down. An answer without ties leaves no multiplier of ties
/// behind.
#[test]
fn forces_of_ties_are_part_of_the_forces_of_nodes() {
    let desk = Desk::new();
    let below = Block { element: "C3D8", low: [0.0; 3], high: [1.0; 3], cells: [2, 2, 1], after: 0 }.mesh();
    let above = Block { element: "C3D8", low: [0.0, 0.0, 1.0], high: [1.0, 1.0, 2.0], cells: [3, 3, 1], after: 100 };
    let above = above.mesh();
    let deck = below.cards("PART")
        + &above.cards("PART")
        + &below.set("BASE", |at| at[2] == 0.0)
        + &above.set("UPPER", |_| true)
        + &above.set("END", |at| at[2] == 2.0)
        + &below.surface("MASTER", |at| at[2] == 1.0)
        + &above.surface("SLAVE", |at| at[2] == 1.0)
        + &above.surface("TOP", |at| at[2] == 2.0)
        + "*MATERIAL, NAME=M\n*ELASTIC\n200., 0.\n*SOLID SECTION, ELSET=PART, MATERIAL=M\n*BOUNDARY\nBASE, 1, 3\n\
           *TIE, NAME=T\nSLAVE, MASTER\n*STEP\n*STATIC\n*DSLOAD\nTOP, P, -3.\n*NODE FILE\nRF\n\
           *NODE PRINT, NSET=BASE, TOTALS=ONLY\nRF\n*NODE PRINT, NSET=END, TOTALS=ONLY\nRF\n*END STEP\n";
    desk.write("glued.inp", &deck);
    desk.run(&["ccx", "glued"]).ends_with(0);
    let forces = field(&read(&desk, "glued.frd"), "FORC");
    let sum = |is_in: &dyn Fn(usize) -> bool| -> f64 {
        forces.iter().filter(|(number, _)| is_in(*number)).map(|(_, force)| force[2]).sum()
    };
    // Sums of 16 numbers of six digits.
    assert!(sum(&|number| number > 100).abs() < 1e-4, "{forces:?}");
    assert!((sum(&|number| number <= 9) + 3.0).abs() < 1e-4, "{forces:?}");
    let is_slave = |number: usize| above.nodes.iter().any(|(own, at)| *own == number && at[2] == 1.0);
    assert!((sum(&is_slave) + 3.0).abs() < 1e-4, "{forces:?}");
    let dat = read(&desk, "glued.dat");
    for (set, force) in [("BASE", "-3.000000E+00"), ("END", " 3.000000E+00")] {
        let (_, after) = dat.split_once(&format!("for set {set} and time ")).unwrap();
        assert!(after.lines().nth(2).unwrap().ends_with(force), "{dat}");
    }
    assert!(desk.path("glued.signorini/mu.mtx").exists());
    desk.write("glued.inp", deck.replace("*TIE, NAME=T\nSLAVE, MASTER\n", "*BOUNDARY\nEND, 1, 2\nUPPER, 3\n"));
    desk.run(&["ccx", "glued"]).ends_with(0);
    assert!(!desk.path("glued.signorini/mu.mtx").exists());
}

/// A plate under tension, 50 degrees warmer: across its plane it has the strain of stress and temperature.
#[test]
fn plane_stress_has_the_strain_across_the_plane() {
    let mesh = Block { element: "CPS8", low: [0.0; 3], high: [2.0, 1.0, 0.0], cells: [2, 1, 0], after: 0 }.mesh();
    let deck = |elastic: &str| {
        mesh.cards("PART")
            + &mesh.set("X0", |at| at[0] == 0.0)
            + &mesh.set("Y0", |at| at[1] == 0.0)
            + &mesh.surface("END", |at| at[0] == 2.0)
            + "*MATERIAL, NAME=M\n*ELASTIC"
            + elastic
            + "*EXPANSION, ZERO=20.\n1.E-3\n*SOLID SECTION, ELSET=PART, MATERIAL=M\n\
               *INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 20.\n*BOUNDARY\nX0, 1\nY0, 2\n*STEP\n*STATIC\n\
               *TEMPERATURE\nALL, 70.\n*DSLOAD\nEND, P, -3.\n*NODE FILE\nNT\n*EL FILE\nE\n*END STEP\n"
    };
    let all = ["\n200., 0.25\n", ", TYPE=ENGINEERING CONSTANTS\n200., 200., 200., 0.25, 0.25, 0.25, 80., 80.,\n80.\n"];
    for elastic in all {
        let desk = Desk::new();
        desk.write("plate.inp", deck(elastic));
        desk.run(&["ccx", "plate"]).ends_with(0);
        let frd = read(&desk, "plate.frd");
        for (_, strain) in field(&frd, "TOSTRAIN") {
            assert_eq!(strain, [0.065, 0.04625, 0.04625, 0.0, 0.0, 0.0], "{elastic}");
        }
        assert!(field(&frd, "NDTEMP").iter().all(|(_, temperature)| *temperature == [70.0]));
    }
}

/// A disc of radius 2 pulled by 3 on its face: fields hold the forces of the ring, tables those of a wedge of two
/// degrees.
#[test]
fn forces_of_a_body_of_revolution_are_of_the_ring_and_of_the_wedge() {
    let mesh = Block { element: "CAX4", low: [0.0; 3], high: [2.0, 1.0, 0.0], cells: [4, 2, 0], after: 0 }.mesh();
    let deck = mesh.cards("PART")
        + &mesh.set("Y0", |at| at[1] == 0.0)
        + &mesh.surface("END", |at| at[1] == 1.0)
        + "*MATERIAL, NAME=M\n*ELASTIC\n200., 0.25\n*SOLID SECTION, ELSET=PART, MATERIAL=M\n*BOUNDARY\nY0, 2\n*STEP\n\
           *STATIC\n*DSLOAD\nEND, P, -3.\n*NODE FILE\nRF\n*NODE PRINT, NSET=Y0, TOTALS=ONLY\nRF\n\
           *EL PRINT, ELSET=PART, TOTALS=ONLY\nEVOL\n*END STEP\n";
    let desk = Desk::new();
    desk.write("disc.inp", deck);
    desk.run(&["ccx", "disc"]).ends_with(0);
    let held = |number: usize| mesh.nodes.iter().any(|(own, at)| *own == number && at[1] == 0.0);
    let forces = field(&read(&desk, "disc.frd"), "FORC");
    let ring: f64 = forces.iter().filter(|(number, _)| held(*number)).map(|(_, force)| force[1]).sum();
    let exact = -3.0 * 4.0 * std::f64::consts::PI;
    assert!((ring / exact - 1.0).abs() < 1e-5, "{ring} instead of {exact}");
    let dat = read(&desk, "disc.dat");
    let wedge = exact / 180.0;
    assert!(dat.contains(&format!("\n        0.000000E+00 {:.6}E-01  0.000000E+00\n", 10.0 * wedge)), "{dat}");
    // The hoop stress is zero, the axial one 3.
    assert!(dat.contains("\n        6.981317E-02\n"), "{dat}");
}

/// A block that walls hold along x and z in plane strain, 50 degrees warmer, free along y, with nu = 0: sigma_x =
/// sigma_z = -E alpha T.
#[test]
fn the_energy_of_plane_strain_has_the_work_across_the_plane() {
    let mesh = Block { element: "CPE4", low: [0.0; 3], high: [2.0, 1.0, 0.0], cells: [2, 2, 0], after: 0 }.mesh();
    let deck = mesh.cards("PART")
        + &mesh.set("ENDS", |at| at[0] == 0.0 || at[0] == 2.0)
        + &mesh.set("Y0", |at| at[1] == 0.0)
        + "*MATERIAL, NAME=M\n*ELASTIC\n200., 0.\n*EXPANSION, ZERO=20.\n1.E-3\n*SOLID SECTION, ELSET=PART, MATERIAL=M\n\
           *INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 20.\n*BOUNDARY\nENDS, 1\nY0, 2\n*STEP\n*STATIC\n\
           *TEMPERATURE\nALL, 70.\n*EL PRINT, ELSET=PART, TOTALS=ONLY\nELSE\n*END STEP\n";
    let desk = Desk::new();
    desk.write("block.inp", deck);
    desk.run(&["ccx", "block"]).ends_with(0);
    // Twice 1/2 sigma^2/E with sigma = 200 * 0.05, on the area 2.
    assert!(read(&desk, "block.dat").contains("\n        1.000000E+00\n"), "{}", read(&desk, "block.dat"));
}

/// Bending about two axes, which quadratic elements represent: with nu = 0 it has the strains e_x = y + 2 z, e_y = 3 x
/// and e_xz = 0.1, and no other shear.
fn bent([x, y, z]: [f64; 3]) -> [f64; 3] {
    [x * y + 2.0 * x * z - 1.5 * y * y + 0.2 * z, 3.0 * x * y - x * x / 2.0, -x * x]
}

/// The coordinates of the points are those at which CalculiX 2.20 printed strains, in its order.
#[test]
fn strains_are_printed_at_the_points_of_calculix_in_its_order() {
    let line = [-0.6_f64.sqrt(), 0.0, 0.6_f64.sqrt()];
    let square = |z: f64| line.map(|y| line.map(|x| [x, y, z])).concat();
    let near = (5.0 - 5.0_f64.sqrt()) / 20.0;
    let tetrahedron =
        [[near; 3], [1.0 - 3.0 * near, near, near], [near, 1.0 - 3.0 * near, near], [near, near, 1.0 - 3.0 * near]];
    let triangle = [[1.0 / 6.0, 1.0 / 6.0, 0.0], [2.0 / 3.0, 1.0 / 6.0, 0.0], [1.0 / 6.0, 2.0 / 3.0, 0.0]];
    for (element, points) in [
        ("C3D10", tetrahedron.to_vec()),
        ("C3D20", line.iter().flat_map(|&z| square(z)).collect()),
        ("CPE6", [triangle; 3].concat()),
        ("CPE8", [square(0.0), square(0.0), square(0.0)].concat()),
    ] {
        let is_solid = element.starts_with("C3D");
        let (low, high, cells) =
            if is_solid { ([-1.0; 3], [1.0; 3], [1; 3]) } else { ([-1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [1, 1, 0]) };
        let mesh = Block { element, low, high, cells, after: 0 }.mesh();
        // One displacement is left to be solved for, along which no traction acts.
        let (middle, _) = *mesh.nodes.iter().find(|(_, at)| at[0] == 0.0).unwrap();
        let (free, axes) = if is_solid { ((middle, 2), 3) } else { ((middle, 0), 2) };
        let held: String = mesh
            .nodes
            .iter()
            .flat_map(|&(number, at)| (0..axes).map(move |axis| ((number, axis), bent(at)[axis])))
            .filter(|(dof, _)| *dof != free)
            .map(|((number, axis), value)| format!("{number}, {}, , {value:.12}\n", axis + 1))
            .collect();
        let deck = mesh.cards("PART")
            + "*MATERIAL, NAME=M\n*ELASTIC\n200., 0.\n*SOLID SECTION, ELSET=PART, MATERIAL=M\n*STEP\n*STATIC\n*BOUNDARY\n"
            + &held
            + "*EL PRINT, ELSET=PART\nE\n*END STEP\n";
        let desk = Desk::new();
        desk.write("bent.inp", deck);
        desk.run(&["ccx", "bent", "--linear"]).ends_with(0);
        let dat = read(&desk, "bent.dat");
        let lines: Vec<Vec<f64>> = dat
            .lines()
            .skip(3)
            .map(|line| line.split_whitespace().map(|word| word.parse().unwrap()).collect())
            .collect();
        assert_eq!(lines.len(), points.len() * mesh.elements.len(), "{dat}");
        let at = |number: usize| mesh.nodes.iter().find(|(own, _)| *own == number).unwrap().1;
        for ((number, nodes), lines) in mesh.elements.iter().zip(lines.chunks(points.len())) {
            for (index, (line, point)) in lines.iter().zip(&points).enumerate() {
                // A simplex has its first corner at the origin of its cell; the other cells are the block.
                let corner = at(nodes[0]);
                let along =
                    |axis: usize| [1, 2, 3].map(|other| at(nodes[other.min(nodes.len() - 1)])[axis] - corner[axis]);
                let is_simplex = points.len() < 10 || element == "CPE6";
                let place = [0, 1, 2].map(|axis| match is_simplex {
                    true => {
                        corner[axis] + (0..if is_solid { 3 } else { 2 }).map(|k| point[k] * along(axis)[k]).sum::<f64>()
                    }
                    false => point[axis],
                });
                assert_eq!((line[0] as usize, line[1] as usize), (*number, index + 1));
                // The order is xx, yy, zz, xy, xz, yz.
                let shear = if is_solid { 0.1 } else { 0.0 };
                let exact = [place[1] + 2.0 * place[2], 3.0 * place[0], 0.0, 0.0, shear, 0.0];
                for (found, exact) in line[2..].iter().zip(exact) {
                    assert!((found - exact).abs() < 2e-6, "{element} {number} point {}: {line:?} {exact:?}", index + 1);
                }
            }
        }
    }
}
