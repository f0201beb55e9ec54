#!/usr/bin/env bash
# Builds the wheel of the Python package, target/wheels/signorini-*.whl, and installs it in a new environment without Rust; there the
# Python lines of the README must run. Needs cargo, and python3 >= 3.11 with venv.
#
#   python/wheel.sh            in the profile of the tests, whose crates it shares as far as their features are the same
#   python/wheel.sh release    as `pip install ./python` does
set -euo pipefail
cd "$(dirname "$0")/.."
export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-$PWD/target}
wheels=$CARGO_TARGET_DIR/wheels
environment=$(mktemp -d)
trap 'rm -rf "$environment"' EXIT

rm -rf "$wheels"
export MATURIN_PEP517_ARGS="--profile ${1:-dev}"
python3 -m venv "$environment/build"
"$environment/build/bin/python" -m pip wheel --quiet --disable-pip-version-check --no-deps --wheel-dir "$wheels" ./python
wheel=$(echo "$wheels"/signorini-*.whl)
case $wheel in *-cp311-abi3-*) ;; *) echo "$wheel is not for the stable ABI of Python 3.11" >&2; exit 1 ;; esac
du -h "$wheel"

python3 -m venv "$environment/use"
lines=$(sed -n '/^```python$/,/^```$/{/^```/!p}' README.md)
PATH=$(printf %s "$PATH" | tr : '\n' | while read -r folder; do [ -x "$folder/cargo" ] || printf '%s:' "$folder"; done)
if command -v cargo rustc; then echo "Rust is still at hand, so that this proves nothing" >&2; exit 1; fi
cd /
TIMEFORMAT="%R s: pip install of the wheel, with numpy"
time "$environment/use/bin/python" -m pip install --quiet --disable-pip-version-check "$wheel"
TIMEFORMAT="%R s: the first certified answer, with the import of numpy"
time "$environment/use/bin/python" -c "$lines"
