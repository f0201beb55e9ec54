//! Temperatures and initial stresses of a body of a scene: the stress without strain.

use super::selection::{Selection, centroids};
use crate::error::Error;
use crate::fem::body::ElasticBody;
use crate::scene::input::entry::{finite, point, vector, wrong};
use crate::scene::input::schema::{DynamicSpec, InitialStressSpec, TemperatureSpec};

/// The names of the components of a stress, in their order.
const COMPONENTS: [&str; 6] = ["xx", "yy", "zz", "xy", "yz", "zx"];

/// Temperatures and initial stresses as a scene describes them.
pub(crate) struct Unstrained<'a> {
    pub temperature: &'a [TemperatureSpec],
    pub stress: &'a [InitialStressSpec],
}

impl Unstrained<'_> {
    /// The body with them; `place` is the prefix of its JSON paths.
    pub fn placed(
        &self,
        mut body: ElasticBody,
        place: &str,
        motion: Option<&DynamicSpec>,
    ) -> Result<ElasticBody, Error> {
        for (name, count) in [("temperature", self.temperature.len()), ("initial-stress", self.stress.len())] {
            if motion.is_some() && count > 0 {
                let message = format!("a dynamic analysis has no `{name}`: only an equilibrium has; leave it out");
                return Err(wrong(format!("{place}{name}"), message));
            }
        }
        for (index, spec) in self.temperature.iter().enumerate() {
            body = warmed(body, spec, &format!("{place}temperature[{index}]"))?;
        }
        for (index, spec) in self.stress.iter().enumerate() {
            body = stressed(body, spec, &format!("{place}initial-stress[{index}]"))?;
        }
        Ok(body)
    }
}

/// The body with the temperature at the JSON path `path`.
fn warmed(body: ElasticBody, spec: &TemperatureSpec, path: &str) -> Result<ElasticBody, Error> {
    finite(format!("{path}.value"), spec.value)?;
    let gradient = match spec.gradient.is_empty() {
        true => [0.0; 3],
        false => vector(&format!("{path}.gradient"), &spec.gradient, body.dimension())?,
    };
    let selection = Selection { group: spec.group.as_deref(), cuboid: spec.cuboid.as_ref() };
    let elements = selection.elements(&body, path)?;
    if let Some(&element) = elements.iter().find(|&&element| body.material_of(element).expansion().is_none()) {
        let at = centroids(&body)[element];
        let at = point(&at[..body.dimension()]);
        let message = format!("the material at {at} has no `expansion`, which a temperature needs; give it");
        return Err(wrong(path, message));
    }
    body.with_temperature(&elements, spec.value, gradient)
}

/// The body with the initial stress at the JSON path `path`.
fn stressed(body: ElasticBody, spec: &InitialStressSpec, path: &str) -> Result<ElasticBody, Error> {
    let stress = [spec.xx, spec.yy, spec.zz, spec.xy, spec.yz, spec.zx];
    let own = body.formulation().stresses();
    for (component, (&value, name)) in stress.iter().zip(COMPONENTS).enumerate() {
        finite(format!("{path}.{name}"), value)?;
        if value != 0.0 && !own.contains(&component) {
            let names: Vec<&str> = own.iter().map(|&component| COMPONENTS[component]).collect();
            let message = format!("{} has no such stress; it has {}", body.formulation().name(), names.join(", "));
            return Err(wrong(format!("{path}.{name}"), message));
        }
    }
    let selection = Selection { group: spec.group.as_deref(), cuboid: spec.cuboid.as_ref() };
    let elements = selection.elements(&body, path)?;
    body.with_initial_stress(&elements, stress)
}
