#!/usr/bin/env bash
# Prints a table of the lines of the library that its tests run, and writes the missed lines to target/coverage.txt.
# Needs cargo-llvm-cov (cargo install cargo-llvm-cov) and llvm-cov of LLVM 19 or later: `rustup component add llvm-tools`, or
# LLVM_COV and LLVM_PROFDATA, as LLVM_COV=/usr/bin/llvm-cov-19 LLVM_PROFDATA=/usr/bin/llvm-profdata-19.
set -euo pipefail
cd "$(dirname "$0")/.."
# Incremental: otherwise short functions are compiled into every test, and count as missed in a test that does not call them.
export CARGO_INCREMENTAL=1 CARGO_PROFILE_RELEASE_INCREMENTAL=true
cargo llvm-cov clean --workspace
# If the program may not write, its counters cannot be written either.
cargo llvm-cov --workspace --exclude signorini-python --release --no-report --lib --bins --tests -- --skip a_failed_write
report() { cargo llvm-cov report --release --failure-mode all --ignore-filename-regex '/(tests|examples)/' "$@"; }
report --text --output-path target/coverage.txt
report | awk 'NR > 2 && NF > 9 { printf "%8s of %5d lines missed  %7s  %s\n", $9, $8, $10, $1 }' | sort -k6,6n
