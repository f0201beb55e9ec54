#!/usr/bin/env bash
# Runs the checks. Needs cargo with rustfmt and clippy, and python3 (3.11 or later) with venv.
#
#   ./test.sh          runs the steps that the changes since the last full pass call for, by their class
#   ./test.sh all      runs all steps, and the tests in their long form; if all pass, tests/full-pass.txt names the commit
#   ./test.sh needs    only says what is missing, what would be installed, and which steps would be left out or skipped
#
# A step of class `every` runs each time, one of class `code` unless pages alone differ from the last full pass, one of class `pages` only
# then, and a `long` step if one of its files differs.
# The last full pass is the commit in tests/full-pass.txt. If the history does not have it, every step runs but that of the pages.
# Python packages go into target/. Chromium, PETSc, MPI and valgrind are packages of Debian: as root in a container, or with INSTALL=1,
# apt-get installs those that are missing and that a step needs. Otherwise these steps are skipped, and named at the end; with SKIP=never
# that is an error.
#
# All steps but `ledger` use one profile (dev: the crate with overflow checks, dependencies as in release), and every test runs once.
set -euo pipefail
cd "$(dirname "$0")"
target=${CARGO_TARGET_DIR:-target}
mkdir -p "$target"
CARGO_TARGET_DIR=$(cd "$target" && pwd)
export CARGO_TARGET_DIR
built=$CARGO_TARGET_DIR/debug
python=$CARGO_TARGET_DIR/venv/bin/python
kept=tests/full-pass.txt
# One pass lints and builds: the compiler of clippy also compiles. Its variables are as `cargo clippy -- -D warnings` sets them.
export RUSTC_WORKSPACE_WRAPPER=clippy-driver CLIPPY_ARGS=-D__CLIPPY_HACKERY__warnings__CLIPPY_HACKERY__

# Class, lane, name, command, and the files that trigger a long step: its own script, pages and folder. The steps of lane `first` run one
# after the other; then the lanes `tests` and `others` run beside each other.
table="
every | first  | format        | cargo fmt --all --check |
long  | first  | documentation | rustdoc_as_errors    | Cargo.toml src/lib.rs crates/*/src/lib.rs
long  | first  | features      | features             | Cargo.toml crates/*/Cargo.toml src/lib.rs crates/qp/src/lib.rs crates/linear/src/lib.rs
every | first  | lints and build | cargo test --quiet --workspace --all-targets --all-features --no-run |
code  | tests  | tests         | cargo test --quiet --workspace --all-features |
code  | tests  | lessons       | lessons              |
pages | tests  | tests of pages | tests_of_pages      |
long  | tests  | studies       | studies              | studies examples/*.json
code  | others | Python        | python/test.sh       |
code  | others | validation    | $python reference/validate.py --signorini $built/signorini |
code  | others | ledger        | python3 reference/ledger.py --short $built/signorini |
long  | others | before-after  | python3 reference/before_and_after.py --short $built/signorini $built/signorini | reference/before_and_after.py reference/jobs.py
long  | others | reference     | $python -m unittest discover --start-directory reference | reference
long  | others | schema        | $python reference/schema.py $built/signorini | reference/schema.py tests/wrong_scenes.json crates/mechanics/src/scene/input/schema
long  | others | site          | reference/book.sh    | reference/book.py reference/book.sh docs *.md */README.md
long  | others | pages         | pages                | reference/browser.py reference/pages.py reference/site_pages.py crates/output/src/page
long  | others | distributed   | distributed          | distributed crates/qp/src/petsc
long  | others | wheel         | python/wheel.sh      | python/wheel.sh python/pyproject.toml python/Cargo.toml
long  | others | release ledger | release_ledger      | reference/ledger.py tests/ledger.csv
"

rustdoc_as_errors() { RUSTDOCFLAGS="-D warnings" cargo doc --quiet --workspace --no-deps --all-features; }
features() {
    cargo clippy --quiet --no-default-features -- -D warnings
    cargo clippy --quiet --package signorini-qp --features faer,nalgebra -- -D warnings
    [ "$mode" = all ] || return 0
    cargo clippy --quiet --no-default-features --features pictures -- -D warnings
    for features in "" faer nalgebra; do cargo clippy --quiet --package signorini-qp --features "$features" -- -D warnings; done
}
# The tests that read pages.
tests_of_pages() {
    cargo test --quiet --workspace --all-features --test rules
    cargo test --quiet --workspace --all-features --test program -- guarantees:: tutorial::
    python/test.sh readme
}
example() { printf -- '-- %s\n' "$*"; "$built/examples/$1" "${@:2}"; }
lessons() {
    for lesson in two_springs one_scene find_the_contact_set many_gaps judge_an_answer bouncing_mass uniform_pressure; do example $lesson; done
}
studies() {
    example studies verification --short
    example studies extremes --most 100
    # Every version has inputs of its own: its digits are the seed.
    local seed
    seed=$(sed -n '/^version = /{s/[^0-9]//g;p;q}' Cargo.toml)
    for input in scene mesh matrix problem; do example studies fuzz $input 20000 "$seed"; done
    example studies fuzz exact 2000 "$seed"
    example studies contact_cost --only "Q4 64,Hex8 6" --rounds 1
    example studies multigrid --most-dofs 20000
    example studies impact
    example studies dynamic_cost --short
    for scene in examples/*.json; do "$built/signorini" compare "$scene" --out "$out/$(basename "$scene" .json)"; done
    for scene in studies/impact/*.json; do "$built/signorini" solve "$scene" --out "$out/$(basename "$scene" .json)"; done
    "$built/signorini" sweep examples/indentation.json --gaps -0.01:-0.10:10 --out "$out/sweep"
}
pages() { (cd reference && SIGNORINI=$built/signorini "$python" -m unittest pages site_pages); }
distributed() {
    local petsc tests
    petsc=$(petsc_python)
    # The options of PETSc are global to a process, so that each test file runs in a process of its own.
    for tests in distributed/tests/test_*.py; do
        SIGNORINI=$built/signorini "$petsc" -B -m unittest discover --start-directory distributed/tests --pattern "${tests##*/}"
    done
}
release_ledger() {
    env -u RUSTC_WORKSPACE_WRAPPER cargo build --quiet --release
    python3 reference/ledger.py "$CARGO_TARGET_DIR/release/signorini"
}

need() { "${@:2}" >/dev/null 2>&1 || { echo "test.sh needs $1" >&2; exit 1; }; }
need "cargo, of Rust: https://rustup.rs"                          cargo --version
need "rustfmt: rustup component add rustfmt"                      cargo fmt --version
need "clippy: rustup component add clippy"                        cargo clippy --version
need "python3, version 3.11 or later"                             python3 -c 'import sys; sys.exit(sys.version_info < (3, 11))'
need "venv of python3: on Debian apt-get install python3-venv"    python3 -c 'import ensurepip, venv'

mode=${1:-}
case $mode in "" | all | needs) ;; *) echo "usage: ./test.sh [all|needs]" >&2; exit 2 ;; esac
[ "$mode" != all ] || export SIGNORINI_LONG=${SIGNORINI_LONG:-fresh}
passed=$(cut -d' ' -f1 $kept 2>/dev/null || true)
git cat-file -e "$passed^{commit}" 2>/dev/null || passed=""
# Prints those of the given files that differ from the last full pass.
changed() { git diff --name-only "$passed" -- "$@"; git ls-files --others --exclude-standard -- "$@"; }
only_pages=""
if [ -n "$passed" ] && [ "$mode" != all ] && [ -n "$(changed '*.md' docs)" ] && [ -z "$(changed . ':!*.md' ':!docs' ":!$kept")" ]; then
    only_pages=yes
fi
# Succeeds if a step runs, given its class and the files that trigger it.
is_chosen() {
    case $1 in
        every) ;;
        code) [ -z "$only_pages" ] ;;
        pages) [ -n "$only_pages" ] ;;
        # shellcheck disable=SC2086
        long) [ "$mode" = all ] || [ -z "$passed" ] || [ -n "$(changed $2)" ] ;;
    esac
}
chosen=() left=()
while IFS='|' read -r class lane name command files; do
    read -r class <<<"$class"; read -r lane <<<"$lane"; read -r name <<<"$name"; read -r command <<<"$command"
    [ -n "$class" ] || continue
    if is_chosen "$class" "$files"; then chosen+=("$lane|$name|$command"); elif [ "$class" != pages ]; then left+=("$name"); fi
done <<<"$table"
runs() { [[ $'\n'"$(printf '%s\n' "${chosen[@]}")" == *"|$1|"* ]]; }

has_chromium() { (cd reference && python3 -B -c 'import browser; browser.found()') 2>/dev/null; }
# Prints the interpreter that has PETSc.
petsc_python() { (cd distributed && python3 -B -c 'import launch; print(launch.interpreter())') 2>/dev/null; }
# Sets `missing`, the packages of Debian that are not installed, and `skipped`, a line for each chosen step that cannot run without them.
look() {
    missing=() skipped=()
    lacks() { missing+=("${@:3}"); skipped+=("$1: there is no $2"); }
    ! runs pages || has_chromium || lacks pages Chromium chromium
    ! runs distributed || command -v mpirun >/dev/null || lacks distributed mpirun openmpi-bin
    ! runs distributed || petsc_python >/dev/null || lacks distributed petsc4py python3-petsc4py python3-numpy
    ! runs ledger && ! runs "release ledger" || command -v valgrind >/dev/null || lacks ledger valgrind valgrind
}
is_skipped() { [[ $'\n'"$(printf '%s\n' "${skipped[@]-}")" == *$'\n'"${1#release }: "* ]]; }
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
    [ "$mode" = needs ] && exit
    { apt update && apt install -y --no-install-recommends "${missing[@]}"; } || echo "apt-get failed" >&2
    look
fi
# Names the steps that do not run, and the last commit at which all of them passed.
tell_left_out() {
    [ ${#left[@]} -eq 0 ] || printf '== left out, because their files are as at the last full pass: %s\n' "$(printf '%s, ' "${left[@]}" | sed 's/, $//')"
    [ ${#skipped[@]} -eq 0 ] || printf '== skipped: %s\n' "${skipped[@]}"
    [ ${#skipped[@]} -eq 0 ] || echo "   INSTALL=1 ./test.sh installs by apt-get what these steps need: ${missing[*]}"
    if [ -n "$passed" ]; then echo "== all steps passed last at $(cat $kept)"; else echo "== no commit of this history is known at which all steps passed"; fi
}
if [ ${#skipped[@]} -gt 0 ] && [ "${SKIP:-}" = never ]; then
    tell_left_out
    echo "== failed: SKIP=never allows no skipped step" >&2
    exit 1
fi
[ "$mode" = needs ] && { tell_left_out; exit; }

out=$(mktemp -d)
# With job control each lane is a group of processes, which ends as a whole.
set -m
ended() {
    local job
    for job in $(jobs -p); do kill -- "-$job" 2>/dev/null || true; done
    rm -rf "$out"
}
trap ended EXIT
# Runs the chosen steps of a lane. The output of a step is shown when it ends; the first failure ends the lane.
run_lane() {
    local lane name command began code
    printf '%s\n' "${chosen[@]}" | while IFS='|' read -r lane name command; do
        [ "$lane" = "$1" ] && ! is_skipped "$name" || continue
        began=$SECONDS
        echo "== $name ..."
        set +e
        (set -e; eval "$command") >"$out/$1.log" 2>&1 </dev/null
        code=$?
        set -e
        cat "$out/$1.log"
        [ $code -eq 0 ] || { printf '\n== failed: %s\n' "$name" >&2; exit 1; }
        printf '%6d s  %s\n' $((SECONDS - began)) "$name" | tee -a "$out/seconds"
    done
}
# Packages are fetched while the crates are built.
reference/environment.sh &
environment=$!
run_lane first
wait $environment
run_lane tests &
run_lane others &
wait -n
wait -n

printf '\n== seconds of the steps\n%s\n%6d s  in all: %d minutes\n' "$(cat "$out/seconds")" $SECONDS $(((SECONDS + 30) / 60))
if [ "$mode" = all ] && [ ${#skipped[@]} -eq 0 ] && [ -z "$(git status --porcelain)" ]; then
    echo "$(git rev-parse HEAD) $(date +%F)" >$kept
fi
tell_left_out
if [ ${#skipped[@]} -gt 0 ]; then echo "== all other checks passed"; else echo "== all checks passed"; fi
