#!/bin/sh
# Builds wheel and sdist of a checkout twice, from two copies, and fails unless both give the same bytes.
# Usage: .ci/release.sh OUT [PYTHON]; the Python has build and hatchling:
# pip install --require-hashes --no-deps -r .ci/build.lock
set -eu
out=$(mkdir -p "$1" && cd "$1" && pwd)
python=${2:-python3}
top=$(cd "$(dirname "$0")/.." && pwd)
room=$(mktemp -d)
trap 'rm -rf "$room"' EXIT
# The time of the commit stands for every file, so that a build does not depend on when or where it is made.
SOURCE_DATE_EPOCH=$(git -C "$top" log -1 --format=%ct)
export SOURCE_DATE_EPOCH
for copy in first second; do
    mkdir "$room/$copy"
    git -C "$top" archive HEAD | tar -x -C "$room/$copy"
    cp "$top"/plcgen/workbench/serve/page/codemirror.* "$room/$copy/plcgen/workbench/serve/page" 2>/dev/null ||
        echo "without the editor of plcgen serve: make editor comes first" >&2
    "$python" -m build --no-isolation --outdir "$room/$copy/dist" "$room/$copy" >"$room/$copy.log" 2>&1 ||
        { cat "$room/$copy.log" >&2; exit 1; }
done
for built in "$room"/first/dist/*; do
    cmp "$built" "$room/second/dist/$(basename "$built")"
done
cp "$room"/first/dist/* "$out"
cd "$out"
sha256sum plcgen-*.whl plcgen-*.tar.gz | tee SHA256SUMS
