#!/bin/bash
# Make everything ready, or find that it already is: Debian's packages, then .venv.
# Usage: packages/setup.sh STAMP. STAMP is a file inside .venv whose name carries the hash of the
# lists (see the Makefile); it is written last, so an interrupted set-up is simply done again.
set -euo pipefail
cd "$(dirname "$0")/.."
stamp=$1

# --- Debian ---------------------------------------------------------------------------------
mapfile -t wanted < <(sed 's/#.*//' packages/debian.txt | xargs -n1)
if ! command -v dpkg-query apt-get > /dev/null; then
    echo "setup: this needs Debian 12 (no dpkg/apt here)" >&2
    exit 1
fi
missing=()
for package in "${wanted[@]}"; do
    status=$(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2> /dev/null || true)
    # a Multi-Arch package may answer once per architecture
    [[ $status == *installed* && $status != *not-installed* ]] || missing+=("$package")
done

if ((${#missing[@]})); then
    install=(apt-get install --yes --no-install-recommends "${missing[@]}")
    if ((EUID != 0)); then
        {
            echo "setup: Debian packages are missing (${#missing[@]}) and you are not root. Run this, then make setup again:"
            echo
            echo "    sudo apt-get update && sudo ${install[*]}"
            echo
        } >&2
        exit 1
    fi
    echo "setup: installing from Debian: ${missing[*]}"
    export DEBIAN_FRONTEND=noninteractive
    # An unreachable third-party list must not stop us; if it was Debian's own, the install fails.
    apt-get update -qq || echo "setup: apt-get update failed, trying with the lists at hand" >&2
    # (errors are on stderr; the rest is a thousand lines of unpacking)
    "${install[@]:0:2}" -qq -o DPkg::Lock::Timeout=300 -o Dpkg::Use-Pty=0 "${install[@]:2}" > /dev/null
fi

# --- Python ---------------------------------------------------------------------------------
if [[ -e $stamp ]]; then
    echo "setup: all there (${#wanted[@]} Debian packages, .venv)"
    exit 0
fi

# Debian's packages are for /usr/bin/python3 alone; a .venv of another interpreter is of no use.
if [[ -e .venv && $(readlink -f .venv/bin/python) != "$(readlink -f /usr/bin/python3)" ]]; then
    echo "setup: .venv belongs to another Python, making it anew"
    rm -rf .venv
fi
[[ -e .venv/bin/pip ]] || /usr/bin/python3 -m venv --system-site-packages .venv

echo "setup: installing $(grep -c == packages/requirements.txt) Python packages into .venv (about 0.8 GB)"
pip=(.venv/bin/python -m pip --disable-pip-version-check)
# --no-deps: the list is the whole closure; nothing may be resolved into a second numpy.
"${pip[@]}" install --quiet --no-deps --requirement packages/requirements.txt
"${pip[@]}" install --quiet --no-deps --no-build-isolation --editable .

# The form compiler runs distutils at every new form. setuptools puts its own in the standard one's
# place, which writes each compiler call to the log on stderr; keep the standard one, in any process.
# (The name makes it read before setuptools' own .pth.)
site=$(.venv/bin/python -c 'import sysconfig; print(sysconfig.get_path("purelib"))')
echo 'import os; os.environ.setdefault("SETUPTOOLS_USE_DISTUTILS", "stdlib")' > "$site/a_stdlib_distutils.pth"

rm -f .venv/setup-*
touch "$stamp"
echo "setup: done"
