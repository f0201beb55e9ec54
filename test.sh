#!/usr/bin/env bash
# Runs all checks. Needs cargo with rustfmt and clippy, and python3 (3.11 or later) with venv.
#
#   ./test.sh          runs the checks
#   ./test.sh needs    only says what is missing, what would be installed and which steps would be skipped
#
# Python packages go into target/. Chromium, PETSc and MPI are packages of Debian: as root in a container, or with INSTALL=1,
# apt-get installs those that are missing. Otherwise the steps that need them are skipped, and named at the end; with SKIP=never
# that is an error.
#
# All steps use one profile (dev: the crate with overflow checks, dependencies as in release), and every test runs once.
set -euo pipefail
cd "$(dirname "$0")"
target=${CARGO_TARGET_DIR:-target}
mkdir -p "$target"
CARGO_TARGET_DIR=$(cd "$target" && pwd)
export CARGO_TARGET_DIR
built=$CARGO_TARGET_DIR/debug

need() { "${@:2}" >/dev/null 2>&1 || { echo "test.sh needs $1" >&2; exit 1; }; }
need "cargo, of Rust: https://rustup.rs"                          cargo --version
need "rustfmt: rustup component add rustfmt"                      cargo fmt --version
need "clippy: rustup component add clippy"                        cargo clippy --version
need "python3, version 3.11 or later"                             python3 -c 'import sys; sys.exit(sys.version_info < (3, 11))'
need "venv of python3: on Debian apt-get install python3-venv"    python3 -c 'import ensurepip, venv'

pages="pages, in a real browser"
distributed="distributed, on PETSc"
has_chromium() { (cd reference && python3 -B -c 'import browser; browser.found()') 2>/dev/null; }
# Prints the interpreter that has PETSc.
petsc_python() { (cd distributed && python3 -B -c 'import launch; print(launch.interpreter())') 2>/dev/null; }
has_mpirun() { command -v mpirun >/dev/null; }
# Sets `missing`, the packages of Debian that are not installed, and `skipped`, a line for each step that cannot run without them.
look() {
    missing=() skipped=()
    has_chromium || { missing+=(chromium); skipped+=("$pages: there is no Chromium"); }
    has_mpirun || { missing+=(openmpi-bin); skipped+=("$distributed: there is no mpirun"); }
    petsc_python >/dev/null || { missing+=(python3-petsc4py python3-numpy); skipped+=("$distributed: there is no petsc4py"); }
}
is_skipped() { [[ "${skipped[*]-}" == *"$1"* ]]; }
is_container() {
    [ -e /.dockerenv ] || [ -e /run/.containerenv ] || [ -n "${container:-}${KUBERNETES_SERVICE_HOST:-}" ] \
        || grep -qsE 'docker|containerd|kubepods|libpod|lxc' /proc/1/cgroup || systemd-detect-virt --container --quiet 2>/dev/null
}
is_root() { [ "$(id -u)" -eq 0 ]; }
may_install() { command -v apt-get >/dev/null && { [ "${INSTALL:-}" = 1 ] || { is_root && is_container; }; }; }
apt() {
    local sudo=""
    is_root || sudo=sudo
    $sudo env DEBIAN_FRONTEND=noninteractive apt-get -qq "$@" </dev/null >/dev/null
}

look
if [ ${#missing[@]} -gt 0 ] && may_install; then
    echo "== test.sh installs by apt-get: ${missing[*]}"
    [ "${1:-}" = needs ] && exit
    { apt update && apt install -y --no-install-recommends "${missing[@]}"; } || echo "apt-get failed" >&2
    look
fi
# Names the skipped steps.
tell_skipped() {
    [ ${#skipped[@]} -gt 0 ] || return 0
    printf '== skipped: %s\n' "${skipped[@]}"
    echo "   INSTALL=1 ./test.sh installs by apt-get what these steps need: ${missing[*]}"
}
tell_skipped
if [ ${#skipped[@]} -gt 0 ] && [ "${SKIP:-}" = never ]; then
    echo "== failed: SKIP=never allows no skipped step" >&2
    exit 1
fi
[ "${1:-}" = needs ] && exit

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
example() { printf -- '-- %s\n' "$*"; "$built/examples/$1" "${@:2}"; }
program() { printf -- '-- signorini %s\n' "$*"; "$built/signorini" "$@"; }

step "format";                      cargo fmt --all --check
step "lints, as errors";            cargo clippy --quiet --workspace --all-targets --all-features -- -D warnings
step "documentation, as errors";    RUSTDOCFLAGS="-D warnings" cargo doc --quiet --workspace --no-deps --all-features
step "features, each without the others"
for features in "" pictures; do cargo clippy --quiet --no-default-features --features "$features" -- -D warnings; done
for features in "" faer nalgebra; do cargo clippy --quiet --package signorini-qp --features "$features" -- -D warnings; done
step "build";                       cargo test --quiet --workspace --no-run --all-features
step "tests";                       cargo test --quiet --workspace --all-features
step "examples and short forms of tools"
for lesson in two_springs one_scene find_the_contact_set many_gaps judge_an_answer bouncing_mass uniform_pressure; do example $lesson; done
example studies verification --short
example studies extremes --most 100
# Every version has inputs of its own: its digits are the seed.
seed=$(sed -n '/^version = /{s/[^0-9]//g;p;q}' Cargo.toml)
for target in scene mesh matrix problem; do example studies fuzz $target 20000 "$seed"; done
example studies fuzz exact 2000 "$seed"
example studies contact_cost --only "Q4 64,Hex8 6" --rounds 1
example studies multigrid --most-dofs 20000
example studies impact
example studies dynamic_cost --short
for scene in examples/*.json; do program compare "$scene" --out "$out/$(basename "$scene" .json)"; done
for scene in studies/impact/*.json; do program solve "$scene" --out "$out/$(basename "$scene" .json)"; done
program sweep examples/indentation.json --gaps -0.01:-0.10:10 --out "$out/sweep"
step "identical answers in two runs";     python3 reference/same_reports.py "$built/signorini" "$built/signorini" examples tests/corpus

step "Python package";              python/test.sh
step "reference, its own tests";    reference/environment.sh
target/venv/bin/python -m unittest discover --start-directory reference
step "schema, valid and invalid scenes"; target/venv/bin/python reference/schema.py "$built/signorini"
step "reference, live validation";  target/venv/bin/python reference/validate.py --signorini "$built/signorini"
step "documents as a site";         reference/book.sh
if ! is_skipped "$pages"; then
    step "$pages"
    (cd reference && SIGNORINI="$built/signorini" ../target/venv/bin/python -m unittest pages site_pages)
fi

if ! is_skipped "$distributed"; then
    step "$distributed"
    petsc=$(petsc_python)
    # The options of PETSc are global to a process, so that each test file runs in a process of its own.
    for tests in distributed/tests/test_*.py; do
        SIGNORINI="$built/signorini" "$petsc" -B -m unittest discover --start-directory distributed/tests --pattern "${tests##*/}"
    done
fi

step ""
printf '\n%s%6d s  in all: %d minutes\n' "$times" $SECONDS $(((SECONDS + 30) / 60))
tell_skipped
if [ ${#skipped[@]} -gt 0 ]; then echo "== all other checks passed"; else echo "== all checks passed"; fi
