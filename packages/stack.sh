#!/bin/bash
# Print the stack this checkout stands on: debian-12, debian-13 or wheel. That of .venv if there is one; else the
# distribution's packages where they are, or can be installed, and the wheel everywhere else.
cd "$(dirname "$0")/.." || exit
if [[ -e .venv/stack ]]; then
    cat .venv/stack
    exit
fi
system=$(packages/system.sh)
case $system in
    debian-12 | debian-13)
        if ((EUID == 0)) || [[ -z $(packages/missing.sh) ]] || ! packages/python.sh > /dev/null 2>&1; then
            echo "$system"
            exit
        fi
        ;;
esac
echo wheel
