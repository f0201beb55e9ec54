#!/usr/bin/env bash
# Runs all checks. Needs cargo (with rustfmt and clippy), python3 >= 3.11 with venv, and Chromium.
# The Python packages of the reference are installed into target/reference-venv, those of python/ into target/python-venv.
# The tests of distributed/ run if Debian's python3-petsc4py and openmpi-bin are installed; DISTRIBUTED=required makes their
# absence an error.
#
# All steps use one profile (dev: the crate with overflow checks, dependencies as in release), and every test runs once.
set -euo pipefail
cd "$(dirname "$0")"

need() { command -v "$1" >/dev/null || { echo "test.sh needs $1: $2" >&2; exit 1; }; }
need cargo "the Rust toolchain"
need python3 "version 3.11 or later, with the venv module, for the reference validation"
need "${CHROMIUM:-chromium}" "a headless browser, in which the pages are opened; on Debian apt-get install chromium"

out=$(mktemp -d)
name="" began=0 times=""
# Ends the current step, if there is one, and begins another.
step() {
    local now=$SECONDS
    [ -z "$name" ] || times+=$(printf '%6d s  %s' $((now - began)) "$name")$'\n'
    name=$* began=$now
    [ -z "$name" ] || printf '\n== %s\n' "$name"
}
ended() {
    local code=$?
    rm -rf "$out"
    [ $code -eq 0 ] || printf '\n== failed: %s\n' "$name" >&2
}
trap ended EXIT
built=${CARGO_TARGET_DIR:-target}/debug
example() { printf -- '-- %s\n' "$*"; "$built/examples/$1" "${@:2}"; }
program() { printf -- '-- signorini %s\n' "$*"; "$built/signorini" "$@"; }

step "format";                      cargo fmt --check
step "lints, as errors";            cargo clippy --quiet --all-targets --all-features -- -D warnings
step "documentation, as errors";    RUSTDOCFLAGS="-D warnings" cargo doc --quiet --no-deps --all-features
step "features, each without the others"
for features in "" pictures faer nalgebra; do
    cargo clippy --quiet --no-default-features --features "$features" -- -D warnings
done
step "build";                       cargo test --quiet --no-run --all-features
step "tests";                       cargo test --quiet --all-features
step "examples and short forms of tools"
for lesson in two_springs one_scene find_the_contact_set many_gaps judge_an_answer bouncing_mass; do example $lesson; done
example verification --short
example extremes --most 100
for target in scene mesh matrix problem; do example fuzz $target 20000; done
example contact_cost --only "Q4 64,Hex8 6" --rounds 1
example multigrid --most-dofs 20000
example impact
example dynamic_cost --short
for scene in examples/*.json; do program compare "$scene" --out "$out/$(basename "$scene" .json)"; done
for scene in tools/impact/*.json; do program solve "$scene" --out "$out/$(basename "$scene" .json)"; done
program sweep examples/indentation.json --gaps -0.01:-0.10:10 --out "$out/sweep"
step "identical answers in two runs";     python3 reference/same_reports.py "$built/signorini" "$built/signorini" examples tests/corpus

step "Python package";              python/test.sh
step "reference, its own tests";    reference/environment.sh
target/reference-venv/bin/python -m unittest discover --start-directory reference
step "schema, valid and invalid scenes"; target/reference-venv/bin/python reference/schema.py "$built/signorini"
step "reference, live validation";  target/reference-venv/bin/python reference/validate.py --signorini "$built/signorini"
step "pages, in a real browser";    (cd reference && SIGNORINI="../$built/signorini" ../target/reference-venv/bin/python -m unittest pages)

step "distributed, on PETSc"
if (cd distributed && /usr/bin/python3 -B -c "import ranks") 2>/dev/null && command -v mpirun >/dev/null; then
    # The options of PETSc are global to a process, so that each test file runs in a process of its own.
    for tests in distributed/tests/test_*.py; do
        SIGNORINI="$PWD/$built/signorini" /usr/bin/python3 -B -m unittest discover --start-directory distributed/tests --pattern "${tests##*/}"
    done
elif [ "${DISTRIBUTED:-}" = required ]; then
    echo "the distributed tests need PETSc and MPI: apt-get install python3-petsc4py openmpi-bin" >&2
    exit 1
else
    echo "skipped: /usr/bin/python3 has no PETSc, or mpirun is missing; on Debian apt-get install python3-petsc4py openmpi-bin"
fi

step ""
printf '\n%s%6d s  in all\n== all checks passed\n' "$times" $SECONDS
