#!/bin/sh
# Makes the site of the documents: target/book/site/index.html. Needs cargo, and python3 >= 3.11 with venv.
# The first time it installs mdBook, which makes the pages, into target/.
set -eu

root=$(cd "$(dirname "$0")/.." && pwd)
target=${CARGO_TARGET_DIR:-$root/target}
mdbook=0.5.4

# Without optimisation mdBook is built in a third of the time, and is as quick on these pages.
cargo install --quiet --locked --debug mdbook --version $mdbook --no-default-features --features search --root "$target/mdbook" \
    --target-dir "$target/mdbook/build"
"$root/reference/environment.sh"
exec "$target/venv/bin/python" "$root/reference/book.py" --mdbook "$target/mdbook/bin/mdbook" --out "$target/book"
