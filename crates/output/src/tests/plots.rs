//! Line plots: legends that cover nothing, axes that match the data, hostile data.

use super::page::{assert_readable, texts_of};
use crate::{Plot, Quantity, Scale, Series, line_plots};

fn curve(name: &str, value: impl Fn(f64) -> f64) -> Series {
    Series::new(name, (0..=40).map(|k| f64::from(k) / 40.0).map(|x| [x, value(x)]).collect())
}

fn pressure(x: f64) -> f64 {
    1.6e6 * (1.0 - ((x - 0.5) / 0.2).powi(2)).max(0.0).sqrt()
}

fn plot(series: Vec<Series>) -> Plot {
    Plot::new(Quantity::new("position x", "m"), Quantity::new("contact pressure p", "Pa"), series)
}

#[test]
fn coinciding_lines_are_drawn_from_wide_to_thin() {
    let series = ["QP", "active set", "penalty"].map(|name| curve(name, pressure)).to_vec();
    let nested = Plot { nested: true, ..plot(series) };
    let drawing = line_plots("Pressure of three methods", &[nested]);
    assert_readable(&drawing);
    let svg = drawing.svg();
    let places = ["stroke-width=\"9\"", "stroke-width=\"4.2\"", "stroke-width=\"1.5\""].map(|width| svg.find(width));
    assert!(places.iter().all(Option::is_some) && places.is_sorted(), "{places:?}");
}

#[test]
fn a_plot_has_a_legend_only_if_it_has_several_lines() {
    let one = line_plots("One", &[plot(vec![curve("only", pressure)])]);
    assert!(!one.svg().contains("only"));
    let two = line_plots("Two", &[plot(vec![curve("first & last", pressure), Series::new("second", vec![])])]);
    let texts: Vec<String> = texts_of(&two).into_iter().map(|(text, _)| text).collect();
    assert!(texts.contains(&"first & last".to_owned()) && texts.contains(&"second (no data)".to_owned()), "{texts:?}");
}

#[test]
fn the_legend_is_below_the_axes_if_the_lines_leave_no_room() {
    let crowded: Vec<Series> =
        (1..5).map(|s| curve(&format!("wave {s}"), move |x| (150.0 * x * f64::from(s)).sin())).collect();
    let free = ["a", "b"].map(|name| curve(name, |x| x)).to_vec();
    let [crowded, free] = [crowded, free].map(|series| line_plots("Room", &[plot(series)]));
    assert_readable(&crowded);
    assert_readable(&free);
    assert!(crowded.height() > free.height());
    let axis = texts_of(&crowded)
        .into_iter()
        .find(|(text, _)| text == "position x (m)")
        .expect("the plot has an axis label")
        .1;
    let entry = texts_of(&crowded).into_iter().find(|(text, _)| text == "wave 1").expect("the plot has a legend").1;
    assert!(entry.top() >= axis.bottom() - 1.0);
}

#[test]
fn two_panels_share_one_title_and_do_not_overlap() {
    let gap = Quantity::new("gap", "m");
    let force: Vec<[f64; 2]> = (1..=10).map(|k| -0.01 * f64::from(k)).map(|g| [g, 1.3e7 * g.abs().powf(1.5)]).collect();
    let width: Vec<[f64; 2]> = force.iter().map(|[g, _]| [*g, g.abs().sqrt()]).collect();
    let plots = [
        Plot::new(gap.clone(), Quantity::new("contact force", "N/m"), vec![Series::new("force", force)]),
        Plot::new(gap, Quantity::new("contact width", "m"), vec![Series::new("width", width)]),
    ];
    assert_readable(&line_plots("Ten gaps", &plots));
}

#[test]
fn logarithmic_axes_show_decades_and_omit_values_that_are_not_positive() {
    let points = vec![[1e-3, 1e-2], [1e-2, 0.0], [1e-1, -1.0], [1.0, 1e-9], [10.0, f64::NAN]];
    let plot = Plot { scales: [Scale::Logarithmic; 2], ..plot(vec![Series::new("errors", points)]) };
    let drawing = line_plots("Work and precision", &[plot]);
    assert_readable(&drawing);
    let texts: Vec<String> = texts_of(&drawing).into_iter().map(|(text, _)| text).collect();
    assert!(["10⁻³", "10⁰", "10⁻⁹"].iter().all(|label| texts.iter().any(|text| text == label)), "{texts:?}");
}

#[test]
fn plots_without_data_are_labelled_and_hostile_data_are_tolerated() {
    let drawing = line_plots("", &[plot(vec![])]);
    assert!(drawing.svg().contains("no data"));
    assert_readable(&line_plots("No panel", &[]));
    let values = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e308, -1e308, 1e-320, 0.0, -0.0, 1e12, 1e-12];
    for &a in &values {
        for &b in &values {
            for scale in [Scale::Linear, Scale::Logarithmic] {
                let series = vec![Series::new("<a>", vec![[a, b], [b, a], [a, 1.0]]), Series::new("", vec![[b, b]])];
                let plot = Plot { scales: [scale; 2], title: "<&>".repeat(200), ..plot(series) };
                assert_readable(&line_plots("Hostile", &[plot]));
            }
        }
    }
    let many: Vec<Plot> =
        (0..4).map(|_| plot(vec![curve(&"long name ".repeat(30), pressure), curve("b", pressure)])).collect();
    let drawing = line_plots("Many panels", &many);
    assert_readable(&drawing);
    drawing.png(1.0).unwrap();
}

/// Marks without a line have no line in the legend, and an axis begins at zero on request.
#[test]
fn the_legend_of_marks_has_no_line_and_the_force_axis_begins_at_zero() {
    let marks: Vec<[f64; 2]> = (1..5).flat_map(|k| [[f64::from(k), 10.0 + f64::from(k)], [f64::NAN; 2]]).collect();
    let path = (1..5).map(|k| [f64::from(k), 10.0 + f64::from(k)]).collect();
    let series = vec![Series::new("exact path", path), Series::new("gaps of the sweep", marks)];
    let drawing = line_plots("Force", &[Plot { nested: true, y_from_zero: true, ..plot(series) }]);
    assert_readable(&drawing);
    // The second series would be dashed if it had a line, in the plot or in the legend.
    assert!(!drawing.svg().contains("stroke-dasharray"));
    assert!(texts_of(&drawing).iter().any(|(text, _)| text == "0"));
}
