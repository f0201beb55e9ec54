//! Answers as text and as JSON.

use super::certificate::{CertificateWords, conditions};
use super::means::{between_text, means_text};
use crate::text::printable;
use signorini_mechanics::scene::{ContactExtent, Resultant, Rule, Segment, Units, Warning};
use signorini_qp::memory::in_words as memory;
use signorini_qp::{Certificate, Goal, ProvenSet, Why};
use signorini_study::{
    Agreement, ContactSummary, ObstacleContact, Summary, Sweep, SweepEvent, SweepPoint, Verification,
};

pub(crate) fn quantity(value: f64, unit: &str) -> String {
    format!("{value:.6e} {}", printable(unit)).trim_end().to_string()
}

pub(crate) fn plural(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// An algebraic error below this share of the mesh error does not show in the sum of both.
const FAR_BELOW: f64 = 1e-2;

/// Length of a line beside its name, in characters.
const LONGEST_LINE: usize = 84;

/// What a report with planes of symmetry gives of the part, and what the scene does.
const OF_SYMMETRY: &str = "method, certificate, seconds and memory are of the meshed part; in the scene the force on an obstacle is of \
                           the whole body, loads, springs and rigid faces are of the meshed part";

/// The report of one answer, in lines of at most 100 characters: contact, certificate, sizes, seconds and warnings.
pub(crate) fn solve_text(title: &str, summary: &Summary, units: &Units) -> String {
    let Summary { solution, contact, model, seconds, .. } = summary;
    let mesh = match (model.nodes, model.elements) {
        (Some(nodes), Some(elements)) => format!("{nodes} nodes, {elements} elements, "),
        _ => String::new(),
    };
    let mut text = format!("{}\n", printable(title));
    let of_part = of_part(summary);
    let mut lines = |name: &str, content: Vec<String>| text += &entries(name, content);
    lines("model", vec![format!("{mesh}{} dofs, {}{of_part}", model.dofs, model.rows_in_words())]);
    if summary.parts_of_whole.is_some() {
        lines("symmetry", wrapped(OF_SYMMETRY));
    }
    if let Some(overlap) = &summary.initial_overlap {
        lines("", wrapped(&printable(overlap)));
    }
    let unknowns = match model.condensed_dofs {
        all if all == model.dofs => ", on all dofs".to_string(),
        condensed => format!(", condensed to {condensed} dofs"),
    };
    lines("method", vec![format!("{}, {}{unknowns}", solution.method, plural(solution.iterations, "iteration"))]);
    if solution.refinements > 0 {
        lines("", vec![plural(solution.refinements, "refinement")]);
    }
    if !solution.reason.is_empty() {
        lines("", vec![solution.reason.clone()]);
    }
    for attempt in &solution.attempts {
        let reason = printable(&attempt.reason);
        let words = format!("also tried: {}, {:.3} s, {reason}", attempt.method, attempt.seconds);
        lines("", wrapped(&words));
    }
    if let Some(penalty) = solution.history.last().map(|step| step.penalty).filter(|&penalty| penalty > 0.0) {
        lines("", vec![format!("the penalty went up to {penalty:.0e} times the local stiffness")]);
    }
    let (closed, force) = (plural(contact.count, "closed row"), quantity(contact.force, &units.force));
    let basis = if summary.force_basis.is_empty() { String::new() } else { format!(" {}", summary.force_basis) };
    let mut of_contact = match contact.is_of_several() {
        false => wrapped(&format!("{closed}{of_part}, sum of multipliers {force}{basis}")),
        true => {
            let sizes = if basis.is_empty() { basis } else { format!("; forces{basis}") };
            let images = if of_part.is_empty() { "" } else { ", mirror images included" };
            let count = plural(contact.obstacles_of_whole(), "obstacle");
            wrapped(&format!("{closed}{of_part}, on {count}{images}{sizes}"))
        }
    };
    of_contact.extend(match contact.is_of_several() {
        false => extent_lines(contact, units),
        true => obstacle_lines(contact, units),
    });
    let between = |one| between_text(one, |length| quantity(length, &units.length));
    of_contact.extend(contact.obstacles.iter().filter_map(between).flat_map(|text| wrapped(&text)));
    lines("contact", of_contact);
    if let Some(proven) = &solution.proven {
        let part = if of_part.is_empty() { String::new() } else { format!(",{of_part}") };
        lines("", vec![proven_text(proven) + &part]);
    }
    lines("", means_text(contact).map_or_else(Vec::new, |words| wrapped(&words)));
    if let Some(balance) = contact.force_balance {
        lines("", vec![format!("loads, reactions and contact forces{of_part} balance to {balance:.1e}")]);
    }
    text += &resultants_text(summary, units);
    text += &displacement_text(summary, units);
    text += &certificate_text(&solution.certificate, summary.goal);
    text += &warnings_text(&summary.warnings);
    text += &mesh_text(summary, units);
    text += &entry(
        "seconds",
        &format!(
            "assemble {:.3}, factor {:.3}, solve {:.3}, proof {:.3}, total {:.3}",
            seconds.assemble, seconds.factor, seconds.solve, seconds.proof, seconds.total
        ),
    );
    text
}

/// The estimates before a solve and the reason of the choice, in lines of at most 100 characters.
pub fn why_text(why: &Why) -> String {
    let expected = why.considered.iter().map(|expected| {
        let taken = if expected.method == why.chosen { ", chosen" } else { "" };
        let (seconds, memory) = (expected.seconds, memory(expected.bytes));
        format!("{:<8}{seconds:.1e} s, {memory}{taken}", expected.method)
    });
    listed("why", vec![why.reason.clone()]) + &entries("expected", expected)
}

/// A number with its uncertainty, if it has one above rounding, and its unit.
fn within(value: f64, uncertainty: Option<f64>, unit: &str) -> String {
    match uncertainty.filter(|&off| off > SHOWN * value) {
        Some(off) => format!("{value:.6e} ± {off:.1e} {}", printable(unit)).trim_end().to_string(),
        None => quantity(value, unit),
    }
}

/// The largest pressure, and the extent of the contact.
fn extent_lines(contact: &ContactSummary, units: &Units) -> Vec<String> {
    let (Some(pressure), Some(area)) = (contact.pressure_max, contact.area) else { return Vec::new() };
    let square = square(units);
    let Some(estimate) = &contact.estimate else {
        return vec![format!(
            "peak pressure {}, area {}",
            quantity(pressure, &units.pressure()),
            quantity(area, &square)
        )];
    };
    let extent = match estimate.width {
        Some(width) => {
            let of_section = if contact.width.is_none() && !estimate.from_axis { " in the section" } else { "" };
            let size = within(width, estimate.width_uncertainty, &units.length);
            format!("{}{of_section} {size}", width_word([*estimate].into_iter()))
        }
        None => format!("area {}", within(estimate.area, Some(estimate.area_uncertainty), &square)),
    };
    let peak = within(pressure, estimate.pressure_uncertainty, &units.pressure());
    vec![format!("peak pressure {peak}"), format!("estimated {extent}")]
}

/// The name of widths: of contacts that begin at an axis of revolution they are radii.
fn width_word(mut extents: impl Iterator<Item = ContactExtent>) -> &'static str {
    if extents.all(|extent| extent.from_axis) { "radius" } else { "width" }
}

/// The words that name the meshed part behind numbers of it; empty without planes of symmetry.
pub(crate) fn of_part(summary: &Summary) -> &'static str {
    if summary.parts_of_whole.is_some() { " of the meshed part" } else { "" }
}

/// The table of obstacles and pairs of bodies, a line for each.
fn obstacle_lines(contact: &ContactSummary, units: &Units) -> Vec<String> {
    obstacle_table("", &[(String::new(), contact)], units).lines().map(|line| line.trim_start().into()).collect()
}

/// The table of obstacles and pairs of bodies at each of some values of a quantity, a line for each; without a name the
/// values are left out.
fn obstacle_table(name: &str, contacts: &[(String, &ContactSummary)], units: &Units) -> String {
    let all = || contacts.iter().flat_map(|(_, contact)| &contact.obstacles);
    let with_width = || all().filter_map(|one| one.estimate.filter(|estimate| estimate.width.is_some()));
    let has_width = with_width().next().is_some();
    let is_pressed = all().any(|one| one.travel.is_some());
    let shown = |value: Option<f64>| value.map_or_else(|| "-".to_string(), |value| format!("{value:.5e}"));
    let within = |value: Option<f64>, off: Option<f64>| match (value, off) {
        (Some(size), Some(off)) if off > SHOWN * size => format!("{size:.5e} ± {off:.1e}"),
        _ => shown(value),
    };
    type One<'a> = (&'a String, &'a ObstacleContact);
    let obstacle = |(_, one): &One| match one.copies {
        1 => one.of.clone(),
        2 => format!("{}, twice", one.of),
        copies => format!("{}, {copies} times", one.of),
    };
    let peak = |(_, one): &One| {
        within(Some(one.pressure_max), one.estimate.and_then(|estimate| estimate.pressure_uncertainty))
    };
    let extent = |(_, one): &One| {
        let off = one.estimate.and_then(|of| if has_width { of.width_uncertainty } else { Some(of.area_uncertainty) });
        within(one.estimate.map(|of| of.width.unwrap_or(of.area)), off)
    };
    let of_extent =
        if has_width { in_unit(width_word(with_width()), &units.length) } else { in_unit("area", &square(units)) };
    let [force, travel] = [in_unit("force", &units.force), in_unit("travel", &units.length)];
    let [of_peak, of_mean] = ["peak p", "mean p"].map(|name| in_unit(name, &units.pressure()));
    let all_columns: [Column<One>; 7] = [
        (name, &|(value, _)| value.to_string()),
        ("obstacle", &obstacle),
        (&force, &|(_, one)| shown(Some(one.force))),
        (&travel, &|(_, one)| shown(one.travel)),
        (&of_peak, &peak),
        (&of_extent, &extent),
        (&of_mean, &|(_, one)| shown(one.pressure_mean)),
    ];
    let is_kept = |column: usize| (column != 0 || !name.is_empty()) && (column != 3 || is_pressed);
    let kept: Vec<Column<One>> = (0..7).filter(|&column| is_kept(column)).map(|column| all_columns[column]).collect();
    let ones = contacts.iter().flat_map(|(value, contact)| contact.obstacles.iter().map(move |one| (value, one)));
    columns(&table(&ones.collect::<Vec<_>>(), &kept))
}

/// Components below this share of the largest one, and uncertainties below this share of their value, are rounding in a
/// text.
const SHOWN: f64 = 1e-11;

/// Resultants and segments that are shown; the JSON report has all.
const MOST_LINES: usize = 12;

/// Components as a text; those that are rounding beside `scale` are zero.
fn rounded(values: &[f64], scale: f64) -> String {
    let part = |&value: &f64| if value.abs() <= SHOWN * scale { "0".into() } else { format!("{value:.4e}") };
    let parts: Vec<String> = values.iter().map(part).collect();
    if parts.len() == 1 { parts.concat() } else { format!("({})", parts.join(", ")) }
}

/// The resultants, one in a line, and the contact segments if there are several.
fn resultants_text(summary: &Summary, units: &Units) -> String {
    let largest = |of: fn(&Resultant) -> &[f64]| {
        let values = summary.resultants.iter().flat_map(of);
        values.fold(0.0, |largest: f64, value| largest.max(value.abs()))
    };
    let force_scale = largest(|resultant| &resultant.force);
    let length_scale = largest(|resultant| resultant.centre.as_deref().unwrap_or_default());
    let (force, place) = (|values: &[f64]| rounded(values, force_scale), |at: &[f64]| rounded(at, length_scale));
    let behind = |unit: &str| if unit.trim().is_empty() { String::new() } else { format!(" {unit}") };
    let (of_force, of_length) = (behind(&units.force), behind(&units.length));
    let of_moment = behind(&format!("{} {}", units.force, units.length));
    let resultant = |resultant: &Resultant| {
        let on = resultant.on.as_ref().map_or_else(String::new, |on| format!(" on {}", printable(on)));
        let rule = match resultant.rule {
            Some(Rule::Approach) => " (rule approach)",
            Some(Rule::ClosestPoint) => " (rule closest-point)",
            None => "",
        };
        let mut text = format!("{}{on}{rule}: force {}{of_force}", resultant.of, force(&resultant.force));
        if !resultant.moment.is_empty() {
            text += &format!(", moment {}{of_moment}", rounded(&resultant.moment, force_scale * length_scale));
        }
        if let Some(centre) = &resultant.centre {
            text += &format!(", through {}{of_length}", place(centre));
        }
        if let Some(motion) = &resultant.motion {
            text += &format!(", moved {}{of_length}", rounded(&motion.displacement, 0.0));
            if !motion.rotation.is_empty() {
                text += &format!(", turned {}", rounded(&motion.rotation, 0.0));
            }
        }
        for (name, value) in [("travel", resultant.travel), ("shortening", resultant.shortening)] {
            text += &value.map_or_else(String::new, |value| format!(", {name} {value:.6e}{of_length}"));
        }
        text += &resultant.tension.map_or_else(String::new, |value| format!(", tension {value:.6e}{of_force}"));
        text
    };
    let segment = |segment: &Segment| {
        let where_it_is = match (&segment.ends, &segment.centre) {
            (Some([from, to]), _) => format!("from {} to {} {}", place(from), place(to), units.length),
            (None, Some(centre)) => format!("around {} {}", place(centre), units.length),
            (None, None) => String::new(),
        };
        let (count, force) = (plural(segment.nodes.len(), "node") + of_part(summary), force(&segment.force));
        format!("obstacles[{}]: {count}, force {force} {} {where_it_is}", segment.obstacle, units.force)
            .trim_end()
            .to_string()
    };
    let mut text = listed("resultants", summary.resultants.iter().map(resultant).collect());
    if summary.segments.len() > 1 {
        text += &listed("segments", summary.segments.iter().map(segment).collect());
    }
    text
}

/// The largest component of the displacement, with its place.
fn displacement_text(summary: &Summary, units: &Units) -> String {
    let Some(largest) = &summary.largest_displacement else { return String::new() };
    if largest.value == 0.0 {
        return entry("displacement", "0 everywhere");
    }
    let (node, place) = (largest.node, &largest.place);
    let (value, axis) = (quantity(largest.value, &units.length), ["x", "y", "z"][largest.axis]);
    let scale = place.iter().fold(0.0, |scale: f64, part| scale.max(part.abs()));
    let at = format!("{} {}", rounded(place, scale), printable(&units.length));
    listed(
        "displacement",
        vec![format!("largest {value} along {axis}, at node {node}{}, {}", of_part(summary), at.trim_end())],
    )
}

/// Sentences beside a name, the first ones of many. For the program.
pub fn listed(name: &str, sentences: Vec<String>) -> String {
    let more = sentences.len().saturating_sub(MOST_LINES);
    let shown = sentences.into_iter().take(MOST_LINES);
    let more = (more > 0).then(|| format!("and {more} more in the JSON report"));
    entries(name, shown.chain(more).flat_map(|sentence| wrapped(&sentence)))
}

/// Undecided rows that are named; the JSON report names all.
const NAMED_ROWS: usize = 8;

/// The proven part of the contact set.
pub(crate) fn proven_text(proven: &ProvenSet) -> String {
    let (open, closed) = (proven.open.count(), proven.closed.count());
    let undecided: Vec<usize> = proven.undecided().collect();
    let of = format!("{closed} proven closed, {open} proven open by the bound below");
    match undecided.len() {
        0 => of,
        count => {
            let mut named: Vec<String> = undecided.iter().take(NAMED_ROWS).map(usize::to_string).collect();
            if count > NAMED_ROWS {
                named.push("...".to_string());
            }
            format!("{closed} proven closed, {open} open, {count} undecided: {}", named.join(" "))
        }
    }
}

/// The warnings in full sentences.
pub(crate) fn warnings_text(warnings: &[Warning]) -> String {
    warnings.iter().map(|warning| entries("warning", wrapped(&printable(&warning.message)))).collect()
}

/// The mesh error, and a comparison with the algebraic error.
fn mesh_text(summary: &Summary, units: &Units) -> String {
    let Some(of_mesh) = summary.discretisation_error else { return String::new() };
    let energy = summary.strain_energy.map_or_else(String::new, |energy| {
        let unit = format!("{} {}", units.force, units.length);
        entry("energy", format!("strain energy {energy:.6e} {}", printable(&unit)).trim_end())
    });
    let of_stresses = format!("relative error in the energy norm about {of_mesh:.1e}, estimated from the stresses");
    let mut text = energy + &listed("mesh", vec![of_stresses]);
    let bound = summary.solution.certificate.energy_error_bound;
    if !of_mesh.is_finite() || !bound.is_finite() {
        let reason = match bound.is_finite() {
            false => "the answer has no error bound",
            true => "the error of the mesh could not be estimated",
        };
        return text + &entry("", &format!("no advice on tolerance and mesh: {reason}"));
    }
    if bound < of_mesh * FAR_BELOW {
        text += &entry("", "the error of the solver is far smaller: only a finer mesh improves the answer");
    } else if bound.is_finite() && bound > of_mesh {
        text += &entry("", "the error of the solver may be larger: tighten the tolerance, then refine the mesh");
    }
    text
}

/// A sentence in lines that fit beside the names of entries.
pub(crate) fn wrapped(sentence: &str) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in sentence.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.is_empty() => line.push_str(word),
            Some(line) if line.chars().count() + word.chars().count() < LONGEST_LINE => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_string()),
        }
    }
    lines
}

pub(crate) fn entry(name: &str, content: &str) -> String {
    format!("  {name:<14}{content}\n")
}

/// Lines beside one name: the first has it, the others are below.
pub(crate) fn entries(name: &str, lines: impl IntoIterator<Item = String>) -> String {
    let names = std::iter::once(name).chain(std::iter::repeat(""));
    names.zip(lines).map(|(name, line)| entry(name, &line)).collect()
}

/// The conditions that an answer was checked against, and the result.
fn certificate_text(certificate: &Certificate, goal: Goal) -> String {
    let CertificateWords { verdict, conditions, notes } = CertificateWords::of(certificate, goal);
    let condition = |(name, formula, value)| format!("{name:<18}{formula:<38}{value}");
    let conditions = conditions.into_iter().map(condition);
    entries("certificate", std::iter::once(verdict).chain(conditions).chain(notes))
}

/// The report of a verification, in lines of at most 100 characters: sizes, total force, every condition with its
/// value, and the bound.
pub(crate) fn verify_text(title: &str, verification: &Verification) -> String {
    let Verification { model, contact, .. } = verification;
    let mut text = format!("{}\n", printable(title));
    text += &entry("model", &format!("{} dofs, {}", model.dofs, model.rows_in_words()));
    text += &entry("contact", &format!("{}, sum of multipliers {:.6e}", plural(contact.count, "row"), contact.force));
    text += &certificate_text(&verification.certificate, verification.tolerance.into());
    text + &warnings_text(&verification.warnings)
}

/// Events of a sweep that its text shows; the rest is in the JSON form.
const MOST_EVENTS: usize = 40;

/// The first events of a sweep, a line for each: the place, what touches or releases there, and `true` if it touches.
pub(crate) fn events_text(events: impl ExactSizeIterator<Item = (f64, String, bool)>) -> String {
    let more = events.len().saturating_sub(MOST_EVENTS);
    let line = |(place, what, touches): (f64, String, bool)| {
        vec![format!("  {place:.12}"), what, if touches { "touches" } else { "releases" }.to_string()]
    };
    let shown = columns(&events.take(MOST_EVENTS).map(line).collect::<Vec<_>>());
    shown + &if more > 0 { format!("  and {more} more; --format json has all\n") } else { String::new() }
}

/// The table of a sweep, one line for each gap or force, and the events between its gaps.
pub(crate) fn sweep_text(title: &str, sweep: &Sweep, units: &Units) -> String {
    let is_of_forces = sweep.points.first().is_some_and(|point| point.force.is_some());
    // Outside plane strain and plane stress a contact has an area.
    let has_width = sweep.points.first().is_none_or(|point| point.summary.contact.width.is_some());
    // Sums over several obstacles are the answer to no question: each has its own lines.
    let several = sweep.points.first().is_some_and(|point| point.summary.contact.is_of_several());
    let extent = match has_width {
        true => in_unit("estimated width", &units.length),
        false => in_unit("estimated area", &square(units)),
    };
    let swept = match (is_of_forces, several) {
        (true, false) => in_unit("travel", &units.length),
        (true, true) => in_unit("swept force", &units.force),
        (false, _) => in_unit("gap", &units.length),
    };
    let value = |point: &SweepPoint| match (point.force, point.travel()) {
        (Some(force), _) if several => format!("{force:.6e}"),
        (_, Some(travel)) if is_of_forces => format!("{travel:.6e}"),
        _ => format!("{:.6}", point.gap),
    };
    let [force, peak] = [in_unit("-sum(lambda)", &units.force), in_unit("peak pressure", &units.pressure())];
    let extent_of = |point: &SweepPoint| match &point.summary.contact {
        ContactSummary { width: Some(_), estimate, .. } => {
            format!("{:.6}", estimate.and_then(|estimate| estimate.width).unwrap_or(0.0))
        }
        ContactSummary { area: Some(area), estimate, .. } => {
            format!("{:.6e}", estimate.map_or(*area, |estimate| estimate.area))
        }
        _ => "-".to_string(),
    };
    let all_columns: [Column<SweepPoint>; 8] = [
        (&swept, &value),
        ("iterations", &|point| point.summary.solution.iterations.to_string()),
        ("contact", &|point| point.summary.contact.count.to_string()),
        (&force, &|point| format!("{:.9e}", point.summary.contact.force)),
        (&peak, &|point| format!("{:.6e}", point.summary.contact.pressure_max.unwrap_or(0.0))),
        (&extent, &extent_of),
        ("energy error <=", &|point| conditions(&point.summary.solution.certificate)[5].2.clone()),
        ("status", &|point| point.summary.status.words().to_owned()),
    ];
    let kept = (0..8).filter(|column| !several || !(3..6).contains(column)).map(|column| all_columns[column]);
    let points = columns(&table(&sweep.points, &kept.collect::<Vec<_>>()));
    let mut text = format!("{}\n\n{points}", printable(title));
    if several {
        let contacts: Vec<_> = sweep.points.iter().map(|point| (value(point), &point.summary.contact)).collect();
        text += &format!("\n{}", obstacle_table(&swept, &contacts, units));
    }
    if let Some(first) = sweep.points.first().map(|point| &point.summary) {
        text += &sweep_notes(first).iter().flat_map(|note| wrapped(note)).map(|line| line + "\n").collect::<String>();
    }
    if !sweep.corners.is_empty() {
        let times = plural(sweep.events.len(), "time");
        let row = format!("a row{}", sweep.points.first().map_or("", |point| of_part(&point.summary)));
        text += &format!("\nBetween the first and the last gap {row} touches or releases {times}, exactly at\n");
        let event = |event: &SweepEvent| (event.gap, format!("node {}", event.node), event.touches);
        text += &events_text(sweep.events.iter().map(event));
    }
    text
}

/// What the columns of a sweep are of, if not of the meshed body.
fn sweep_notes(first: &Summary) -> Option<String> {
    let part = "Contact (closed rows), iterations and energy error are of the meshed part, all other columns of the whole body.";
    first.parts_of_whole.map(|_| part.to_string())
}

/// The unit of area; empty without a unit of length.
fn square(units: &Units) -> String {
    if units.length.is_empty() { String::new() } else { format!("{}²", units.length) }
}

/// The name of a quantity with its unit, if there is one.
pub(crate) fn in_unit(name: &str, unit: &str) -> String {
    if unit.is_empty() { name.to_string() } else { format!("{name} [{}]", printable(unit)) }
}

/// The table of a comparison, one line for each method with its differences from the QP, and a line on their agreement.
pub(crate) fn compare_text(title: &str, summaries: &[Summary; 3], agreement: &Agreement, units: &Units) -> String {
    let zero = |value: f64| if value == 0.0 { "0".to_string() } else { format!("{value:.1e}") };
    let [qp, active_set, penalty] = summaries;
    let rows = [
        (qp, "reference".to_string(), "reference".to_string()),
        (active_set, zero(agreement.active_set.displacement), zero(agreement.active_set.multiplier)),
        (penalty, zero(agreement.penalty.displacement), zero(agreement.penalty.multiplier)),
    ];
    let methods = table(
        &rows,
        &[
            ("method", &|(of, ..)| of.solution.method.clone()),
            ("iterations", &|(of, ..)| of.solution.iterations.to_string()),
            ("contact", &|(of, ..)| of.contact.count.to_string()),
            (&in_unit("-sum(lambda)", &units.force), &|(of, ..)| format!("{:.9e}", of.contact.force)),
            (&in_unit("peak pressure", &units.pressure()), &|(of, ..)| {
                of.contact.pressure_max.map_or("-".to_string(), |pressure| format!("{pressure:.6e}"))
            }),
            ("max |du|", &|(_, displacement, _)| displacement.clone()),
            ("max |dlambda|", &|(.., multiplier)| multiplier.clone()),
            ("seconds", &|(of, ..)| format!("{:.4}", of.seconds.factor + of.seconds.solve)),
        ],
    );
    let mut text =
        format!("{}\n{} dofs, {}{}\n\n", printable(title), qp.model.dofs, qp.model.rows_in_words(), of_part(qp));
    text += &columns(&methods);
    if qp.parts_of_whole.is_some() {
        text += "-sum(lambda) and peak pressure are of the whole body, all other columns of the meshed part.\n";
    }
    text += "\n";
    let mut table = vec![
        ["certificate", "stationarity", "penetration", "adhesion", "complementarity", "duality gap", "energy error <="]
            .map(String::from)
            .to_vec(),
    ];
    for summary in summaries {
        let mut row = vec![summary.solution.method.clone()];
        row.extend(conditions(&summary.solution.certificate).into_iter().map(|(_, _, value)| value));
        table.push(row);
    }
    text += &columns(&table);
    text += &format!("\n{}\n", verdict(summaries, agreement));
    text + &warnings_text(&qp.warnings)
}

fn verdict(summaries: &[Summary; 3], agreement: &Agreement) -> String {
    let [qp, active_set, penalty] = summaries;
    let exact = match (agreement.exact_methods, qp.is_certified() && active_set.is_certified()) {
        (true, _) => format!("The QP and the active set agree, both certified to {:.1e}", qp.goal.tolerance),
        (false, true) => "The QP and the active set DISAGREE, though both are certified".to_string(),
        (false, false) => format!("The QP and the active set are NOT both certified to {:.1e}", qp.goal.tolerance),
    };
    let certified = if penalty.is_certified() { "certified" } else { "not certified" };
    let distance = match (agreement.penalty_within_its_bound, penalty.solution.certificate.energy_error_bound) {
        (true, bound) if bound.is_finite() => {
            format!("{:.1e} from the QP in energy, within its stated {bound:.1e}", agreement.penalty.energy)
        }
        (true, _) => "which states no bound, because K is not positive definite".to_string(),
        (false, bound) => {
            format!("{:.1e} from the QP in energy, BEYOND its stated {bound:.1e}", agreement.penalty.energy)
        }
    };
    format!("{exact}; the penalty answer is {certified}, {distance}.")
}

/// A column of a table: its heading, and its cell for an item.
pub(crate) type Column<'a, T> = (&'a str, &'a dyn Fn(&T) -> String);

/// A table of items, the headings first and then a row for each.
pub(crate) fn table<'a, T: 'a>(items: impl IntoIterator<Item = &'a T>, columns: &[Column<T>]) -> Vec<Vec<String>> {
    let headings = columns.iter().map(|(heading, _)| heading.to_string()).collect();
    let row = |item| columns.iter().map(|(_, cell)| cell(item)).collect();
    std::iter::once(headings).chain(items.into_iter().map(row)).collect()
}

pub(crate) fn comma_separated(table: &[Vec<String>]) -> String {
    table.iter().map(|row| row.join(",") + "\n").collect()
}

/// A table with the first column on the left and the others on the right.
pub(crate) fn columns(table: &[Vec<String>]) -> String {
    let count = table.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| table.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max();
    let widths: Vec<usize> = (0..count).map(|column| width(column).unwrap_or(0)).collect();
    let mut text = String::new();
    for row in table {
        let cells: Vec<String> = row
            .iter()
            .zip(&widths)
            .enumerate()
            .map(
                |(column, (cell, &width))| {
                    if column == 0 { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
                },
            )
            .collect();
        text += cells.join("  ").trim_end();
        text += "\n";
    }
    text
}
