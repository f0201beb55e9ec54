#!/bin/sh
# Creates target/reference-venv with the pinned packages; does nothing when it is there already. Needs python3 >= 3.11.
set -eu

root=$(cd "$(dirname "$0")/.." && pwd)
environment="$root/target/reference-venv"
requirements="$root/reference/requirements.txt"
stamp="$environment/requirements.stamp"

if [ -x "$environment/bin/python" ] && cmp -s "$requirements" "$stamp"; then
    exit 0
fi
if ! python3 -c 'import sys; sys.exit(sys.version_info < (3, 11))'; then
    echo "the reference validation needs python3, version 3.11 or later" >&2
    exit 1
fi
mkdir -p "$root/target"
python3 -m venv --clear "$environment"
"$environment/bin/python" -m pip install --quiet --disable-pip-version-check --requirement "$requirements"
# Last, so that an installation that was cut short is made again.
cp "$requirements" "$stamp"
