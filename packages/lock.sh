#!/bin/bash
# Resolve packages/requirements.in with each packages/stacks/STACK.in into STACK.txt: the whole closure, pinned.
# Everything is resolved for the stack's Python as if nothing were installed, so that the result does not depend on this
# machine; on the Debian stacks numpy and scipy are then left out again, because they are Debian's.
set -euo pipefail
cd "$(dirname "$0")/.."

trash=$(mktemp -d)
report=$trash/report.json
trap 'rm -rf "$trash"' EXIT
resolve() { # STACK, Python version, pip's interpreter
    "$3" -m pip install --quiet --dry-run --ignore-installed --report "$report" --target unused \
        --python-version "$2" --only-binary=:all: \
        --requirement packages/requirements.in --requirement "packages/stacks/$1.in"
    .venv/bin/python - "$report" "$1" > "packages/stacks/$1.txt.new" << 'PY'
import json
import re
import sys

report, stack = sys.argv[1:]
with open(report, encoding="utf-8") as stream:
    found = [item["metadata"] for item in json.load(stream)["install"]]
pins = {re.sub(r"[-_.]+", "-", m["name"]).lower(): m["version"] for m in found}
print("# Written by `make lock` from requirements.in; do not edit. Installed with --no-deps.")
for name in sorted(pins.keys() - ({"numpy", "scipy"} if stack.startswith("debian") else set())):
    print(f"{name}=={pins[name]}")
PY
    mv "packages/stacks/$1.txt.new" "packages/stacks/$1.txt"
    echo "$(grep -c == "packages/stacks/$1.txt") packages pinned in packages/stacks/$1.txt"
}
resolve debian-12 3.11 .venv/bin/python
resolve debian-13 3.13 .venv/bin/python
# Debian 12's pip cannot look at packages that only later Pythons may install
"$(packages/python.sh)" -m venv "$trash/venv"
resolve wheel 3.12 "$trash/venv/bin/python" # all have wheels for 3.13 and 3.14 too
