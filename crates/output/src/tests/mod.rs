//! A rectangle under a rigid parabola, with fields that look like contact but come from no solve.

mod files;
mod page;
mod pictures;
mod plots;
mod ticks;

use crate::Quantity;
use crate::picture::body::{ContactPicture, FieldPanel, ObstacleLine};
use crate::plots::medium::Medium;

/// Everything a [`ContactPicture`] borrows.
#[derive(Clone)]
pub struct Indented {
    pub nodes: Vec<[f64; 2]>,
    pub elements: Vec<Vec<usize>>,
    pub displacement: Vec<f64>,
    pub stress: Vec<f64>,
    pub parabola: Vec<[f64; 2]>,
    pub candidates: Vec<usize>,
    pub closed: Vec<bool>,
}

impl Indented {
    /// The body `[0, width] x [0, height]` in `columns x rows` quadrilaterals, indented by a twentieth of its height.
    pub fn new([width, height]: [f64; 2], [columns, rows]: [usize; 2]) -> Self {
        let depth = 0.05 * height;
        let stride = columns + 1;
        let nodes: Vec<[f64; 2]> = (0..=rows)
            .flat_map(|j| {
                (0..=columns).map(move |i| [width * i as f64 / columns as f64, height * j as f64 / rows as f64])
            })
            .collect();
        let elements: Vec<Vec<usize>> = (0..rows)
            .flat_map(|j| {
                (0..columns).map(move |i| {
                    let corner = j * stride + i;
                    vec![corner, corner + 1, corner + 1 + stride, corner + stride]
                })
            })
            .collect();
        // u_y <= (x - middle)^2 / (2 radius) - depth, with a radius for which the contact is 0.4 widths wide.
        let (middle, half) = (0.5 * width, 0.2 * width);
        let radius = half * half / (2.0 * depth);
        let gap = |x: f64| (x - middle).powi(2) / (2.0 * radius) - depth;
        let mut displacement = Vec::new();
        let mut stress = Vec::new();
        for &[x, y] in &nodes {
            let (up, across) = (y / height, (x - middle) / half);
            let surface = gap(x).min(-0.15 * depth * (-(across.abs() - 1.0).max(0.0)).exp());
            displacement.extend([0.25 * depth * up * across * (-0.3 * across * across).exp(), surface * up]);
            let depth_below = (1.0 - up) * height / half;
            let bulb = (-(across / (1.0 + 0.8 * depth_below)).powi(4) * 0.8).exp() / (1.0 + depth_below.powi(2)).sqrt();
            stress.push(-1.6e6 * bulb - 2.0e4 + 6.0e4 * up * (-(across.abs() - 1.6).powi(2) * 4.0).exp());
        }
        let candidates: Vec<usize> = (rows * stride..(rows + 1) * stride).collect();
        let closed = candidates.iter().map(|&node| (nodes[node][0] - middle).abs() <= 0.95 * half).collect();
        let parabola = (-20..=100).map(|k| width * f64::from(k) / 80.0).map(|x| [x, height + gap(x)]).collect();
        Indented { nodes, elements, displacement, stress, parabola, candidates, closed }
    }

    /// Coordinates and displacements times `length`, stresses times `stress`.
    pub fn scaled(mut self, length: f64, stress: f64) -> Self {
        self.nodes
            .iter_mut()
            .chain(&mut self.parabola)
            .flatten()
            .chain(&mut self.displacement)
            .for_each(|v| *v *= length);
        self.stress.iter_mut().for_each(|v| *v *= stress);
        self
    }

    pub fn obstacle(&self) -> [ObstacleLine<'_>; 1] {
        [ObstacleLine { points: &self.parabola, inside: [0.0, 1.0] }]
    }

    /// The stress, with the limits of its colour scale.
    pub fn field(&self) -> [FieldPanel<'_>; 1] {
        self.field_within([-1.7e6, 0.1e6])
    }

    pub fn field_within(&self, limits: [f64; 2]) -> [FieldPanel<'_>; 1] {
        [FieldPanel { values: &self.stress, quantity: Quantity::new("second principal stress σ₂", "Pa"), limits }]
    }

    pub fn picture<'a>(
        &'a self,
        title: &'a str,
        fields: &'a [FieldPanel<'a>],
        obstacles: &'a [ObstacleLine<'a>],
    ) -> ContactPicture<'a> {
        ContactPicture {
            title,
            axes: ["x", "y"],
            length_unit: "m",
            nodes: &self.nodes,
            elements: &self.elements,
            displacement: &self.displacement,
            magnification: 1.0,
            fields,
            obstacles,
            candidates: &self.candidates,
            closed: &self.closed,
            arrows: &[],
            medium: Medium::Screen,
            window: None,
        }
    }
}
