//! Seconds for the rows between two surfaces in space of 10,000 facets each, whose meshes do not match.
//!
//! The slave surface is the unit square seen from below, the master surface covers it with other facets, turned by 0.3.
//! Distorted facets have inner nodes that are moved by up to a fifth of an edge.

use signorini::fem::{Boundary, FacetKind, Formulation, Mortar};

use crate::clock::fastest;
use crate::process::Failure;

/// Runs of each case; the fastest counts.
const RUNS: usize = 3;

/// A surface of a case: its kind, and the cells along both axes.
struct Sheet {
    kind: FacetKind,
    counts: [usize; 2],
    distortion: f64,
}

impl Sheet {
    /// Nodes and facets over the square from `-margin` to `1 + margin`, turned by `angle` about its middle, facing up
    /// or down.
    fn surface(&self, margin: f64, angle: f64, is_up: bool) -> (Vec<[f64; 3]>, Boundary) {
        let ([columns, rows], mut state) = (self.counts, 7_u64);
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            self.distortion * ((state >> 40) as f64 / f64::from(1 << 24) - 0.5)
        };
        let place = |x: f64, y: f64| {
            let [x, y] = [x, y].map(|part| (1.0 + 2.0 * margin) * part - margin - 0.5);
            [0.5 + angle.cos() * x - angle.sin() * y, 0.5 + angle.sin() * x + angle.cos() * y, 0.0]
        };
        let mut nodes = Vec::new();
        for row in 0..=rows {
            for column in 0..=columns {
                let inner = row > 0 && row < rows && column > 0 && column < columns;
                let [x, y] = if inner { [random(), random()] } else { [0.0; 2] };
                nodes.push(place((column as f64 + x) / columns as f64, (row as f64 + y) / rows as f64));
            }
        }
        let mut facets = Vec::new();
        for row in 0..rows {
            for column in 0..columns {
                let a = row * (columns + 1) + column;
                let mut quad = [a, a + 1, a + columns + 2, a + columns + 1];
                if !is_up {
                    quad.reverse();
                }
                match self.kind {
                    FacetKind::Q4 => facets.extend(quad),
                    _ => facets.extend([quad[0], quad[1], quad[2], quad[0], quad[2], quad[3]]),
                }
            }
        }
        (nodes, Boundary::new("sheet", self.kind, facets))
    }
}

pub fn run() -> Result<(), Failure> {
    for (name, kind, counts, distortion) in [
        ("triangles", FacetKind::T3, [100, 50], 0.0),
        ("parallelograms", FacetKind::Q4, [100, 100], 0.0),
        ("distorted quadrilaterals", FacetKind::Q4, [100, 100], 0.4),
    ] {
        let sheet = Sheet { kind, counts, distortion };
        let (own, slave) = sheet.surface(0.0, 0.0, false);
        let (others, master) = sheet.surface(0.3, 0.3, true);
        let rows = || Mortar::new((&own, &slave), (&others, &master), Formulation::Space).rows();
        let (rows, seconds) = fastest(RUNS, rows)?;
        println!("{} {name}: {} rows in {seconds:.2} s", slave.facet_count(), rows.gap.len());
    }
    Ok(())
}
