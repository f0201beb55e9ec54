use serde_json::json;
use signorini::sparse::multigrid::*;
use signorini::*;
use std::time::Instant;
fn model(n: usize, r: f64, gap: f64) -> Result<Model, Error> {
    let axis = json!({"points": [0, 1], "divisions": [n]});
    let scene = json!({"model":"space","body":{"box":{"x":axis,"y":axis,"z":axis,"element":"hex8"}},
      "material":{"young":1e7,"poisson":0.3},"supports":[{"on":{"boundary":"bottom"},"x":0,"y":0,"z":0}],
      "obstacles":[{"boundary":"top","approach":"+z","rule":"approach","shape":{"sphere":{"apex":[0.5,0.5,1],"radius":r}}}],
      "gap":gap});
    Scene::from_json(&scene.to_string(), "block")?.build()
}
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().collect();
    let n: usize = args[1].parse()?;
    let threads: usize = args.get(2).map_or(1, |t| t.parse().unwrap());
    let t = Instant::now();
    let m = model(n, 2.0, -0.01)?;
    let p = m.problem();
    println!("{} dofs built {:.2}", p.dofs(), t.elapsed().as_secs_f64());
    let t = Instant::now();
    let y = p.stiffness().mul(p.load());
    println!("product {:.3} {}", t.elapsed().as_secs_f64(), y.len());
    let t = Instant::now();
    let mg = Multigrid::new(p.stiffness(), p.near_null().unwrap(), threads)?;
    println!("setup {:.2} s, {:?}, {:.2} GB", t.elapsed().as_secs_f64(), mg.unknowns(), mg.bytes() as f64 / 1e9);
    let f = p.contact().mul_transposed(&vec![-1.0; p.rows()]);
    let t = Instant::now();
    let cg = conjugate_gradients(p.stiffness(), &f, &mg, 1e-8, 100)?;
    println!("cg {} cycles {:.2} s {:e}", cg.cycles, t.elapsed().as_secs_f64(), cg.residual);
    for tolerance in [1e-8, 1e-10] {
        let t = Instant::now();
        let o = signorini::method::mprgp::solve(p, &mg, Default::default(), signorini::method::mprgp::Limits { tolerance, most_cycles: 500 })?;
        println!("mprgp {tolerance:e}: {} cycles, {} sets, {} closed, {} {:.2} s", o.iterations, o.history.len(), o.contact_set.count(), o.settled, t.elapsed().as_secs_f64());
        println!("{:?}", o.history.iter().map(|h| h.contact_set.count()).collect::<Vec<_>>());
    }
    if n <= 32 {
        let s = solve(p, &Settings::with_method(Method::ActiveSet))?;
        println!("direct {} closed {} iterations", s.contact_set.count(), s.iterations);
    }
    Ok(())
}
