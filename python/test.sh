#!/usr/bin/env bash
# Puts the package with the library that the tests of the workspace build into target/python, and runs all checks on it.
# Needs cargo and python3 >= 3.11 with venv. `.ci/run` builds and installs the wheel as a user does.
set -euo pipefail
cd "$(dirname "$0")"

root=$(cd .. && pwd)
export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-$root/target}
environment=$CARGO_TARGET_DIR/python-venv
stamp=$environment/requirements.stamp
if ! cmp -s requirements.txt "$stamp"; then
    python3 -m venv --clear "$environment"
    "$environment/bin/python" -m pip install --quiet --disable-pip-version-check --requirement requirements.txt
    # This is the last step, so that an interrupted installation is repeated.
    cp requirements.txt "$stamp"
fi

# An example is asked for because dependencies then have the features that the tests give them: nothing is compiled twice.
cargo build --quiet --locked --workspace --all-features --lib --example two_springs
package=$CARGO_TARGET_DIR/python
rm -rf "$package"
mkdir -p "$package"
cp -r package/signorini "$package/"
cp "$CARGO_TARGET_DIR/debug/lib_signorini.so" "$package/signorini/_signorini.abi3.so"
echo "$package" > "$("$environment/bin/python" -c 'import site; print(site.getsitepackages()[0])')/signorini.pth"

"$environment/bin/python" -m pytest --quiet -p no:cacheprovider tests
# The module of torch cannot be imported where torch is not installed.
"$environment/bin/python" -m mypy.stubtest --concise --mypy-config-file pyproject.toml signorini \
    --allowlist <(echo signorini.torch) --ignore-unused-allowlist
"$environment/bin/python" -m mypy --no-error-summary --cache-dir "$CARGO_TARGET_DIR/mypy" -p signorini
# The Python lines of the README.
sed -n '/^```python$/,/^```$/{/^```/!p}' "$root/README.md" | (cd / && "$environment/bin/python" -)
echo "the Python package: all checks passed"
