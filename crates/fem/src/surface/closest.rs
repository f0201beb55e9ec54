//! The closest point of a surface, the normal there, and the signed distance.

use super::facets::TrianglePart;
use super::tree::ClosedSurface;
use crate::geometry::{distance, dot, length, minus, plus, shifted, unit};

/// With this many closest points a node has them all around, like the centre of a ball: any one of these points can be
/// used.
const MOST_FEET: usize = 64;

/// Normals cancel if their mean is shorter than this: the remainder gives no direction.
const CANCELLED: f64 = 1e-6;

/// The position of a point relative to a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignedDistance {
    /// Unit normal out of the solid at the closest point.
    pub outward: [f64; 3],
    /// Signed distance along `outward` from the surface to the point, in length; negative inside.
    pub height: f64,
}

/// A closest point, on one triangle.
#[derive(Clone, Copy, Debug)]
struct TriangleFoot {
    at: [f64; 3],
    distance: f64,
    part: TrianglePart,
    triangle: u32,
}

impl ClosedSurface {
    /// The position of `point` (`[x, y, z]`, in length) relative to the surface. Lengths below `tolerance` are
    /// rounding.
    ///
    /// The normal is that of the triangle, or the direction to an edge or a corner; for a point on the surface it is
    /// the mean over the triangles that meet there, weighted by their angles. If several points of the surface are
    /// equally close, it is their mean normal, and the height is measured from the planes through them. If these
    /// normals cancel or there are too many, it is the normal most against `towards`, the direction into the solid.
    ///
    /// The sign follows from the crossings of a line, which is correct also for solids that intersect.
    ///
    /// # Source
    /// J. A. Baerentzen, H. Aanaes, *Signed distance computation using the angle weighted pseudonormal*, IEEE Trans.
    /// Vis. Comput. Graph. 11 (2005) 243-253.
    pub fn closest(&self, point: [f64; 3], tolerance: f64, towards: [f64; 3]) -> SignedDistance {
        let feet = self.feet(point, tolerance);
        let against = |outward: [f64; 3]| -dot(outward, towards);
        let nearest = feet.iter().fold(f64::INFINITY, |nearest: f64, foot| nearest.min(foot.distance));
        if nearest <= tolerance {
            // At an edge or a corner several triangles have a foot; for one triangle it may still lie inside by
            // rounding.
            let sharpest = feet.iter().max_by_key(|foot| foot.part.rank());
            let outward = sharpest.map_or([0.0; 3], |foot| self.pseudonormal(foot));
            let outward = if outward == [0.0; 3] { towards.map(|part| -part) } else { outward };
            let at = sharpest.map_or(point, |foot| foot.at);
            return SignedDistance { outward, height: dot(outward, minus(point, at)) };
        }
        let sign = if self.contains(point) { -1.0 } else { 1.0 };
        let apart = Self::apart(&feet, point, tolerance);
        let seen = |foot: &TriangleFoot| self.seen(foot, point, sign);
        let sum = apart.iter().map(seen).fold([0.0; 3], |sum, one| plus(sum, one.outward));
        let cancels = length(sum) < CANCELLED * apart.len() as f64;
        let candidates = if apart.len() < MOST_FEET { &apart } else { &feet };
        let most = candidates
            .iter()
            .map(seen)
            .reduce(|most, other| if against(other.outward) > against(most.outward) { other } else { most });
        let alone = most.unwrap_or(SignedDistance { outward: towards.map(|part| -part), height: nearest });
        if apart.len() == 1 || apart.len() == MOST_FEET || cancels {
            return alone;
        }
        let outward = unit(sum);
        // Along its own normal the foot is at its distance; along a mean normal the plane through the foot is farther
        // away.
        SignedDistance { outward, height: alone.height / dot(alone.outward, outward) }
    }

    /// The closest points on all triangles that have one, within `tolerance` of the closest.
    ///
    /// Insides of triangles come first, then sides, then corners.
    fn feet(&self, point: [f64; 3], tolerance: f64) -> Vec<TriangleFoot> {
        let (mut nearest, mut feet) = (f64::INFINITY, Vec::<TriangleFoot>::new());
        self.tree.near(point, |triangle| {
            let (at, part) = self.triangle(triangle).closest(point);
            let distance = distance(at, point);
            if distance <= nearest + tolerance {
                feet.push(TriangleFoot { at, distance, part, triangle });
                nearest = nearest.min(distance);
            }
            (nearest + tolerance) * (nearest + tolerance)
        });
        feet.retain(|foot| foot.distance <= nearest + tolerance);
        feet.sort_by_key(|foot| (foot.part.rank(), foot.triangle));
        feet
    }

    /// The first feet that lie apart. On one smooth piece, feet that are equally close up to `tolerance` lie within the
    /// square root of twice the tolerance times the distance.
    fn apart(feet: &[TriangleFoot], point: [f64; 3], tolerance: f64) -> Vec<TriangleFoot> {
        let mut apart: Vec<TriangleFoot> = Vec::new();
        for &foot in feet {
            let beside = 3.0 * (tolerance * distance(foot.at, point)).sqrt();
            if apart.iter().all(|other| distance(other.at, foot.at) > beside) {
                apart.push(foot);
            }
            if apart.len() == MOST_FEET {
                break;
            }
        }
        apart
    }

    /// The relative position of a point off the surface, by one foot.
    fn seen(&self, foot: &TriangleFoot, point: [f64; 3], sign: f64) -> SignedDistance {
        let way = minus(point, foot.at).map(|part| sign * part / foot.distance);
        let triangle = self.triangle(foot.triangle);
        let normal = triangle.normal();
        // Inside several solids the closest triangle may face inwards.
        if foot.part == TrianglePart::Face && dot(normal, way) > 0.0 {
            return SignedDistance { outward: normal, height: dot(normal, minus(point, triangle.0[0])) };
        }
        SignedDistance { outward: way, height: sign * foot.distance }
    }

    /// The normal at a foot: unit normals of the triangles that meet there, weighted by their angles. Zero if they
    /// cancel.
    fn pseudonormal(&self, foot: &TriangleFoot) -> [f64; 3] {
        let corners = self.corners_of(foot.triangle);
        let weighted = |sum: [f64; 3], triangle: u32, weight: f64| {
            let normal = self.triangle(triangle).normal();
            shifted(sum, weight, normal)
        };
        match foot.part {
            TrianglePart::Face => self.triangle(foot.triangle).normal(),
            TrianglePart::Side(corner) => {
                let ends = [corners[corner], corners[(corner + 1) % 3]];
                let along = self.around(ends[0]).iter().filter(|&&other| self.corners_of(other).contains(&ends[1]));
                unit(along.fold([0.0; 3], |sum, &triangle| weighted(sum, triangle, 1.0)))
            }
            TrianglePart::Corner(corner) => {
                let vertex = corners[corner];
                unit(self.around(vertex).iter().fold([0.0; 3], |sum, &triangle| {
                    let own = self.corners_of(triangle).iter().position(|&corner| corner == vertex).unwrap_or(0);
                    weighted(sum, triangle, self.triangle(triangle).angle(own))
                }))
            }
        }
    }
}

impl TrianglePart {
    /// Insides first, then sides, then corners.
    fn rank(self) -> u8 {
        match self {
            TrianglePart::Face => 0,
            TrianglePart::Side(_) => 1,
            TrianglePart::Corner(_) => 2,
        }
    }
}
