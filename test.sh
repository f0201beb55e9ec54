#!/usr/bin/env bash
# Everything that can be checked, in one command; needs cargo (with rustfmt and clippy) and python3 >= 3.11 with venv.
# The Python packages of the reference are installed into target/reference-venv.
set -euo pipefail
cd "$(dirname "$0")"

step() { printf '\n== %s\n' "$*"; }
need() { command -v "$1" >/dev/null || { echo "test.sh needs $1: $2" >&2; exit 1; }; }
need cargo "the Rust toolchain"
need python3 "version 3.11 or later, with the venv module, for the reference validation"

step "format";                      cargo fmt --check
step "lints, as errors";            cargo clippy --quiet --all-targets -- -D warnings
step "documentation, as errors";    RUSTDOCFLAGS="-D warnings" cargo doc --quiet --no-deps
step "tests, with debug checks";    cargo test --quiet
step "tests, release";              cargo test --quiet --release
step "examples";                    cargo build --quiet --release --examples --bins
cargo run --quiet --release --example two_springs
cargo run --quiet --release --example verification
cargo run --quiet --release --example extremes -- --most 10000
for target in scene mesh matrix problem; do cargo run --quiet --release --example fuzz -- $target 20000; done
cargo run --quiet --release --example contact_cost -- --only "Q4 64,Hex8 12" --rounds 1
cargo run --quiet --release --example multigrid -- --most-dofs 20000
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
cargo run --quiet --release --example impact
cargo run --quiet --release --example dynamic_cost
for scene in examples/*.json; do
    echo "-- $scene"
    target/release/signorini compare "$scene" --out "$out/$(basename "$scene" .json)"
done
for scene in examples/impact/*.json; do
    echo "-- $scene"
    target/release/signorini solve "$scene" --out "$out/$(basename "$scene" .json)"
done
target/release/signorini sweep examples/indentation.json --gaps -0.01:-0.10:10 --out "$out/sweep"

step "reference, its own tests";    reference/environment.sh
target/reference-venv/bin/python -m unittest discover --start-directory reference
step "reference, live validation";  target/reference-venv/bin/python reference/validate.py --signorini target/release/signorini
step "all checks passed"
