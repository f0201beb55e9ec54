//! Finds faults that a reader of a picture would see, in the SVG itself.

use crate::Drawing;
use resvg::usvg::{Group, Node, Options, Rect, Tree};

fn texts(group: &Group, found: &mut Vec<(String, Rect)>) {
    for node in group.children() {
        match node {
            Node::Group(inner) => texts(inner, found),
            Node::Text(text) => {
                let words: String = text.chunks().iter().map(|chunk| chunk.text()).collect();
                found.push((words, text.abs_bounding_box()));
            }
            _ => {}
        }
    }
}

/// The SVG of a drawing, read with the fonts of the drawing.
pub fn tree_of(drawing: &Drawing) -> Tree {
    let mut options = Options::default();
    options.fontdb_mut().load_font_data(include_bytes!("../draw/font/signorini-sans.ttf").to_vec());
    options.fontdb_mut().load_font_data(include_bytes!("../draw/font/signorini-sans-bold.ttf").to_vec());
    Tree::from_str(&drawing.svg(), &options).expect("well-formed SVG")
}

/// Every text with its box in pixels; panics if the SVG is not well formed or contains a number that is not finite.
pub fn texts_of(drawing: &Drawing) -> Vec<(String, Rect)> {
    let svg = drawing.svg();
    for attribute in svg.split(" d=\"").skip(1) {
        let path = attribute.split('"').next().unwrap_or_default();
        assert!(!path.contains("NaN") && !path.contains("inf"), "{path}");
    }
    let tree = tree_of(drawing);
    let mut found = Vec::new();
    texts(tree.root(), &mut found);
    found
}

/// Asserts that the page cuts off no text and that no text covers another.
pub fn assert_readable(drawing: &Drawing) {
    let texts = texts_of(drawing);
    let (width, height) = (drawing.width() as f32, drawing.height() as f32);
    for (k, (text, place)) in texts.iter().enumerate() {
        let on_page = place.left() >= 0.0 && place.top() >= 0.0 && place.right() <= width && place.bottom() <= height;
        assert!(on_page, "`{text}` at {place:?} is not inside the page of {width} x {height}");
        for (other, there) in &texts[k + 1..] {
            // Boxes have the height of a line, letters less: boxes of lines that touch may overlap a little.
            let across = place.right().min(there.right()) - place.left().max(there.left());
            let down = place.bottom().min(there.bottom()) - place.top().max(there.top());
            assert!(across <= 0.0 || down <= 4.0, "`{text}` covers `{other}`: {place:?} and {there:?}");
        }
    }
}
