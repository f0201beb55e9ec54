//! `signorini sweep`: one scene at several gaps or forces, or one problem directory on the way to its other end.

use super::about::about;
use super::input::{Input, check_contact, scene_title, still_model, warnings};
use super::options::{Gaps, Sweep};
use super::outcome::{Outcome, Report, unfit, warn};
use super::settings::settings;
use crate::Error;
use crate::output::{InWords, Pictures, Wanted};
use crate::qp::memory::in_words as written;
use crate::qp::{ContactProblem, Watch, memory};
use crate::scene::Scene;
use crate::study::{ProblemSweep, Sweep as Swept};

pub(super) fn run(options: &Sweep, watch: &Watch) -> Result<Outcome, Error> {
    check_contact(&options.scene)?;
    // Any other folder is refused as a scene.
    let is_problem = ContactProblem::is_directory(&options.scene);
    match (is_problem, options.points) {
        (true, Some(points)) => of_problem(options, points, watch),
        (true, None) => {
            let given = if options.gaps.is_some() { "--gaps" } else { "--forces" };
            let name = options.scene.display();
            let message = format!(
                "{name} is a problem directory, which is swept from g.mtx, f.mtx to g1.mtx, f1.mtx; give --points \
                 instead"
            );
            unfit(given, message)
        }
        (false, Some(_)) => {
            let name = options.scene.display();
            unfit("--points", format!("{name} is not a problem directory; a scene is swept over --gaps or --forces"))
        }
        (false, None) => of_scene(options, watch),
    }
}

fn of_scene(options: &Sweep, watch: &Watch) -> Result<Outcome, Error> {
    let common = &options.common;
    let model = still_model(&options.scene, &common.limits)?;
    warn(&warnings(&model));
    let title = scene_title(&model, &options.scene);
    let about = about(&title, "sweep", &options.scene, common.out.as_ref(), common.threads);
    let settings = settings(options.method, common, watch);
    let even = |range: &Gaps| Swept::even_gaps(range.first, range.last, range.count);
    let swept = match (&options.gaps, &options.forces) {
        (_, Some(forces)) => Swept::over_forces(&model, &even(forces), &settings)
            .map_err(|error| Scene::located(error, &options.scene))?,
        (gaps, None) => Swept::over_gaps(&model, &gaps.as_ref().map_or_else(Vec::new, even), &settings)?,
    };
    watch.step("report", 0);
    let text = swept.text(&title, model.units());
    let report = Report::new(&swept, text)?;
    let status = swept.points.iter().map(|point| point.summary.status).collect();
    let Some(folder) = common.out.clone() else { return Ok(report.outcome(common.format, status)) };
    report.write(&folder)?;
    let outcome = report.outcome(common.format, status);
    let wanted = with_room(common.wanted(Pictures::usual_of_series(&model)), &swept, common.limits.most_memory());
    Ok(outcome.with_pictures(move || {
        about.write_sweep(&folder, &swept)?;
        wanted.write_sweep(&folder, &swept)
    }))
}

/// The pictures of a sweep that fit into the memory that its answers leave of `most` bytes: all, or its curves alone.
fn with_room(wanted: Wanted, swept: &Swept, most: f64) -> Wanted {
    let Some(first) = swept.points.first().filter(|_| wanted.pictures == Pictures::All) else { return wanted };
    let count = swept.points.len();
    let needed = Wanted::bytes(count as f64, first.answer.model().problem().dofs() as f64);
    let left = most - memory::held();
    if needed <= left {
        return wanted;
    }
    let [needed, left] = [needed, left.max(0.0)].map(written);
    warn(&format!(
        "warning: {count} pictures take about {needed} of memory, and {left} are left: only the curves are drawn\n"
    ));
    Wanted { pictures: Pictures::Answer, ..wanted }
}

fn of_problem(options: &Sweep, points: usize, watch: &Watch) -> Result<Outcome, Error> {
    let common = &options.common;
    let input = Input::read(&options.scene, &common.limits)?;
    let last = input.problem().read_other_end(&options.scene)?;
    let settings = settings(options.method, common, watch);
    let swept = ProblemSweep::of(input.problem(), &last, points, &settings)?;
    watch.step("report", 0);
    let report = Report::new(&swept, swept.text(&input.title, &input.units))?;
    let status = swept.points.iter().map(|point| point.summary.status).collect();
    let Some(folder) = common.out.clone() else { return Ok(report.outcome(common.format, status)) };
    let wanted = common.wanted(Pictures::All);
    Wanted::write_points(&folder, &swept)?;
    report.write(&folder)?;
    let outcome = report.outcome(common.format, status);
    Ok(outcome.with_pictures(move || wanted.draw_problem_sweep(&folder, &input.title, &swept)))
}
