#!/bin/sh
# Creates target/venv, the one environment of all Python checks, with the pinned packages, by uv. Parts that are already up to date are not
# installed again. Needs python3 >= 3.11 with venv.
set -eu

root=$(cd "$(dirname "$0")/.." && pwd)
target=${CARGO_TARGET_DIR:-$root/target}
environment=$target/venv
requirements="$root/python/requirements.txt $root/reference/requirements.txt"
uv=0.13.9

if ! python3 -c 'import sys; sys.exit(sys.version_info < (3, 11))'; then
    echo "the Python checks need python3, version 3.11 or later" >&2
    exit 1
fi
# shellcheck disable=SC2086
if ! cat $requirements | cmp -s - "$environment/stamp"; then
    mkdir -p "$target"
    python3 -m venv --clear "$environment"
    "$environment/bin/python" -m pip install --quiet --disable-pip-version-check uv==$uv
    # pip reads settings, as of a mirror, that uv does not know.
    set -- $(printf -- '--requirement %s ' $requirements)
    "$environment/bin/uv" pip install --quiet --python "$environment/bin/python" "$@" \
        || "$environment/bin/python" -m pip install --quiet --disable-pip-version-check "$@"
    # This is the last step, so that an interrupted installation is repeated.
    cat $requirements > "$environment/stamp"
fi
# python/test.sh puts the package there.
echo "$target/python" > "$("$environment/bin/python" -c 'import site; print(site.getsitepackages()[0])')/signorini.pth"
