#!/usr/bin/env bash
# Puts the package with the library that the tests of the workspace build into target/python, and runs all checks on it, in the
# environment of `reference/environment.sh`; `python/test.sh readme` only runs the Python lines of the README.
# `python/wheel.sh` builds and installs the wheel as a user does.
set -euo pipefail
cd "$(dirname "$0")"

root=$(cd .. && pwd)
export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-$root/target}
python=$CARGO_TARGET_DIR/venv/bin/python
"$root/reference/environment.sh"

# An example is asked for because dependencies then have the features that the tests give them: nothing is compiled twice.
cargo build --quiet --locked --workspace --all-features --lib --example two_springs
package=$CARGO_TARGET_DIR/python
rm -rf "$package"
mkdir -p "$package"
cp -r package/signorini "$package/"
cp "$CARGO_TARGET_DIR/debug/lib_signorini.so" "$package/signorini/_signorini.abi3.so"

# Types are checked beside the tests.
types() {
    # The module of torch cannot be imported where torch is not installed.
    "$python" -m mypy.stubtest --concise --mypy-config-file pyproject.toml signorini \
        --allowlist <(echo signorini.torch) --ignore-unused-allowlist
    "$python" -m mypy --no-error-summary --cache-dir "$CARGO_TARGET_DIR/mypy" -p signorini
}
if [ "${1:-}" != readme ]; then
    types &
    "$python" -m pytest --quiet -p no:cacheprovider tests
    wait $!
fi
# The Python lines of the README.
sed -n '/^```python$/,/^```$/{/^```/!p}' "$root/README.md" | (cd / && "$python" -)
echo "the Python package: all checks passed"
