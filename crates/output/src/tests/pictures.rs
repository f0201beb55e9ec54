//! The picture of a contact answer: it agrees with its data, is readable, and tolerates hostile data.

use super::{
    Indented,
    page::{assert_readable, texts_of, tree_of},
};
use crate::Drawing;
use crate::picture::arrows::{Arrow, ArrowKind};
use crate::picture::body::{ContactPicture, FieldPanel, ObstacleLine, common_window};
use crate::view::limits::common_limits;
use resvg::tiny_skia::{Pixmap, Transform};
use signorini_mechanics::Error;
use signorini_qp as qp;

fn colour_at(drawing: &Drawing, x: u32, y: u32) -> [u8; 3] {
    let png = drawing.png(1.0).expect("rasterises");
    let pixels = Pixmap::decode_png(&png).expect("a PNG");
    let colour = pixels.pixel(x, y).expect("the pixel is on the page").demultiply();
    [colour.red(), colour.green(), colour.blue()]
}

/// Left, top, width and height in pixels of the left (1) or the right (2) panel, from the clip path of its content.
fn panel(drawing: &Drawing, which: usize) -> [f64; 4] {
    let svg = drawing.svg();
    let clip = svg.split(&format!("<clipPath id=\"clip{which}\"><rect ")).nth(1).expect("the panel has a clip path");
    ["x", "y", "width", "height"].map(|name| {
        let rest = clip.split(&format!("{name}=\"")).nth(1).expect(name);
        rest.split('"').next().and_then(|text| text.parse().ok()).expect(name)
    })
}

fn panel_centre(drawing: &Drawing) -> (u32, u32) {
    let [x, y, width, height] = panel(drawing, 1);
    ((x + width / 2.0) as u32, (y + height / 2.0) as u32)
}

#[test]
fn the_picture_of_an_indented_body_is_readable_and_labelled() {
    let body = Indented::new([1.0, 0.5], [40, 20]);
    let obstacle = body.obstacle();
    let drawing = body.picture("Gap −0.01 m, iteration 3, 15 closed nodes", &body.field(), &obstacle).draw().unwrap();
    assert_readable(&drawing);
    let texts: Vec<String> = texts_of(&drawing).into_iter().map(|(text, _)| text).collect();
    for expected in [
        "Gap −0.01 m, iteration 3, 15 closed nodes",
        "second principal stress σ₂ (MPa)",
        "closed nodes (15)",
        "open candidates (26)",
        "obstacle",
        "x (m)",
        "y (m)",
    ] {
        assert!(texts.iter().any(|text| text == expected), "`{expected}` is not among {texts:?}");
    }
    assert!((1200.0..=1600.0).contains(&drawing.width()), "{}", drawing.width());
}

/// SVG and PNG are made from the shapes by separate code; an independent renderer of the SVG must give the same
/// picture. Renderers smooth edges differently: a channel counts as different if it differs by more than a sixth of its
/// range, and 1 in 10,000 channels may.
#[test]
fn the_png_shows_the_same_picture_as_the_svg() {
    const DIFFERENT: u8 = 42;
    const FEW: usize = 1;
    let body = Indented::new([1.0, 0.5], [40, 20]);
    let obstacle = body.obstacle();
    let drawing = body.picture("Gap −0.01 m, iteration 3, 15 closed nodes", &body.field(), &obstacle).draw().unwrap();
    let ours = Pixmap::decode_png(&drawing.png(1.0).unwrap()).expect("a PNG");
    let mut theirs = Pixmap::new(ours.width(), ours.height()).unwrap();
    resvg::render(&tree_of(&drawing), Transform::default(), &mut theirs.as_mut());
    let differs = |pair: &(&u8, &u8)| pair.0.abs_diff(*pair.1) > DIFFERENT;
    let count = ours.data().iter().zip(theirs.data()).filter(differs).count();
    assert!(10_000 * count <= FEW * ours.data().len(), "{count} of {} channels differ", ours.data().len());
}

#[test]
fn png_has_the_size_of_the_drawing_times_its_scale() {
    let body = Indented::new([1.0, 0.5], [4, 2]);
    let drawing = body.picture("Two scales", &body.field(), &[]).draw().unwrap();
    for scale in [0.5, 1.0, 2.0] {
        let pixels = Pixmap::decode_png(&drawing.png(scale).unwrap()).expect("a PNG");
        let expected = [drawing.width(), drawing.height()].map(|side| (side * scale).round() as u32);
        assert_eq!([pixels.width(), pixels.height()], expected);
    }
    for scale in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e4, 1e-9] {
        assert!(matches!(drawing.png(scale), Err(Error::Linear(qp::LinearError::Setting { .. }))), "scale {scale}");
    }
}

#[test]
fn the_middle_value_has_the_middle_colour_and_the_limits_have_the_end_colours() {
    // The two ends and the middle of viridis, to the width of a colour band.
    for (value, expected) in [(-2.0, [0x44, 0x01, 0x54]), (0.0, [0x21, 0x91, 0x8c]), (2.0, [0xfd, 0xe7, 0x25])] {
        let mut body = Indented::new([1.0, 0.5], [3, 3]);
        body.stress.fill(value);
        let drawing = body.picture("One colour", &body.field_within([-1.0, 1.0]), &[]).draw().unwrap();
        let (x, y) = panel_centre(&drawing);
        let found = colour_at(&drawing, x, y);
        let distance = found.iter().zip(expected).map(|(a, b)| a.abs_diff(b)).max().unwrap();
        assert!(distance <= 12, "{value}: {found:?} is not {expected:?}");
    }
}

#[test]
fn pictures_stay_readable_at_extreme_shapes_and_magnitudes() {
    for size in [[1.0, 0.5], [10.0, 1.0], [1.0, 10.0], [1000.0, 1.0], [1.0, 1000.0]] {
        for (length, stress) in [(1.0, 1.0), (1e-12, 1e-12), (1e12, 1e12), (1e-3, 1e-30), (123.456, -1.0)] {
            let body = Indented::new(size, [8, 8]).scaled(length, stress);
            let obstacle = body.obstacle();
            let fields = body.field_within(common_limits([&body.stress[..]]));
            assert_readable(&body.picture("Extreme", &fields, &obstacle).draw().unwrap());
        }
    }
}

#[test]
fn long_titles_are_broken_and_markup_in_titles_is_escaped() {
    let body = Indented::new([1.0, 0.5], [4, 2]);
    let long = "a body <under> \"pressure\" & more ".repeat(20) + &"endless".repeat(60);
    for title in [long.as_str(), "", "\u{0}\u{8}control\n\tcharacters\u{fffe}", "漢字 😀 ü", "</text><script>"] {
        let drawing = body.picture(title, &body.field(), &[]).draw().unwrap();
        assert_readable(&drawing);
        drawing.png(1.0).unwrap();
    }
    let texts = texts_of(&body.picture("a < b & c > 'd' \"e\"", &body.field(), &[]).draw().unwrap());
    assert!(texts.iter().any(|(text, _)| text == "a < b & c > 'd' \"e\""), "{texts:?}");
}

#[test]
fn elements_with_values_that_are_not_finite_are_grey_with_a_legend() {
    let mut body = Indented::new([1.0, 0.5], [3, 3]);
    body.stress.fill(f64::NAN);
    let drawing = body.picture("No values", &body.field(), &[]).draw().unwrap();
    let (x, y) = panel_centre(&drawing);
    assert_eq!(colour_at(&drawing, x, y), [0xb9, 0xbd, 0xc4]);
    assert!(drawing.svg().contains("grey: no value"));

    let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e308, -1e308, 1e-320];
    for value in bad {
        let mut body = Indented::new([1.0, 0.5], [6, 3]);
        (body.nodes[1], body.displacement[20], body.stress[9], body.parabola[40]) =
            ([value; 2], value, value, [value; 2]);
        let obstacles = [ObstacleLine { points: &body.parabola, inside: [value, 1.0] }];
        let fields = body.field_within([value; 2]);
        let mut picture = body.picture("Hostile", &fields, &obstacles);
        (picture.magnification, picture.window) = (value, Some([[value, 1.0], [0.0, value]]));
        let drawing = picture.draw().unwrap();
        assert_readable(&drawing);
        drawing.png(0.5).unwrap();
    }
}

#[test]
fn a_body_without_nodes_elements_or_candidates_gives_an_empty_picture() {
    let mut body = Indented::new([1.0, 0.5], [2, 2]);
    body.elements = vec![vec![], vec![0], vec![0, 1], vec![0, 0, 0]];
    assert_readable(&body.picture("Degenerate elements", &body.field(), &[]).draw().unwrap());
    (body.candidates, body.closed) = (vec![], vec![]);
    let drawing = body.picture("No candidates", &body.field(), &[]).draw().unwrap();
    assert!(!drawing.svg().contains("closed nodes") && !drawing.svg().contains("open candidates"));
    let nothing = Indented { nodes: vec![], elements: vec![], displacement: vec![], stress: vec![], ..body };
    assert_readable(&nothing.picture("Nothing", &nothing.field(), &[]).draw().unwrap());
}

#[test]
fn arrays_of_wrong_length_are_refused_with_both_lengths() {
    let body = Indented::new([1.0, 0.5], [2, 2]);
    let fields = body.field();
    let good = body.picture("Refused", &fields, &[]);
    let short = ContactPicture { displacement: &body.displacement[1..], ..good.clone() };
    let sentence = short.draw().unwrap_err().to_string();
    assert!(sentence.contains("has length 17") && sentence.contains("18"), "{sentence}");
    let short_field = [FieldPanel { values: &body.stress[1..], ..fields[0].clone() }];
    let short = ContactPicture { fields: &short_field, ..good.clone() };
    assert!(matches!(short.draw(), Err(Error::Linear(qp::LinearError::Length { found: 8, expected: 9, .. }))));
    let short = ContactPicture { closed: &body.closed[1..], ..good.clone() };
    assert!(matches!(short.draw(), Err(Error::Linear(qp::LinearError::Length { found: 2, expected: 3, .. }))));
    let elements = [vec![0, 1, 9]];
    let wrong = ContactPicture { elements: &elements, ..good.clone() };
    assert!(matches!(wrong.draw(), Err(Error::Linear(qp::LinearError::Setting { value: 9.0, .. }))));
    let wrong = ContactPicture { candidates: &[0, 1, 100], ..good };
    assert!(matches!(wrong.draw(), Err(Error::Linear(qp::LinearError::Setting { value: 100.0, .. }))));
}

#[test]
fn an_obstacle_is_grey_on_its_inside_and_white_on_the_other_side() {
    let body = Indented::new([1.0, 0.5], [8, 4]);
    let grey = |colour: [u8; 3]| colour.iter().all(|&part| (0xb0..0xe0).contains(&part));
    // Lines at a distance of 0.04 from the body, each with the direction of its inside.
    let sides = [
        ([[-9.0, 0.54], [9.0, 0.54]], [0.0, 1.0], [0.5, 0.0]),
        ([[-9.0, -0.04], [9.0, -0.04]], [0.0, -3.0], [0.5, 1.0]),
        ([[1.04, -9.0], [1.04, 9.0]], [0.1, 0.0], [1.0, 0.5]),
        ([[-0.04, 9.0], [-0.04, -9.0]], [-1.0, 0.0], [0.0, 0.5]),
    ];
    for (points, inside, at) in sides {
        let drawing = body.picture("Side", &body.field(), &[ObstacleLine { points: &points, inside }]).draw().unwrap();
        let [x, y, width, height] = panel(&drawing, 2);
        let pixel = |share: [f64; 2]| {
            let place = |from: f64, length: f64, share: f64| (from + 6.0 + share * (length - 12.0)) as u32;
            colour_at(&drawing, place(x, width, share[0]), place(y, height, share[1]))
        };
        assert!(grey(pixel(at)), "{inside:?}: {:?}", pixel(at));
        let opposite = at.map(|share| 1.0 - share);
        assert_eq!(pixel(opposite), [255; 3], "{inside:?}");
    }
}

#[test]
fn tick_labels_of_a_body_far_from_the_origin_do_not_cover_each_other() {
    for offset in [1e4, 123_456.0, 1e9, -1e9] {
        let mut body = Indented::new([1.0, 0.5], [8, 4]);
        body.nodes.iter_mut().for_each(|node| *node = node.map(|coordinate| coordinate + offset));
        assert_readable(&body.picture("Far from the origin", &body.field(), &[]).draw().unwrap());
    }
}

#[test]
fn the_legend_names_an_obstacle_outside_the_picture() {
    let body = Indented::new([1.0, 0.5], [4, 2]);
    let plane = [[-1.0, 7.0], [2.0, 7.0]];
    let drawing =
        body.picture("Far", &body.field(), &[ObstacleLine { points: &plane, inside: [0.0, 1.0] }]).draw().unwrap();
    assert!(drawing.svg().contains("obstacle: outside the picture"));
    assert_readable(&drawing);
}

#[test]
fn pictures_with_a_common_window_have_the_same_size() {
    let bodies = [0.4, 1.0].map(|depth| {
        let mut body = Indented::new([1.0, 0.5], [8, 4]);
        body.displacement.iter_mut().for_each(|u| *u *= depth);
        body.parabola.iter_mut().for_each(|point| point[1] += 0.06 * (1.0 - depth));
        body
    });
    let window = common_window(bodies.iter().map(|body| body.picture("", &[], &body.obstacle()).window()));
    let sizes = bodies.each_ref().map(|body| {
        let obstacle = body.obstacle();
        let drawing = ContactPicture { window: Some(window), ..body.picture("Series", &[], &obstacle) }.draw().unwrap();
        [drawing.width(), drawing.height()]
    });
    assert_eq!(sizes[0], sizes[1]);
}

#[test]
fn a_picture_of_twenty_thousand_elements_has_less_than_two_megabytes() {
    let body = Indented::new([1.0, 0.5], [200, 100]);
    let svg = body.picture("Fine", &body.field(), &body.obstacle()).draw().unwrap().svg();
    assert!(svg.len() < 2_000_000, "{} bytes", svg.len());
}

/// A picture of three panels keeps the width of the page, and each field has one name.
#[test]
fn two_fields_are_drawn_side_by_side_with_a_colour_bar_each() {
    let body = Indented::new([1.0, 0.5], [40, 20]);
    let mises: Vec<f64> = body.stress.iter().map(|stress| 0.7 * stress.abs()).collect();
    let quantity = crate::Quantity::new("von Mises stress", "Pa");
    let [first] = body.field();
    let fields = [first, FieldPanel { values: &mises, quantity, limits: [f64::NAN; 2] }];
    let obstacle = body.obstacle();
    let drawing = body.picture("Two fields", &fields, &obstacle).draw().unwrap();
    assert_readable(&drawing);
    let texts: Vec<String> = texts_of(&drawing).into_iter().map(|(text, _)| text).collect();
    for expected in ["second principal stress σ₂ (MPa)", "von Mises stress (MPa)", "von Mises stress"] {
        assert!(texts.iter().any(|text| text == expected), "`{expected}` is not among {texts:?}");
    }
    assert!(drawing.width() <= 1600.0, "{}", drawing.width());
}

/// Rounding of 1e-12 on a uniform stress is painted in one colour, and the colour bar shows the stress without the
/// rounding.
#[test]
fn rounding_of_a_uniform_stress_is_painted_in_one_colour() {
    let picture_of = |stress: &dyn Fn(usize) -> f64| {
        let mut body = Indented::new([1.0, 0.5], [6, 6]);
        (0..body.stress.len()).for_each(|node| body.stress[node] = stress(node));
        body.picture("Uniform", &body.field_within([f64::NAN; 2]), &[]).draw().unwrap()
    };
    let noisy = |noise: f64| move |node: usize| -1e8 * (1.0 + noise * ((node * 7919 % 13) as f64 - 6.0));
    let drawing = picture_of(&noisy(1e-12));
    // All values are painted as the lowest.
    let uniform = picture_of(&|_| -1e8 * (1.0 + 6e-12));
    assert!(drawing.svg() == uniform.svg(), "the noise is visible");
    assert!(drawing.svg() != picture_of(&noisy(1e-6)).svg(), "a difference above rounding is not visible");
    let texts: Vec<String> = texts_of(&drawing).into_iter().map(|(text, _)| text).collect();
    assert!(texts.iter().any(|text| text == "−100"), "{texts:?}");
}

/// A contact of 2 % of the body is enlarged; one of 40 % is not.
#[test]
fn a_small_contact_is_enlarged_in_a_corner() {
    let mut body = Indented::new([1.0, 0.5], [400, 20]);
    let count = |drawing: &Drawing| drawing.svg().matches("<clipPath").count();
    let large = body.picture("Large", &[], &[]).draw().unwrap();
    for (k, closed) in body.closed.iter_mut().enumerate() {
        *closed = (196..=204).contains(&k);
    }
    let obstacle = body.obstacle();
    let small = body.picture("Small", &[], &obstacle).draw().unwrap();
    assert_readable(&small);
    assert_eq!(count(&large), 1);
    assert!(count(&small) > 1);
    let texts: Vec<String> = texts_of(&small).into_iter().map(|(text, _)| text).collect();
    assert!(texts.iter().any(|text| text.starts_with("× ") && text.ends_with(" wide")), "{texts:?}");
}

/// Each kind of force has an arrow and its largest value; a force that is rounding has neither.
#[test]
fn forces_have_arrows_and_values() {
    let body = Indented::new([1.0, 0.5], [8, 4]);
    let arrow = |kind, force: [f64; 2]| Arrow { kind, at: [0.5, 0.5], moved: [0.0; 2], force, unit: "N".into() };
    let arrows = [arrow(ArrowKind::Contact, [0.0, -70772.0]), arrow(ArrowKind::Load, [1e-9, 0.0])];
    let drawing = ContactPicture { arrows: &arrows, ..body.picture("Forces", &[], &[]) }.draw().unwrap();
    assert_readable(&drawing);
    let texts: Vec<String> = texts_of(&drawing).into_iter().map(|(text, _)| text).collect();
    assert!(texts.iter().any(|text| text == "contact force 70.77 kN"), "{texts:?}");
    assert!(!texts.iter().any(|text| text.starts_with("load")), "{texts:?}");
}
