#!/bin/sh
# Makes the site of the documents: target/book/site/index.html. Needs cargo, and python3 >= 3.11 with venv.
# The first time it installs mdBook, which makes the pages, and latex2mathml, which makes the formulas, into target/ (about four minutes).
set -eu

root=$(cd "$(dirname "$0")/.." && pwd)
target=${CARGO_TARGET_DIR:-$root/target}
mdbook=0.5.4
latex2mathml=3.81.1

cargo install --quiet --locked mdbook --version $mdbook --no-default-features --features search --root "$target/mdbook" \
    --target-dir "$target/mdbook/build"
environment=$target/book-venv
if ! "$environment/bin/python" -m pip show latex2mathml 2>/dev/null | grep -q "^Version: $latex2mathml$"; then
    python3 -m venv --clear "$environment"
    "$environment/bin/python" -m pip install --quiet --disable-pip-version-check latex2mathml==$latex2mathml
fi
exec "$environment/bin/python" "$root/reference/book.py" --mdbook "$target/mdbook/bin/mdbook" --out "$target/book"
