//! Parts of boundaries: facets chosen by their position and their normal.

use crate::error::Error;
use crate::fem::assembly::facet_centres;
use crate::fem::geometry::{cross, distance, dot, length};
use crate::fem::{Boundary, ElasticBody};
use crate::scene::input::entry::{PLACE_TOLERANCE, boundary, direction, number, point, positive, vector, wrong};
use crate::scene::input::schema::body::PartBoxSpec;
use crate::scene::input::schema::{PartSpec, Scene};

/// Deviations of normals beyond the given angle by less than this, in degrees, are rounding of coordinates.
const SAME_ANGLE: f64 = 1e-6;

/// The body with the parts of its boundaries that the scene names, after the others.
pub(crate) fn with_parts(scene: &Scene, mut body: ElasticBody) -> Result<ElasticBody, Error> {
    for (index, spec) in scene.parts.iter().enumerate() {
        let path = format!("parts[{index}]");
        let mesh = body.mesh();
        if spec.name.is_empty() || mesh.boundary(&spec.name).is_some() {
            let message = format!("`{}` is not allowed: every part needs a name of its own", spec.name);
            return Err(wrong(format!("{path}.name"), message));
        }
        let whole = spec.whole(&body, &path)?;
        let part = spec.facets(&body, &whole, &path)?;
        body = body.with_boundary(part)?;
    }
    Ok(body)
}

impl PartSpec {
    /// The facets of `whole` that belong to the part.
    pub(crate) fn facets(&self, body: &ElasticBody, whole: &Boundary, path: &str) -> Result<Boundary, Error> {
        let (region, size) = (Region::of(self, path, body.dimension())?, body.mesh().size());
        let tolerance = PLACE_TOLERANCE * size;
        let outside: Vec<Outside> =
            facet_centres(body, whole).into_iter().map(|(at, normal)| region.outside(at, normal)).collect();
        let part = whole.part(&self.name, |facet| outside.get(facet).is_some_and(|one| one.is_in(tolerance)));
        if part.connectivity.is_empty() {
            return Err(wrong(path, nearest(&whole.name, &outside, size, body.dimension())));
        }
        Ok(part)
    }

    /// The boundary, or the whole surface, of which it is a part.
    fn whole(&self, body: &ElasticBody, path: &str) -> Result<Boundary, Error> {
        let mesh = body.mesh();
        let Some(name) = &self.of else {
            return Ok(mesh.surface(body.regions().first().map_or(0..0, |region| region.elements())));
        };
        match body.regions().iter().skip(1).find(|region| region.name() == name) {
            Some(region) if mesh.boundary(name).is_none() => Ok(mesh.surface(region.elements())),
            _ => Ok(boundary(mesh, name, &format!("{path}.of"))?.clone()),
        }
    }
}

impl PartBoxSpec {
    /// The smallest and the largest coordinates of the box at the JSON path `path`.
    pub(crate) fn corners(&self, path: &str, dimension: usize) -> Result<[[f64; 3]; 2], Error> {
        let low = vector(&format!("{path}.box.min"), &self.min, dimension)?;
        let high = vector(&format!("{path}.box.max"), &self.max, dimension)?;
        match (0..dimension).find(|&axis| high[axis] < low[axis]) {
            Some(axis) => {
                let message = format!("{} lies below {}; no max may lie below its min", high[axis], low[axis]);
                Err(wrong(format!("{path}.box.max[{axis}]"), message))
            }
            None => Ok([low, high]),
        }
    }
}

/// The region of the centroids and the directions of the normals of a part.
struct Region {
    /// The smallest and the largest coordinates of the box.
    cuboid: Option<[[f64; 3]; 2]>,
    /// Centre and radius.
    sphere: Option<([f64; 3], f64)>,
    /// A unit vector, and degrees around it.
    normal: Option<([f64; 3], f64)>,
}

/// The distance of a facet from a region.
struct Outside {
    /// The centre of the facet.
    at: [f64; 3],
    /// In length; 0 in the region.
    away: f64,
    /// In degrees; 0 within the angle.
    aside: f64,
}

impl Outside {
    fn is_in(&self, tolerance: f64) -> bool {
        self.away <= tolerance && self.aside <= SAME_ANGLE
    }
}

impl Region {
    fn of(spec: &PartSpec, path: &str, dimension: usize) -> Result<Self, Error> {
        let mut region = Region { cuboid: None, sphere: None, normal: None };
        if let Some(cuboid) = &spec.cuboid {
            region.cuboid = Some(cuboid.corners(path, dimension)?);
        }
        if let Some(sphere) = &spec.sphere {
            let centre = vector(&format!("{path}.sphere.centre"), &sphere.centre, dimension)?;
            region.sphere = Some((centre, positive(&format!("{path}.sphere.radius"), sphere.radius)?));
        }
        if let Some(normal) = &spec.normal {
            let direction = direction(&format!("{path}.normal.direction"), &normal.direction, dimension)?;
            if !(0.0..=180.0).contains(&normal.within) {
                let message = format!("{} is not allowed: it must be from 0 to 180 degrees", number(normal.within));
                return Err(wrong(format!("{path}.normal.within"), message));
            }
            region.normal = Some((direction, normal.within));
        }
        Ok(region)
    }

    fn outside(&self, at: [f64; 3], normal: [f64; 3]) -> Outside {
        let of_box = self.cuboid.map_or(0.0, |[low, high]| {
            length([0, 1, 2].map(|axis| (low[axis] - at[axis]).max(at[axis] - high[axis]).max(0.0)))
        });
        let of_sphere = self.sphere.map_or(0.0, |(centre, radius)| (distance(at, centre) - radius).max(0.0));
        let aside = self.normal.map_or(0.0, |(direction, within)| {
            let angle = length(cross(direction, normal)).atan2(dot(direction, normal)).to_degrees();
            (angle - within).max(0.0)
        });
        Outside { at, away: of_box.max(of_sphere), aside }
    }
}

/// A message that no facet lies in a part, and the nearest facet, in a body of this size.
fn nearest(whole: &str, outside: &[Outside], size: f64, dimension: usize) -> String {
    let far = |one: &&Outside| one.away / size + one.aside / 180.0;
    let Some(nearest) = outside.iter().min_by(|a, b| far(a).total_cmp(&far(b))) else {
        return format!("`{whole}` has no facets");
    };
    let away = (nearest.away > 0.0).then(|| format!("{:.3e} outside", nearest.away));
    let aside = (nearest.aside > 0.0).then(|| format!("{:.1} degrees beyond the angle", nearest.aside));
    let out: Vec<String> = away.into_iter().chain(aside).collect();
    let centre = point(&nearest.at[..dimension]);
    format!(
        "no facet of `{whole}` lies in it; the nearest has its centroid at {centre}, {}; change the region, or refine the mesh",
        out.join(" and ")
    )
}
