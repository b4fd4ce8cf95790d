#!/bin/bash
# Make everything ready, or find that it already is: the distribution's packages where the stack has them, then .venv.
# Usage: packages/setup.sh STACK STAMP. STACK: debian-12, debian-13 or wheel (packages/stack.sh). STAMP is a file inside
# .venv whose name carries the hash of the lists (see the Makefile); it is written last, so an interrupted set-up is
# simply done again.
set -euo pipefail
cd "$(dirname "$0")/.."
stack=$1 stamp=$2
lock=packages/stacks/$stack.txt

stop() {
    echo "setup: $*" >&2
    exit 1
}

[[ -e $lock ]] || stop "no stack '$stack': take one of $(cd packages/stacks && echo *.txt | sed 's/\.txt//g; s/ /, /g')"

# --- the interpreter, and Debian's packages -----------------------------------------------------
if [[ $stack == wheel ]]; then
    [[ $(uname -m) == x86_64 ]] || stop "the wheel stack is for x86_64, this is $(uname -m); Debian 12 and 13 have dolfinx for it"
    glibc=$(getconf GNU_LIBC_VERSION 2> /dev/null | cut -d' ' -f2 || true)
    [[ -n $glibc && $(printf '%s\n' 2.34 "$glibc" | sort -V | head -1) == 2.34 ]] ||
        stop "the wheel stack needs glibc 2.34 or later (Debian 12, Ubuntu 22.04, RHEL 9), this has ${glibc:-another C library}"
    if ! why=$(packages/python.sh 2>&1 > /dev/null); then
        stop "the wheel stack needs Python 3.12 or later with venv, pip and headers, and none was found. ${why:+$why. }
Get one without root from python.org's sources, pyenv or conda, on a cluster by 'module load python', then:
    make setup STACK=wheel PYTHON=/path/to/python3.12"
    fi
    command -v gcc > /dev/null || command -v cc > /dev/null ||
        stop "no C compiler (gcc), with which dolfinx compiles its forms: ask for gcc, on a cluster 'module load gcc'"
    python=$(packages/python.sh 2> /dev/null)
else
    # Debian's packages are for /usr/bin/python3 alone
    python=/usr/bin/python3
    [[ $(packages/system.sh) == "$stack" ]] || stop "this is not $stack but $(packages/system.sh): make setup STACK=wheel"
    read -ra missing <<< "$(packages/missing.sh)"
    if ((${#missing[@]})); then
        install=(apt-get install --yes --no-install-recommends "${missing[@]}")
        if ((EUID != 0)); then
            {
                echo "setup: nothing was installed: ${#missing[@]} Debian packages are missing and you are not root. Either let root run"
                echo
                echo "    apt-get update && ${install[*]}"
                echo
                echo "or do without root: with a Python 3.12 or later (python.org's sources, pyenv, conda, 'module load python'),"
                echo "its headers and gcc, everything comes from PyPI into .venv:"
                echo
                echo "    make setup STACK=wheel PYTHON=/path/to/python3.12"
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
fi

# --- .venv --------------------------------------------------------------------------------------
if [[ -e $stamp ]]; then
    echo "setup: all there (stack $stack)"
    exit 0
fi

if [[ -e .venv && ($(cat .venv/stack 2> /dev/null) != "$stack" || $(readlink -f .venv/bin/python) != "$(readlink -f "$python")") ]]; then
    echo "setup: .venv belongs to another stack or Python, making it anew"
    rm -rf .venv
fi
if [[ ! -e .venv/bin/pip ]]; then
    [[ $stack == wheel ]] && sight=() || sight=(--system-site-packages)
    "$python" -m venv ${sight[@]+"${sight[@]}"} .venv
fi
echo "$stack" > .venv/stack

echo "setup: installing $(grep -c == "$lock") Python packages into .venv (about 1 GB)"
pip=(.venv/bin/python -m pip --disable-pip-version-check)
# --no-deps: the list is the whole closure; nothing may be resolved into a second numpy.
"${pip[@]}" install --quiet --no-deps --requirement "$lock"
"${pip[@]}" install --quiet --no-deps --no-build-isolation --editable .

if [[ $stack == debian-12 ]]; then
    # The form compiler runs distutils at every new form. setuptools puts its own in the standard one's
    # place, which writes each compiler call to the log on stderr; keep the standard one, in any process.
    # (The name makes it read before setuptools' own .pth.)
    site=$(.venv/bin/python -c 'import sysconfig; print(sysconfig.get_path("purelib"))')
    echo 'import os; os.environ.setdefault("SETUPTOOLS_USE_DISTUTILS", "stdlib")' > "$site/a_stdlib_distutils.pth"
fi

rm -f .venv/setup-*
touch "$stamp"
echo "setup: done (stack $stack)"
