#!/bin/bash
# Resolve packages/requirements.in into packages/requirements.txt: the whole closure, pinned.
# Everything is resolved as if nothing were installed, so that the result does not depend on
# which Python packages Debian happens to have on this machine; numpy and scipy are then left
# out again, because they are Debian's.
set -euo pipefail
cd "$(dirname "$0")/.."

report=$(mktemp)
trap 'rm -f "$report"' EXIT
.venv/bin/python -m pip install --quiet --dry-run --ignore-installed --report "$report" \
    --constraint packages/constraints.txt --requirement packages/requirements.in

.venv/bin/python - "$report" > packages/requirements.txt.new <<'PY'
import json
import re
import sys

with open(sys.argv[1], encoding="utf-8") as stream:
    found = [item["metadata"] for item in json.load(stream)["install"]]
pins = {re.sub(r"[-_.]+", "-", m["name"]).lower(): m["version"] for m in found}
print("# Written by `make lock` from requirements.in; do not edit. Installed with --no-deps.")
for name in sorted(pins.keys() - {"numpy", "scipy"}):
    print(f"{name}=={pins[name]}")
PY
mv packages/requirements.txt.new packages/requirements.txt
grep -c == packages/requirements.txt | sed 's/$/ packages pinned in packages\/requirements.txt/'
