//! Derivatives of smooth vectors by central differences of fourth order, with steps that shrink until they agree;
//! corners are found, not smoothed over.

/// The first step, in the scale of the variable; each further one is a tenth of it.
const FIRST_STEP: f64 = 1e-3;

const STEPS: usize = 6;

/// Differences of two steps agree if they are closer than this, relative to the largest of the vector. Where the vector
/// is smooth, the error of the fourth order is about the square; where only its slope is continuous, this is the error.
const AGREEMENT: f64 = 1e-7;

/// Rounding of an entry, relative to the largest.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// The derivative of a vector at zero, with one entry for each of its entries; `None` at a corner, or where it is
/// nowhere smooth. `scale` is the size of a change of the variable that changes the vector noticeably.
pub(super) fn derivative<E>(at: impl Fn(f64) -> Result<Vec<f64>, E>, scale: f64) -> Result<Option<Vec<f64>>, E> {
    let middle = at(0.0)?;
    let mut step = FIRST_STEP * scale;
    let mut last_error = None;
    for _ in 0..STEPS {
        let places = [-2.0 * step, -step, step, 2.0 * step].map(&at);
        step /= 10.0;
        let [before, near_before, near, after] = match places.into_iter().collect::<Result<Vec<_>, E>>() {
            Ok(values) => <[Vec<f64>; 4]>::try_from(values).unwrap_or_default(),
            // The vector ends within the step.
            Err(error) => {
                last_error = Some(error);
                continue;
            }
        };
        let own = 10.0 * step;
        let mut found = Vec::with_capacity(middle.len());
        let (mut size, mut off) = (0.0_f64, 0.0_f64);
        let largest = |values: &[f64]| values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        let rounding = ROUNDING * largest(&middle).max(largest(&before)).max(largest(&after)) / own;
        for (entry, &middle) in middle.iter().enumerate() {
            let narrow = (near[entry] - near_before[entry]) / (2.0 * own);
            let wide = (after[entry] - before[entry]) / (4.0 * own);
            // The jump of the slope halves with the step where the vector is smooth.
            let jump = (near[entry] - 2.0 * middle + near_before[entry]) / own;
            let wide_jump = (after[entry] - 2.0 * middle + before[entry]) / (2.0 * own);
            let apart = (narrow - wide).abs().max((jump - 0.5 * wide_jump).abs());
            off = off.max(apart - rounding);
            size = size.max(narrow.abs()).max(wide.abs());
            found.push((4.0 * narrow - wide) / 3.0);
        }
        if off <= AGREEMENT * size {
            return Ok(Some(found));
        }
    }
    last_error.map_or(Ok(None), Err)
}

#[cfg(test)]
mod tests {
    use super::derivative;

    fn of(at: impl Fn(f64) -> f64) -> Option<f64> {
        derivative(|x| Ok::<_, String>(vec![at(x), 1.0]), 1.0).unwrap().map(|found| found[0])
    }

    #[test]
    fn smooth_functions_have_their_derivative_and_corners_have_none() {
        assert!((of(|x| (3.0 * (x + 0.1)).sin()).unwrap() - 3.0 * 0.3_f64.cos()).abs() < 1e-10);
        assert!((of(|x| 2.0 - 5.0 * x).unwrap() + 5.0).abs() < 1e-11);
        assert_eq!(of(|_| 7.0), Some(0.0));
        assert_eq!(of(f64::abs), None);
        assert_eq!(of(|x| x.max(-x / 2.0)), None);
        // A corner beside zero is avoided by smaller steps.
        assert!((of(|x| (x - 1.5e-4).max(0.0) + 2.0 * x).unwrap() - 2.0).abs() < 1e-9);
    }

    #[test]
    fn a_function_that_ends_within_every_step_gives_its_reason() {
        let ends = |x: f64| if x > 0.0 { Err("ends") } else { Ok(vec![x]) };
        assert_eq!(derivative(ends, 1.0), Err("ends"));
    }
}
