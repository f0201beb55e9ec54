//! Seconds to read a surface of a million triangles from a binary STL, and to find the closest points of 50,000 places.

use std::fs;

use signorini::fem::ClosedSurface;

use crate::clock::timed;
use crate::process::Failure;

/// Number of cells around the torus and around its tube; each cell has two triangles.
const CELLS: [usize; 2] = [1000, 500];

/// Number of places, near the tube on both sides of its surface, whose closest points are searched as for contact
/// candidates.
const PLACES: usize = 50_000;

pub fn run() -> Result<(), Failure> {
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("torus.stl");
    let on_tube = |u: f64, v: f64, minor: f64| {
        let (a, b) = (std::f64::consts::TAU * u, std::f64::consts::TAU * v);
        let radius = 1.0 + minor * b.cos();
        [radius * a.cos(), radius * a.sin(), minor * b.sin()]
    };
    let mut bytes = vec![b' '; 80];
    bytes.extend((2 * CELLS[0] as u32 * CELLS[1] as u32).to_le_bytes());
    for i in 0..CELLS[0] {
        for j in 0..CELLS[1] {
            let at = |i: usize, j: usize| {
                let [u, v] = [i % CELLS[0], j % CELLS[1]].map(|index| index as f64);
                on_tube(u / CELLS[0] as f64, v / CELLS[1] as f64, 0.4)
            };
            let quad = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            for corners in [[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]] {
                bytes.extend([0; 12]);
                corners.iter().flatten().for_each(|&part| bytes.extend((part as f32).to_le_bytes()));
                bytes.extend([0; 2]);
            }
        }
    }
    fs::write(&file, bytes)?;
    let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
    let place = |index: usize| {
        let u = index as f64 / PLACES as f64;
        on_tube(u, (golden * index as f64).fract(), 0.4 + 0.02 * (u - 0.5))
    };

    let (surface, read) = timed(|| ClosedSurface::read(&file, 1.0, [0.0; 3]));
    let surface = surface?;
    let ([inside, off], sought) = timed(|| {
        let [mut inside, mut off] = [0.0_f64; 2];
        for at in (0..PLACES).map(place) {
            let height = surface.closest(at, 1e-12, [0.0, 0.0, -1.0]).height;
            let exact = (at[0].hypot(at[1]) - 1.0).hypot(at[2]) - 0.4;
            inside += f64::from(u8::from(height < 0.0));
            off = off.max((height - exact).abs());
        }
        [inside, off]
    });
    println!("{} triangles read, checked and sorted into boxes: {read:.2} s", 2 * CELLS[0] * CELLS[1]);
    println!("{PLACES} closest points, {inside} inside: {sought:.2} s");
    println!("total: {:.2} s; largest difference from the distance to the smooth torus: {off:.1e}", read + sought);
    Ok(())
}
