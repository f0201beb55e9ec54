//! The inverse of a small dense matrix.

/// A pivot of a diagonal block below this share of its entry is rounding: such a direction is not smoothed.
const SINGULAR_PIVOT: f64 = 1e-6;

/// The inverse of a symmetric block, row by row, by elimination; directions without a pivot are left out.
pub(super) fn invert(work: &mut [f64], size: usize, result: &mut [f64]) {
    result.fill(0.0);
    let diagonal: Vec<f64> = (0..size).map(|i| work[i * size + i]).collect();
    let mut kept = vec![true; size];
    for i in 0..size {
        result[i * size + i] = 1.0;
    }
    for k in 0..size {
        let pivot = work[k * size + k];
        if pivot.is_nan() || pivot <= SINGULAR_PIVOT * diagonal[k] || pivot <= 0.0 {
            kept[k] = false;
            continue;
        }
        for j in 0..size {
            work[k * size + j] /= pivot;
            result[k * size + j] /= pivot;
        }
        for i in (0..size).filter(|&i| i != k) {
            let factor = work[i * size + k];
            if factor != 0.0 {
                for j in 0..size {
                    work[i * size + j] -= factor * work[k * size + j];
                    result[i * size + j] -= factor * result[k * size + j];
                }
            }
        }
    }
    for i in 0..size {
        for j in 0..size {
            if !kept[i] || !kept[j] {
                result[i * size + j] = 0.0;
            }
        }
    }
}
