//! The phases of a body: the material of each element.

use super::ElasticBody;
use super::phase::{Phase, PhaseNumber, Region, Temperature};
use crate::error::Error;
use crate::geometry::Symmetric;
use crate::material::Material;
use crate::mesh::fail;
use signorini_linear as linear;

impl ElasticBody {
    /// The same body with another material in some `elements`: their indices, from 0, in any order.
    ///
    /// # Errors
    /// As [`ElasticBody::new`] for the material; [`Error::Mesh`] for an element that does not exist, for a body of
    /// several regions, for an orthotropic material with mean dilatation.
    pub fn with_material(self, elements: &[usize], material: Material) -> Result<Self, Error> {
        let formulation = self.formulation;
        let body = self.with_phase(elements, |phase| phase.of(material, &formulation))?;
        body.check_integration()?;
        Ok(body)
    }

    /// The same body with some `elements` (indices from 0, in any order) warmer than the stress-free state: by `value`
    /// at the origin (degrees) and `gradient` (x, y, z; degrees per length) from there. It replaces an earlier
    /// temperature of an element.
    ///
    /// # Errors
    /// [`linear::Error::Setting`] for a material without coefficients of expansion, or numbers that are not finite;
    /// [`Error::Mesh`] as [`with_material`](Self::with_material).
    pub fn with_temperature(self, elements: &[usize], value: f64, gradient: [f64; 3]) -> Result<Self, Error> {
        let temperature = Temperature { value, gradient };
        self.with_phase(elements, |phase| phase.clone().with_temperature(temperature))
    }

    /// The same body with a stress `[xx, yy, zz, xy, yz, zx]` (force per area, tension positive) in some `elements`
    /// (indices from 0, in any order) that acts without strain. It replaces an earlier initial stress of an element.
    ///
    /// # Errors
    /// [`linear::Error::Setting`] for a component that is not finite, or that the formulation does not have;
    /// [`Error::Mesh`] as [`with_material`](Self::with_material).
    pub fn with_initial_stress(self, elements: &[usize], stress: Symmetric) -> Result<Self, Error> {
        let formulation = self.formulation;
        self.with_phase(elements, |phase| phase.clone().with_initial_stress(stress, &formulation))
    }

    /// Returns `true` if there is stress without strain.
    #[doc(hidden)]
    pub fn has_own_stress(&self) -> bool {
        self.phases.iter().any(|phase| phase.own.is_some())
    }

    /// The same with another phase in some elements, made from their present phase.
    fn with_phase(mut self, elements: &[usize], make: impl Fn(&Phase) -> Result<Phase, Error>) -> Result<Self, Error> {
        if self.regions.len() > 1 {
            return fail("bodies have their materials before they are joined".into());
        }
        let mut made: Vec<Option<u32>> = vec![None; self.phases.len()];
        for &element in elements {
            let count = self.of_elements.len();
            let Some(own) = self.of_elements.get_mut(element) else {
                return fail(format!("there is no element {element}; the mesh has {count}, from 0"));
            };
            // An element that is named twice already has its new phase.
            let Some(place) = made.get_mut(*own as usize) else { continue };
            if place.is_none() {
                *place = Some(self.phases.len() as u32);
                self.phases.push(make(&self.phases[*own as usize])?);
            }
            *own = place.unwrap_or(*own);
        }
        self.leave_out_empty_phases();
        Ok(self)
    }

    fn leave_out_empty_phases(&mut self) {
        let mut number = vec![None; self.phases.len()];
        self.of_elements.iter().for_each(|&phase| number[phase as usize] = Some(0));
        let mut next = 0..;
        number.iter_mut().flatten().for_each(|number| *number = next.next().unwrap_or_default());
        let mut is_used = number.iter().map(Option::is_some);
        self.phases.retain(|_| is_used.next().unwrap_or_default());
        self.of_elements.iter_mut().for_each(|phase| *phase = number[*phase as usize].unwrap_or_default());
    }

    /// The body whose stresses are the derivatives of the stresses with respect to a number of each phase, at the same
    /// displacement: one number for each phase. `None` for a modulus of an orthotropic material.
    #[doc(hidden)]
    pub fn derivative(&self, by: &[PhaseNumber]) -> Option<Self> {
        let phases = self.phases.iter().zip(by).map(|(phase, &by)| phase.derivative(by)).collect::<Option<_>>()?;
        Some(ElasticBody { phases, ..self.clone() })
    }

    /// All phases, region by region; each has an element.
    #[doc(hidden)]
    pub fn phases(&self) -> &[Phase] {
        &self.phases
    }

    /// The phases of the elements of a region.
    #[doc(hidden)]
    pub fn phases_of(&self, region: &Region) -> &[Phase] {
        let own = &self.of_elements[region.elements()];
        let [first, last] = [own.iter().min(), own.iter().max()].map(|phase| phase.map_or(0, |&phase| phase as usize));
        &self.phases[first..=last]
    }

    /// The materials of the elements of a region: one, unless parts of the region have their own.
    pub fn materials(&self, region: &Region) -> impl Iterator<Item = &Material> {
        self.phases_of(region).iter().map(Phase::material)
    }

    /// The material of an element, numbered from 0.
    #[doc(hidden)]
    pub fn material_of(&self, element: usize) -> &Material {
        self.phases[self.of_elements[element] as usize].material()
    }

    /// The density of the material of every element, in the order of [`elements`](Self::elements).
    pub(crate) fn densities(&self) -> Result<Vec<f64>, Error> {
        let missing = || linear::Error::Setting { name: "density", value: f64::NAN, allowed: "positive and finite" };
        let of_phases: Vec<f64> =
            self.phases.iter().map(|phase| phase.material().density().ok_or_else(missing)).collect::<Result<_, _>>()?;
        Ok(self.of_elements.iter().map(|&phase| of_phases[phase as usize]).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formulation::Formulation;
    use crate::geometry::distance;
    use crate::mesh::bisection::Tetrahedra;
    use crate::mesh::gmsh::GmshFile;

    fn volumes(body: &ElasticBody) -> Vec<f64> {
        let (tables, mut volumes) = (body.tabulated(), vec![0.0; body.phases().len()]);
        for element in body.elements() {
            let scale = element.cell.unit().powi(3);
            let parts = tables.at(element.kind).points.iter().map(|at| scale * body.point(&element.cell, at).weight);
            volumes[element.phase_number as usize] += parts.sum::<f64>();
        }
        volumes
    }

    #[test]
    fn bisection_leaves_every_place_its_material() {
        let mesh = GmshFile::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/meshes/box-tet4.msh"))
            .unwrap()
            .mesh(&[], 1.0)
            .unwrap();
        let [soft, stiff] = [1.0, 2.0].map(|young| Material::new(young, 0.3).unwrap());
        let near: Vec<usize> = (0..mesh.element_count())
            .filter(|&element| mesh.element(element).iter().any(|&node| distance(mesh.nodes()[node], [0.0; 3]) < 0.5))
            .collect();
        let mut cells = Tetrahedra::of(&mesh).unwrap();
        let body = ElasticBody::new(mesh, soft, Formulation::Space).unwrap().with_material(&near, stiff).unwrap();
        let expected = volumes(&body);
        assert!(expected.len() == 2 && expected.iter().all(|volume| *volume > 0.01), "{expected:?}");
        for round in 0..3 {
            let count = cells.parents().len();
            cells.refine(&(0..count).map(|cell| cell % 5 == round).collect::<Vec<_>>(), 2);
            let finer = body.on(cells.mesh().unwrap(), &cells.parents()).unwrap();
            assert!(finer.mesh().element_count() > count && finer.phases() == body.phases());
            for (found, expected) in volumes(&finer).iter().zip(&expected) {
                assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
            }
        }
    }
}
