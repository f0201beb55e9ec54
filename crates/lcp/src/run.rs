//! The way of a problem to its answer: the class of M decides the methods, each point is settled and examined.

use std::time::Instant;

use signorini_qp::{Error as QpError, Method, Settings, memory};

use crate::answer::{Class, LcpSolution, Place, worst};
use crate::basis::settled;
use crate::certificate::{examined, onto, placed};
use crate::class::Known;
use crate::error::Error;
use crate::found::Found;
use crate::lemke::lemke;
use crate::pivoting::principal_pivoting;
use crate::problem::Lcp;
use crate::quadratic::{contradiction, gap_program, infeasible, proximal, quadratic_program};

/// The methods.
#[derive(Clone, Copy)]
enum Way {
    QuadraticProgram,
    Proximal,
    GapProgram,
    PrincipalPivoting,
    /// With the artificial column of this number.
    Lemke(usize),
}

impl Way {
    /// The methods of a class, in order: the only place that decides them. A method of the settings leaves programs
    /// alone or pivoting alone, of which the active set on a quadratic program is one.
    fn of(known: &Known, method: Method) -> &'static [Way] {
        use Way::{GapProgram, Lemke, PrincipalPivoting, Proximal, QuadraticProgram};
        match (known.class, method) {
            (Class::Symmetric, Method::Qp(_) | Method::Penalty(_)) => return &[QuadraticProgram, Proximal],
            (Class::Symmetric, Method::ActiveSet) => return &[QuadraticProgram, PrincipalPivoting, Lemke(0), Lemke(1)],
            (class, Method::Qp(_) | Method::Penalty(_)) => {
                let is_monotone = class == Class::Monotone || known.least.is_some();
                return if is_monotone { &[GapProgram] } else { &[] };
            }
            (Class::Monotone, Method::ActiveSet) => return &[Lemke(0), Lemke(1), Lemke(2)],
            _ => {}
        }
        match known.class {
            // A stack with more contacts than it needs: if all close, one factor is enough.
            Class::Symmetric if known.least.is_none() => {
                &[PrincipalPivoting, QuadraticProgram, Proximal, Lemke(0), Lemke(1)]
            }
            Class::Symmetric => &[QuadraticProgram, Proximal, Lemke(0), Lemke(1)],
            Class::H | Class::P => &[PrincipalPivoting, Lemke(0), Lemke(1)],
            Class::Monotone => &[GapProgram, Lemke(0), Lemke(1), Lemke(2)],
            Class::General => &[Lemke(0), Lemke(1), Lemke(2)],
        }
    }

    fn name(self) -> &'static str {
        match self {
            Way::QuadraticProgram => "quadratic-program",
            Way::Proximal => "proximal",
            Way::GapProgram => "gap-program",
            Way::PrincipalPivoting => "principal-pivoting",
            Way::Lemke(_) => "lemke",
        }
    }

    fn found(self, lcp: &Lcp, known: &Known, allowed: f64, settings: &Settings) -> Result<Found, Error> {
        let scaled = &known.scaled;
        match self {
            Way::QuadraticProgram => quadratic_program(scaled, settings),
            Way::Proximal => proximal(scaled, settings),
            Way::GapProgram => gap_program(scaled, settings),
            Way::PrincipalPivoting => principal_pivoting(lcp, known, first_places(lcp, known), allowed, settings),
            Way::Lemke(_) if known.class != Class::General && lcp.unknowns() > DENSE => {
                Ok(Found::Nothing(format!("Lemke's method is not tried on more than {DENSE} unknowns of this class")))
            }
            Way::Lemke(attempt) => lemke(scaled, attempt, allowed, settings),
        }
    }
}

fn first_places(lcp: &Lcp, known: &Known) -> Vec<Place> {
    let place = |i: usize| match (lcp.lower()[i].is_finite(), lcp.upper()[i].is_finite()) {
        _ if known.class == Class::Symmetric => Place::Between,
        (true, _) => Place::Lower,
        (false, true) => Place::Upper,
        (false, false) => Place::Between,
    };
    (0..lcp.unknowns()).map(place).collect()
}

/// Residuals below this are rounding: no factorisation would improve the point.
const ROUNDING: f64 = 1e-15;

/// A point with a larger residual, even if it meets the tolerance, waits for the other methods and for a ray: far away
/// along a ray, where terms are large, all conditions hold relative to them.
const SHARP: f64 = 1e-13;

/// Most unknowns for a dense tableau where it is not the only method, and for the search for a ray.
const DENSE: usize = 1000;

/// Unknowns below this share of the largest, in scaled units, may be zero.
const DUST: f64 = 1e-14;

/// The point with the same places, settled; with other places, if M is a P-matrix and signs were wrong.
fn polished(
    lcp: &Lcp,
    known: &Known,
    places: Vec<Place>,
    allowed: f64,
    settings: &Settings,
) -> Result<Option<Vec<f64>>, Error> {
    match known.is_unique {
        Some(true) => match principal_pivoting(lcp, known, places, allowed, settings)? {
            Found::Point { z, .. } => Ok(Some(z)),
            _ => Ok(None),
        },
        _ => settled(lcp, known, &places, allowed),
    }
}

/// The point with zeros for what rounding has left in place of them.
fn without_dust(known: &Known, z: &[f64]) -> Vec<f64> {
    let size = |(z, unit): (&f64, &f64)| (z / unit).abs();
    let largest = z.iter().zip(&known.scaled.column).map(size).fold(0.0, f64::max);
    z.iter().zip(&known.scaled.column).map(|entry| if size(entry) <= DUST * largest { 0.0 } else { *entry.0 }).collect()
}

/// The point with the smallest residual so far, and the method that found it.
struct Best {
    z: Vec<f64>,
    residual: f64,
    method: &'static str,
    iterations: usize,
}

impl Best {
    fn certified(self, lcp: &Lcp, known: &Known, start: Instant) -> LcpSolution {
        let Best { z, method, iterations, .. } = self;
        let solution = examined(lcp, known, z);
        LcpSolution { method, iterations, seconds: start.elapsed().as_secs_f64(), ..solution }
    }
}

/// See [`solve_lcp`](crate::solve_lcp).
pub fn solved(lcp: &Lcp, settings: &Settings) -> Result<LcpSolution, Error> {
    let start = Instant::now();
    let settings = &settings.started().map_err(Error::Qp)?;
    let tolerance = settings.goal().tolerance;
    let allowed = memory::allowed(settings.memory);
    let known = Known::of(lcp)?;
    let (mut best, mut reasons): (Option<Best>, Vec<String>) = (None, Vec::new());
    for way in Way::of(&known, settings.method) {
        let (z, places, iterations) = match way.found(lcp, &known, allowed, settings)? {
            Found::Point { z, places, iterations } => (z, places, iterations),
            Found::Ray(ray) => match infeasible(lcp, &known.scaled, &ray) {
                Some(error) => return Err(error),
                None => {
                    reasons.push(format!("{} ended in a ray that shows nothing", way.name()));
                    continue;
                }
            },
            Found::Nothing(reason) => {
                reasons.push(reason);
                continue;
            }
        };
        let rough = placed(lcp, &z);
        let is_rough = rough.residual.iter().any(|&residual| residual.is_nan() || residual > ROUNDING);
        let mut points = vec![onto(lcp, &rough.places, &z)];
        if is_rough {
            points.extend(polished(lcp, &known, rough.places, allowed, settings)?);
            points.extend(places.and_then(|places| settled(lcp, &known, &places, allowed).ok()?));
            points.reverse();
        }
        let dusted: Vec<_> = points.iter().map(|z| without_dust(&known, z)).collect();
        for z in points.into_iter().chain(dusted) {
            let residual = worst(&placed(lcp, &z).residual).1;
            if best.as_ref().is_none_or(|best| residual < best.residual) {
                best = Some(Best { z, residual, method: way.name(), iterations });
            }
            if residual <= tolerance.min(SHARP) {
                break;
            }
        }
        if let Some(best) = best.take_if(|best| best.residual <= tolerance.min(SHARP)) {
            return Ok(best.certified(lcp, &known, start));
        }
    }
    if lcp.unknowns() <= DENSE
        && let Some(error) = contradiction(lcp, &known.scaled, allowed, settings)?
    {
        return Err(error);
    }
    // Attempts of one method end alike.
    reasons.dedup();
    Err(match best.map(|best| best.certified(lcp, &known, start)) {
        Some(solution) if solution.worst().1 <= tolerance => return Ok(solution),
        Some(solution) => {
            let (index, residual) = solution.worst();
            Error::NotCertified { solution: Box::new(solution), index, residual, tolerance }
        }
        None if settings.watch.acknowledge() => QpError::Interrupted.into(),
        None if reasons.is_empty() => Error::NotFound { reason: "M is not monotone, and has no convex program".into() },
        None => Error::NotFound { reason: reasons.join("; ") },
    })
}
