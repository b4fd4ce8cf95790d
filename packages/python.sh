#!/bin/bash
# Print a Python that the wheel stack can stand on: 3.12 or later, with venv, pip and its headers, which the form
# compiler needs. PYTHON=/path/to/python names one. If there is none, says on stderr what those found lack and exits with 1.
found=()
if [[ -n ${PYTHON:-} ]]; then
    candidates=("$PYTHON")
else
    candidates=(python3.12 python3.13 python3.14 python3 "${PYENV_ROOT:-$HOME/.pyenv}"/versions/3.1[2-9]*/bin/python3)
fi
for candidate in "${candidates[@]}"; do
    path=$(command -v "$candidate") || continue
    lacks=$("$path" - 2> /dev/null << 'END'
import importlib.util, os, sys, sysconfig
if sys.version_info < (3, 12):
    print("3.12 or later")
elif not importlib.util.find_spec("ensurepip"):
    print("venv with pip (Debian: python3-venv)")
elif not os.path.exists(os.path.join(sysconfig.get_path("include"), "Python.h")):
    print("its headers, Python.h (Debian: python3-dev, Fedora: python3-devel)")
else:
    print("nothing")
END
    ) || continue
    if [[ $lacks == nothing ]]; then
        echo "$path"
        exit
    fi
    version=$("$path" -c 'import platform; print(platform.python_version())')
    found+=("$path is Python $version and lacks: $lacks")
done
printf '%s\n' ${found[@]+"${found[@]}"} >&2
exit 1
