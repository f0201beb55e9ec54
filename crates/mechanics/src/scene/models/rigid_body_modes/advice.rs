//! The advice for bodies with free motions: supports that hold them, as a scene writes them.

use std::collections::{BTreeMap, HashSet};

use super::unit::{AXES, NAMED};
use super::{RigidBodyModes, component};
use crate::fem::geometry::COORDINATES;
use crate::scene::input::entry::number;
use crate::scene::models::parts::{Origin, Parts};
use crate::scene::models::rows::ContactRow;
use signorini_qp::dot;

/// A place where a motion is below this share of its largest component does not hold it.
const MOVES: f64 = 1e-3;

impl RigidBodyModes {
    /// The advice for bodies with these free motions.
    pub fn advice(&self, parts: &Parts, rows: &[ContactRow], free: &[Vec<f64>]) -> String {
        let advice = match (rows.is_empty(), parts.body.regions().len()) {
            (true, _) => "add a support",
            (false, 1) => "a frictionless obstacle does not hold it, add a guide",
            (false, _) => "contact without friction does not hold it, add a guide",
        };
        let supports = self.supports_against(parts, rows, free);
        let (advice, of) = match parts.origin {
            Origin::Deck => (format!("{advice} by `*BOUNDARY`"), "deck has no `*BOUNDARY`"),
            _ if supports.is_empty() => (advice.to_string(), "scene has no supports"),
            _ => (format!("{advice}, such as {} in `supports`", supports.join(", ")), "scene has no supports"),
        };
        let is_free = parts.supports == 0 && parts.springs.is_empty();
        let first = format!(". The {of}: first hold the side where the body is fixed");
        if is_free { advice + &first } else { advice }
    }

    /// Supports against free motions, as a scene writes them. A motion of several bodies is held at the first.
    fn supports_against(&self, parts: &Parts, rows: &[ContactRow], free: &[Vec<f64>]) -> Vec<String> {
        let touched: HashSet<usize> = rows.iter().flat_map(|row| row.ends.iter().map(|end| end.0)).collect();
        let mut of_bodies: BTreeMap<usize, Vec<&Vec<f64>>> = BTreeMap::new();
        for motion in free {
            let moves = |place: &usize| motion[6 * place..6 * (place + 1)].iter().any(|part| part.abs() > NAMED);
            if let Some(place) = (0..self.bodies.len()).find(moves) {
                of_bodies.entry(place).or_default().push(motion);
            }
        }
        let of_body = |(place, motions): (usize, Vec<&Vec<f64>>)| {
            let on_boundary = self.boundary_against(parts, &touched, (place, &motions));
            on_boundary.map_or_else(|| self.points_against(parts, &touched, (place, motions)), |support| vec![support])
        };
        of_bodies.into_iter().flat_map(of_body).collect()
    }

    /// A support on a boundary of a body that nothing can touch; `None` without such a boundary.
    fn boundary_against(
        &self,
        parts: &Parts,
        touched: &HashSet<usize>,
        (place, motions): (usize, &[&Vec<f64>]),
    ) -> Option<String> {
        let is_free = |axis: usize| {
            // A translation along the axis, or a rotation about one of the two others.
            let moving = [axis, 3 + (axis + 1) % 3, 3 + (axis + 2) % 3];
            motions.iter().any(|motion| moving.iter().any(|part| motion[6 * place + part].abs() > NAMED))
        };
        let own = &self.bodies[place].nodes;
        let is_touched = |name: &str| parts.obstacles.iter().any(|obstacle| obstacle.boundary() == name);
        // With a single body the obstacles alone decide: a boundary beside them shares the nodes of an edge.
        let alone = parts.body.regions().len() == 1;
        let fits = |nodes: Vec<usize>| {
            !nodes.is_empty() && nodes.iter().all(|node| own.contains(node) && (alone || !touched.contains(node)))
        };
        let mut boundaries = parts.body.mesh().boundaries().iter().filter(|boundary| fits(boundary.nodes()));
        let boundary = boundaries.find(|boundary| !is_touched(&boundary.name))?;
        let held: Vec<String> =
            (0..self.dimension).filter(|&axis| is_free(axis)).map(|axis| format!("\"{}\": 0", AXES[axis])).collect();
        let name = serde_json::Value::from(boundary.name.as_str());
        Some(format!("{{\"on\": {{\"boundary\": {name}}}, {}}}", held.join(", ")))
    }

    /// Supports at nodes of a body, as few as hold its motions; nodes that nothing can touch first.
    fn points_against(
        &self,
        parts: &Parts,
        touched: &HashSet<usize>,
        (place, motions): (usize, Vec<&Vec<f64>>),
    ) -> Vec<String> {
        let nodes = parts.body.mesh().nodes();
        let own = || self.bodies[place].nodes.clone();
        let untouched: Vec<usize> = own().filter(|node| !touched.contains(node)).collect();
        let candidates = if untouched.is_empty() { own().collect() } else { untouched };
        let mut left: Vec<Vec<f64>> = motions.into_iter().cloned().collect();
        let mut held: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        while let Some((node, axis, of_motions)) = self.strongest(nodes, &candidates, &left) {
            held.entry(node).or_default().push(axis);
            left = without(left, &of_motions);
        }
        let support = |(node, axes): (usize, Vec<usize>)| {
            let at: Vec<String> = nodes[node][..self.dimension].iter().map(|&value| number(value + 0.0)).collect();
            let held = |axis: usize| axes.contains(&axis).then(|| format!("\"{}\": 0", AXES[axis]));
            let held: Vec<String> = (0..self.dimension).filter_map(held).collect();
            format!("{{\"on\": {{\"point\": [{}]}}, {}}}", at.join(", "), held.join(", "))
        };
        held.into_iter().map(support).collect()
    }

    /// The node and the axis along which some motions have the largest components, and these; `None` if they have none.
    fn strongest(
        &self,
        nodes: &[[f64; 3]],
        candidates: &[usize],
        motions: &[Vec<f64>],
    ) -> Option<(usize, usize, Vec<f64>)> {
        let mut best = None;
        let mut largest = MOVES;
        for &node in candidates {
            for (axis, direction) in COORDINATES.into_iter().enumerate().take(self.dimension) {
                let unit = self.along(node, nodes[node], direction);
                let components: Vec<f64> = motions.iter().map(|motion| component(&unit, motion)).collect();
                let size = dot(&components, &components).sqrt();
                // Of nodes as good, the first: several directions are then held at one node.
                if size > (1.0 + MOVES) * largest {
                    (best, largest) = (Some((node, axis, components)), size);
                }
            }
        }
        best
    }
}

/// The motions that have no component where the given ones have these: one fewer.
fn without(mut motions: Vec<Vec<f64>>, components: &[f64]) -> Vec<Vec<f64>> {
    let largest = (0..components.len()).max_by(|&a, &b| components[a].abs().total_cmp(&components[b].abs()));
    let Some(pivot) = largest else { return motions };
    let removed = motions.remove(pivot);
    let others = components.iter().enumerate().filter(|(place, _)| *place != pivot).map(|(_, component)| component);
    for (motion, component) in motions.iter_mut().zip(others) {
        let share = component / components[pivot];
        motion.iter_mut().zip(&removed).for_each(|(value, part)| *value -= share * part);
    }
    motions
}
