#!/bin/bash
# Print what Linux this is, for instance debian-12.
[[ ! -r /etc/os-release ]] || . /etc/os-release
echo "${ID:-unknown}-${VERSION_ID:-}"
