//! The short and the long form of a test differ in the number of cases and in the seed.

use std::process::Command;

/// The test runs itself: each form is that of a process.
#[test]
fn the_long_form_has_more_cases_and_a_seed_that_is_printed_and_kept() {
    const NAME: &str = "effort::the_long_form_has_more_cases_and_a_seed_that_is_printed_and_kept";
    if std::env::var_os("FORM").is_some() {
        println!("{} cases of seed {}", support::cases(2, 30), support::seed(5));
        return;
    }
    let target = tempfile::tempdir().unwrap();
    let run = |asked: Option<&str>| {
        let mut test = Command::new(std::env::current_exe().unwrap());
        test.args([NAME, "--exact", "--nocapture"]).env("FORM", "").env("CARGO_TARGET_DIR", target.path());
        match asked {
            Some(asked) => test.env("SIGNORINI_LONG", asked),
            None => test.env_remove("SIGNORINI_LONG"),
        };
        let output = test.output().unwrap();
        output.status.success().then(|| String::from_utf8(output.stdout).unwrap())
    };
    let kept = || std::fs::read_to_string(target.path().join("long-seeds.txt")).unwrap_or_default();
    assert!(run(None).unwrap().contains("2 cases of seed 5\n"));
    assert_eq!(kept(), "");
    let line = format!("{NAME} SIGNORINI_LONG=17\n");
    let long = run(Some("17")).unwrap();
    assert!(long.contains(&line) && long.contains("30 cases of seed 17\n"), "{long}");
    let fresh = [(); 2].map(|()| run(Some("fresh")).unwrap());
    assert!(fresh.iter().all(|long| long.contains("30 cases of seed ")));
    let kept = kept();
    let lines: Vec<&str> = kept.split_inclusive('\n').collect();
    assert!(lines.len() == 3 && lines[0] == line && lines[1] != lines[2], "{lines:?}");
    assert!(fresh.iter().zip(&lines[1..]).all(|(long, line)| long.contains(line)), "{lines:?}");
    assert!(["", "1e3", "-1", "long"].iter().all(|wrong| run(Some(wrong)).is_none()));
}
