//! Elements of a body, chosen by group or by place.

use crate::error::{Error, nearly};
use crate::fem::body::ElasticBody;
use crate::scene::input::entry::wrong;
use crate::scene::input::schema::part::PartBoxSpec;

/// The selected elements of a body: those of a group, those with the centroid in a box, those in both; all if neither
/// is given.
pub(crate) struct Selection<'a> {
    pub group: Option<&'a str>,
    pub cuboid: Option<&'a PartBoxSpec>,
}

impl Selection<'_> {
    /// The elements, numbered from 0, of the selection at the JSON path `path`.
    pub fn elements(&self, body: &ElasticBody, path: &str) -> Result<Vec<usize>, Error> {
        let mut elements: Vec<usize> = match self.group {
            None => (0..body.mesh().element_count()).collect(),
            Some(name) => of_group(body, name, path)?,
        };
        if let Some(cuboid) = self.cuboid {
            let [low, high] = cuboid.corners(path, body.dimension())?;
            let centroids = centroids(body);
            let is_in = |at: &[f64; 3]| (0..3).all(|axis| low[axis] <= at[axis] && at[axis] <= high[axis]);
            elements.retain(|&element| is_in(&centroids[element]));
        }
        if elements.is_empty() {
            return Err(wrong(path, "no element has its centroid there; change the box, or refine the mesh"));
        }
        Ok(elements)
    }
}

fn of_group(body: &ElasticBody, name: &str, path: &str) -> Result<Vec<usize>, Error> {
    let groups = body.mesh().groups();
    let own = groups.iter().filter(|group| group.name == name);
    let elements: Vec<usize> = own.flat_map(|group| group.elements.iter().copied()).collect();
    if elements.is_empty() {
        let names: Vec<String> = groups.iter().map(|group| format!("`{}`", group.name)).collect();
        let there = match names.is_empty() {
            true => "the body has none".to_string(),
            false => format!("there are {}", names.join(", ")),
        };
        let meant = nearly(name, groups.iter().map(|group| group.name.as_str()));
        return Err(wrong(format!("{path}.group"), format!("there is no group of elements `{name}`; {there}{meant}")));
    }
    Ok(elements)
}

pub(crate) fn centroids(body: &ElasticBody) -> Vec<[f64; 3]> {
    let tables = body.tabulated();
    body.elements().map(|element| element.cell.place(&tables.at(element.kind).centroid.shape)).collect()
}
