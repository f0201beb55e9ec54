//! The way of a problem to its answer: the class of M decides the methods, each point is settled and examined.

use std::time::Instant;

use signorini_qp::{Error as QpError, Method, Settings, memory};

use crate::answer::{Class, Found, LcpSolution, Place, worst};
use crate::basis::settled;
use crate::certificate::{Placed, examined, onto, placed};
use crate::class::Known;
use crate::error::Error;
use crate::lemke::lemke;
use crate::pivoting::principal_pivoting;
use crate::problem::Lcp;
use crate::quadratic::{contradiction, gap_program, infeasible, quadratic_program};

/// The methods.
#[derive(Clone, Copy)]
enum Way {
    QuadraticProgram,
    GapProgram,
    PrincipalPivoting,
    /// With the artificial column of this number.
    Lemke(usize),
}

/// Most attempts of Lemke's method. On large problems they are fewer: their number times the third power of the
/// unknowns is at most `EFFORT`. Three are always made.
const ATTEMPTS: usize = 64;
const EFFORT: usize = 10_000_000;

impl Way {
    /// The methods of a class, in order: the only place that decides them. A method of the settings leaves programs
    /// alone or pivoting alone, of which the active set on a quadratic program is one.
    fn of(known: &Known, method: Method) -> Vec<Way> {
        use Way::{GapProgram, Lemke, PrincipalPivoting, QuadraticProgram};
        let (is_singular, is_program) = (known.least.is_none(), known.scaled.multipliers.is_some());
        let (by_program, by_pivoting) = match method {
            Method::Qp(_) | Method::Penalty(_) => (true, false),
            Method::ActiveSet => (known.class.is_alike(), true),
            _ => (true, true),
        };
        // A stack with more contacts than it needs: if all close, one factor is enough. Else the QP would wander.
        let is_alike = known.class.is_alike();
        // On other monotone matrices its steps may be thousands.
        let is_principal = if is_alike { is_singular } else { [Class::H, Class::P].contains(&known.class) };
        let ways = [
            (PrincipalPivoting, by_pivoting && is_principal),
            (Lemke(0), by_pivoting && is_alike && is_singular),
            (QuadraticProgram, by_program && known.factor.is_some() && is_program),
            (GapProgram, by_program && known.factor.is_some() && !is_program),
        ];
        let n = known.scaled.offset.len();
        let attempts = if by_pivoting { (EFFORT / n.saturating_pow(3).max(1)).clamp(3, ATTEMPTS) } else { 0 };
        let ways = ways.into_iter().filter_map(|(way, is_tried)| is_tried.then_some(way));
        ways.chain((usize::from(is_alike && is_singular)..attempts).map(Lemke)).collect()
    }

    fn name(self) -> &'static str {
        match self {
            Way::QuadraticProgram => "quadratic-program",
            Way::GapProgram => "gap-program",
            Way::PrincipalPivoting => "principal-pivoting",
            Way::Lemke(_) => "lemke",
        }
    }

    fn found(self, lcp: &Lcp, known: &Known, allowed: f64, settings: &Settings) -> Result<Found, Error> {
        let scaled = &known.scaled;
        match (self, &scaled.multipliers) {
            (Way::QuadraticProgram, Some(multipliers)) => quadratic_program(scaled, multipliers, 0.0, settings),
            (Way::QuadraticProgram, None) => Ok(Found::Nothing("the problem has no quadratic program".into())),
            (Way::GapProgram, _) => gap_program(scaled, settings),
            (Way::PrincipalPivoting, _) => principal_pivoting(lcp, known, first_places(lcp, known), allowed, settings),
            (Way::Lemke(_), _) if known.class != Class::General && lcp.unknowns() > TABLEAU => {
                Ok(Found::Nothing(format!("Lemke's method is not tried on more than {TABLEAU} unknowns of this class")))
            }
            (Way::Lemke(attempt), _) => lemke(scaled, attempt, allowed, settings),
        }
    }
}

fn first_places(lcp: &Lcp, known: &Known) -> Vec<Place> {
    let place = |i: usize| match (lcp.lower()[i].is_finite(), lcp.upper()[i].is_finite()) {
        _ if known.class.is_alike() => Place::Between,
        (true, _) => Place::Lower,
        (false, true) => Place::Upper,
        (false, false) => Place::Between,
    };
    (0..lcp.unknowns()).map(place).collect()
}

/// Residuals below this are rounding: no factorisation would improve the point.
const ROUNDING: f64 = 1e-15;

/// A point with a larger residual, even if it meets the tolerance, waits for the other methods and for a ray. So does
/// one that is larger than q and the bounds by `FAR`, in scaled units: far away along a ray, where terms are large, all
/// conditions hold relative to them.
const SHARP: f64 = 1e-13;
const FAR: f64 = 1e12;

/// The residual of a point, which is not sharp if the point is far away.
fn rank(known: &Known, point: &Placed) -> f64 {
    let Known { scaled, .. } = known;
    let bounds = scaled.lower.iter().chain(&scaled.upper).filter(|bound| bound.is_finite());
    let size = bounds.chain(&scaled.offset).fold(0.0, |size: f64, value| size.max(value.abs()));
    let is_far = point.z.iter().zip(&scaled.column).any(|(z, unit)| (z / unit).abs() > FAR * size);
    worst(&point.residual).1.max(if is_far { 2.0 * SHARP } else { 0.0 })
}

/// Most unknowns for a dense tableau where it is not the only method, and for the search for a ray.
const TABLEAU: usize = 2000;
const DENSE: usize = 1000;

/// The points near one that a method has found: settled with its places, and moved onto them.
fn near(lcp: &Lcp, known: &Known, z: Vec<f64>, allowed: f64, settings: &Settings) -> Result<Vec<Placed>, Error> {
    let rough = placed(lcp, z);
    let moved = onto(lcp, &rough.places, &rough.z);
    let settled = match worst(&rough.residual).1 <= ROUNDING {
        true if moved == rough.z => return Ok(vec![rough]),
        true => None,
        // Wrong signs are exchanged.
        false if known.is_unique == Some(true) => {
            match principal_pivoting(lcp, known, rough.places, allowed, settings)? {
                Found::Point { z, .. } => Some(z),
                _ => None,
            }
        }
        false => settled(lcp, known, &rough.places, allowed)?,
    };
    // Rounding may leave a point a little outside.
    let inside = |i: usize, z: f64| z.clamp(lcp.lower()[i], lcp.upper()[i]);
    let settled = settled.map(|z| z.into_iter().enumerate().map(|(i, z)| inside(i, z)).collect());
    Ok(settled.into_iter().chain([moved]).map(|z| placed(lcp, z)).collect())
}

/// See [`solve_lcp`](crate::solve_lcp).
pub fn solved(lcp: &Lcp, settings: &Settings) -> Result<LcpSolution, Error> {
    let start = Instant::now();
    let settings = &settings.started().map_err(Error::Qp)?;
    let tolerance = settings.goal().tolerance;
    let allowed = memory::allowed(settings.memory);
    let known = Known::of(lcp)?;
    if known.scaled.offset.iter().any(|q| !q.is_finite()) {
        let reason = "the answer leaves the range of doubles: q is too large beside the entries of M".into();
        return Err(Error::NotFound { reason });
    }
    let mut reasons: Vec<String> = Vec::new();
    let mut best: Option<(f64, Placed, &'static str, usize)> = None;
    for way in Way::of(&known, settings.method) {
        let (z, iterations) = match way.found(lcp, &known, allowed, settings)? {
            Found::Point { z, iterations } => (z, iterations),
            Found::Ray(ray) => match infeasible(lcp, &known.scaled, &ray) {
                Some(error) => return Err(error),
                None => {
                    let reason = "ended in a ray that proves nothing, at least not without rounding; with two finite \
                                  bounds on every unknown it would end in a point";
                    reasons.push(format!("{} {reason}", way.name()));
                    continue;
                }
            },
            Found::Nothing(reason) => {
                reasons.push(reason);
                continue;
            }
        };
        for point in near(lcp, &known, z, allowed, settings)? {
            let rank = rank(&known, &point);
            if best.as_ref().is_none_or(|best| rank < best.0) {
                best = Some((rank, point, way.name(), iterations));
            }
            if rank <= tolerance.min(SHARP) {
                break;
            }
        }
        if best.as_ref().is_some_and(|best| best.0 <= tolerance.min(SHARP)) {
            break;
        }
    }
    if best.as_ref().is_none_or(|best| best.0 > tolerance.min(SHARP))
        && lcp.unknowns() <= DENSE
        && let Some(error) = contradiction(lcp, &known.scaled, allowed, settings)?
    {
        return Err(error);
    }
    // Attempts of one method end alike.
    reasons.dedup();
    let Some((_, point, method, iterations)) = best else {
        return Err(match settings.watch.acknowledge() {
            true => QpError::Interrupted.into(),
            false if settings.watch.is_over() => {
                QpError::OutOfTime { needed: start.elapsed().as_secs_f64(), time: 0.0 }.into()
            }
            false if reasons.is_empty() => {
                Error::NotFound { reason: "M is not monotone, and has no convex program".into() }
            }
            false => Error::NotFound { reason: reasons.join("; ") },
        });
    };
    let ((index, residual), solution) = (worst(&point.residual), examined(lcp, &known, point));
    let solution = LcpSolution { method, iterations, seconds: start.elapsed().as_secs_f64(), ..solution };
    match residual <= tolerance {
        true => Ok(solution),
        false => Err(Error::NotCertified { solution: Box::new(solution), index, residual, tolerance }),
    }
}
