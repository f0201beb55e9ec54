//! `signorini sensitivity`: derivatives of outputs.

use serde_json::json;

use super::about::about;
use super::input::{Content, Input, Source, add_error_and_energy};
use super::options::Sensitivity;
use super::outcome::{Outcome, Report, unfit, warn};
use super::settings::settings;
use crate::Error;
use crate::output::{InWords, Pictures, Wanted, rows_at_kink, tables_of_places, write_files};
use crate::qp::Watch;
use crate::scene::Sensitivities;

/// The parameter that is no number of the scene.
const PLACES: &str = "nodes";

pub(super) fn run(options: &Sensitivity, watch: &Watch) -> Result<Outcome, Error> {
    let common = &options.common;
    let Source::Scene(scene, read_seconds) = Source::read(&options.scene, &common.limits)? else {
        let name = options.scene.display();
        return unfit(
            "scene",
            format!("{name} is a problem directory, which has no outputs; derivatives need a scene"),
        );
    };
    scene.check_size(common.limits.most_memory())?;
    let input = Input::of_scene(&scene, &options.scene, &common.limits, read_seconds)?;
    warn(&input.warnings());
    let Content::Scene(model) = &input.content else { return unfit("scene", "there is no body") };
    let about = about(&input.title, "sensitivity", &options.scene, common.out.as_ref(), common.threads);
    let numbers: Vec<String> = scene.parameters().into_iter().filter(|name| name != PLACES).collect();
    let (outputs, parameters) = (names(&options.of), names(&options.to));
    let parameters = if parameters.is_empty() { numbers.iter().map(String::as_str).collect() } else { parameters };
    let settings = settings(options.method, common, watch);
    let found = Sensitivities::of(&scene, model.clone(), &outputs, &parameters, &settings)?;
    watch.step("report", 0);
    let mut summary = input.summary(found.solution.clone(), Some(&found.answer), settings.goal())?;
    add_error_and_energy(&mut summary, &found.answer)?;
    let mut text = found.text(&input.title, &input.units);
    if options.explain {
        text += &rows_at_kink(&found);
    }
    let status = summary.status;
    let report = json!({
        "answer": summary,
        "sensitivities": found.outputs,
        "at_kink": found.at_kink,
        "seconds_of_derivatives": found.seconds,
    });
    let written = Report::new(&report, text)?;
    let Some(folder) = common.out.clone() else { return Ok(written.outcome(common.format, status)) };
    Wanted::write_answer(&folder, &summary.solution, Some(&found.answer))?;
    let tables = tables_of_places(&found);
    let tables: Vec<(&str, &str)> = tables.iter().map(|(name, text)| (name.as_str(), text.as_str())).collect();
    write_files(&folder, &tables)?;
    written.write_with_text(&folder, "sensitivity.txt")?;
    let outcome = written.outcome(common.format, status);
    let wanted = common.wanted(Pictures::Answer);
    Ok(outcome.with_pictures(move || {
        about.write_sensitivity(&folder, (&found.answer, &summary), &report)?;
        wanted.write_solve(&folder, &found.answer, &summary.solution.history)
    }))
}

/// The names in lists that commas separate. A comma before a number belongs to a place.
fn names(lists: &[String]) -> Vec<&str> {
    let mut names = Vec::new();
    for list in lists {
        let (mut start, bytes) = (0, list.as_bytes());
        for (at, _) in list.match_indices(',') {
            let next = bytes[at + 1..].iter().find(|byte| **byte != b' ');
            if next.is_none_or(|byte| byte.is_ascii_alphabetic()) {
                names.push(list[start..at].trim());
                start = at + 1;
            }
        }
        names.push(list[start..].trim());
    }
    names.retain(|name| !name.is_empty());
    names
}

#[cfg(test)]
mod tests {
    use super::names;

    #[test]
    fn commas_separate_names_but_not_the_coordinates_of_a_place() {
        let lists = ["force, stress@0.5,-1:xx,width,".to_string(), "pressure@1, 2".to_string()];
        assert_eq!(names(&lists), ["force", "stress@0.5,-1:xx", "width", "pressure@1, 2"]);
    }
}
