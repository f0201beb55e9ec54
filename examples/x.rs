use signorini::*;
use std::path::Path;
fn main() {
    for a in std::env::args().skip(1) {
        let t = std::time::Instant::now();
        let p = matrix_market::read_problem(Path::new(&a)).unwrap();
        println!("{a} n {} m {} read {:.2}", p.dofs(), p.rows(), t.elapsed().as_secs_f64());
        for m in [Method::Qp, Method::ActiveSet, Method::Penalty] {
            let mut s = Settings::with_method(m);
            s.max_iterations = 3000;
            let t = std::time::Instant::now();
            let (ok, s) = match solve(&p, &s) {
                Ok(s) => ("ok".to_string(), Some(s)),
                Err(Error::NotCertified { solution, condition, .. }) => (format!("NOT {condition}"), Some(*solution)),
                Err(e) => (format!("{e}"), None),
            };
            println!("  {ok} {:.2}s", t.elapsed().as_secs_f64());
            if let Some(s) = s {
                println!(
                    "    {} it {} hist {} closed {} F {} {:?}",
                    s.method,
                    s.iterations,
                    s.history.len(),
                    s.contact_set.count(),
                    s.contact_force(),
                    s.certificate
                );
            }
        }
    }
}
