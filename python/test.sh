#!/usr/bin/env bash
# Builds the wheel of the Python package into target/wheels with the profile of the tests, installs it into environments
# below target/, and runs all checks. Needs cargo and python3 >= 3.11 with venv.
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

wheels=$CARGO_TARGET_DIR/wheels
rm -rf "$wheels"
"$environment/bin/maturin" build --quiet --locked --profile dev --features as-tests --out "$wheels"
install() { "$1/bin/python" -m pip install --quiet --disable-pip-version-check --force-reinstall "${@:2}" "$wheels"/*.whl; }
install "$environment" --no-deps

"$environment/bin/python" -m pytest --quiet -p no:cacheprovider tests
"$environment/bin/python" -m mypy.stubtest --concise --mypy-config-file pyproject.toml signorini
"$environment/bin/python" -m mypy --no-error-summary --cache-dir "$CARGO_TARGET_DIR/mypy" -p signorini

# The Python lines of the README, in an environment with only the wheel and numpy.
empty=$CARGO_TARGET_DIR/empty-venv
python3 -m venv --clear "$empty"
install "$empty"
sed -n '/^```python$/,/^```$/{/^```/!p}' "$root/README.md" | (cd / && "$empty/bin/python" -)
echo "the Python package: all checks passed"
