//! A line between two points, as an option.

#[derive(Clone, Debug)]
pub(super) struct Line {
    pub text: String,
    /// Both ends of the line, a number for each coordinate, in length.
    pub ends: [Vec<f64>; 2],
}

const FORM: &str = "it must be X1,Y1:X2,Y2, such as 0,1:2,1, with a number for each coordinate of the scene";

/// A line from the text of its two ends.
pub(super) fn parse_line(text: &str) -> Result<Line, String> {
    let Some((from, to)) = text.split_once(':') else { return Err(FORM.into()) };
    let number = |part: &str| match part.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("`{part}` is not a finite number; {FORM}")),
    };
    let end = |end: &str| end.split(',').map(number).collect::<Result<Vec<f64>, String>>();
    let ends = [end(from)?, end(to)?];
    let [first, second] = [ends[0].len(), ends[1].len()];
    match (first == second, ends[0] == ends[1]) {
        (false, _) => Err(format!("one end has {first} coordinates and the other {second}; {FORM}")),
        (_, true) => Err(format!("both ends are the same point; {FORM}")),
        _ => Ok(Line { text: text.into(), ends }),
    }
}
