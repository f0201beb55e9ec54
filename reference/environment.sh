#!/bin/sh
# Creates target/reference-venv with the pinned packages and the Python package that python/test.sh builds.
# Parts that are already up to date are not installed again. Needs python3 >= 3.11.
set -eu

root=$(cd "$(dirname "$0")/.." && pwd)
environment="$root/target/reference-venv"
requirements="$root/reference/requirements.txt"
stamp="$environment/stamp"
install() { "$environment/bin/python" -m pip install --quiet --disable-pip-version-check "$@"; }

if ! python3 -c 'import sys; sys.exit(sys.version_info < (3, 11))'; then
    echo "the reference validation needs python3, version 3.11 or later" >&2
    exit 1
fi
package="${CARGO_TARGET_DIR:-$root/target}/python"
[ -e "$package" ] || { echo "the reference validation needs the Python package: python/test.sh builds it" >&2; exit 1; }
# The stamp is written last, so that an interrupted installation is repeated.
if ! cmp -s "$requirements" "$stamp"; then
    mkdir -p "$root/target"
    python3 -m venv --clear "$environment"
    install --requirement "$requirements"
    cp "$requirements" "$stamp"
fi
echo "$package" > "$("$environment/bin/python" -c 'import site; print(site.getsitepackages()[0])')/signorini.pth"
