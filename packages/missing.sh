#!/bin/bash
# Print the packages of debian.txt that are not installed, on one line.
cd "$(dirname "$0")" || exit
missing=()
for package in $(sed 's/#.*//' debian.txt | xargs); do
    status=$(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2> /dev/null || true)
    # a Multi-Arch package may answer once per architecture
    [[ $status == *installed* && $status != *not-installed* ]] || missing+=("$package")
done
echo "${missing[*]}"
