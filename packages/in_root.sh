#!/bin/bash
# Run a command in a copy of this checkout on another stack, in a root folder of its own: packages/in_root.sh STACK
# FOLDER COMMAND... As root; needs debootstrap. STACK is debian-12, debian-13, or wheel: there a user who is not root has
# git, make, Python with its headers and a C compiler, and no package of the distribution's finite elements.
# The root is made once in FOLDER, then used again; what the command leaves in results/ is there, too.
set -euo pipefail
cd "$(dirname "$0")/.."
# of the make that has called this; the root has its own
unset MAKEFLAGS MFLAGS MAKELEVEL MAKEOVERRIDES STACK PYTHON MPIRUN XDG_CACHE_HOME
export PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin
stack=$1 root=$2/$1
shift 2
case $stack in
    debian-12) suite=bookworm ;;
    debian-13 | wheel) suite=trixie ;;
    *) echo "in_root: no stack '$stack': debian-12, debian-13 or wheel" >&2 && exit 2 ;;
esac
((EUID == 0)) || { echo "in_root: only root may change the root folder" >&2 && exit 2; }
if ! command -v debootstrap > /dev/null; then
    DEBIAN_FRONTEND=noninteractive apt-get install --yes -qq --no-install-recommends debootstrap > /dev/null
fi

inside=$root/opt/bellowsx
if [[ ! -e $root/made ]]; then
    echo "in_root: making $root"
    rm -rf "$root"
    mkdir -p "$root"
    debootstrap --variant=minbase --include=ca-certificates "$suite" "$root" > "$root.log"
    # the package clients' settings and certificates
    cp /etc/resolv.conf "$root/etc/"
    [[ ! -e /etc/pip.conf ]] || cp /etc/pip.conf "$root/etc/"
    grep -ls Acquire /etc/apt/apt.conf.d/* | xargs -r cp -t "$root/etc/apt/apt.conf.d"
    cp /etc/ssl/certs/ca-certificates.crt "$root/etc/ssl/certs/"
    touch "$root/made"
fi
mkdir -p "$inside"
find "$inside" -mindepth 1 -maxdepth 1 ! -name .venv ! -name results -exec rm -rf {} +
git ls-files --cached --others --exclude-standard | while read -r file; do
    [[ ! -e $file ]] || printf '%s\0' "$file"
done | tar --create --null --files-from=- | tar --extract --no-same-owner --directory "$inside"

# What a container recipe runs, this runs; a user without root leaves the set-up to make.
mapfile -t steps < <(sed -n 's/^RUN //p' Containerfile)
if [[ $stack == wheel ]]; then
    steps=("${steps[0]} gcc libc6-dev python3-dev python3-venv")
    steps+=("id user > /dev/null 2>&1 || useradd --create-home user; chown -R user: .")
    # what gmsh and VTK ask of the system, as a cluster's login node has it
    steps+=("apt-get install --yes -qq --no-install-recommends libglu1-mesa libgl1 libxrender1 libxcursor1 libxft2 libxinerama1 libgomp1 libegl1 libgl1-mesa-dri")
    become=(setpriv --reuid=user --regid=user --clear-groups env HOME=/home/user)
else
    become=(env)
fi
# The mounts are of this process's own name space and vanish with it.
# shellcheck disable=SC2016
exec unshare --mount --propagation private bash -euo pipefail -c '
    root=$1 count=$2
    shift 2
    mount -t proc proc "$root/proc"
    mount --rbind /sys "$root/sys"
    mount --rbind /dev "$root/dev"
    mount -t tmpfs shm "$root/dev/shm"
    in_root() { chroot "$root" env --chdir=/opt/bellowsx "$@"; }
    for ((k = 0; k < count; k++)); do
        in_root bash -euo pipefail -c "$1" > "$root.log" 2>&1 || { tail -20 "$root.log"; exit 1; }
        shift
    done
    in_root "$@"
' in_root "$root" "${#steps[@]}" "${steps[@]}" "${become[@]}" "$@"
