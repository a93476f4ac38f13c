#!/usr/bin/env bash
# container_test.sh SOURCE PACKAGES WORK: the steps of tools/Containerfile in a bare Debian, without a builder of containers:
# the copied files, the commands, and the entry point, which records and checks a project. Exit status 77: no bare Debian can
# be made here.
set -euo pipefail
source=$1 packages=$2 work=$3
# shellcheck source=tests/install/bare.sh
source "$(dirname "$0")/bare.sh"
file=$source/tools/Containerfile
instructions() { sed -n "s/^$1 //p" "$file"; }
[[ $(instructions FROM) == debian:12-slim ]] || { echo "the Containerfile isn't that of Debian 12"; exit 1; }
make_bare "$work"
root=$work/root

read -ra words <<< "$(instructions COPY)"
destination=${words[-1]}
mkdir -p "$root$destination"
shopt -s nullglob
for pattern in "${words[@]::${#words[@]}-1}"; do
  # shellcheck disable=SC2206  # a pattern
  files=("$packages"/$pattern)
  ((${#files[@]} == 1)) || { echo "$pattern is ${#files[@]} of the packages"; exit 1; }
  cp "${files[0]}" "$root$destination"
done
entry=$(instructions ENTRYPOINT | jq --raw-output 'join(" ")')
{
  echo 'set -euo pipefail; export DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8'
  echo "{ $(instructions RUN); } > /log 2>&1 || { tail -n 30 /log; exit 1; }"
  echo "mkdir -p '$(instructions WORKDIR)'; cd '$(instructions WORKDIR)'"
  echo "$entry $(instructions CMD | jq --raw-output 'join(" ")') > /log; grep -q '^Usage: rehearse' /log"
  echo "$entry new . 2> /dev/null || { $entry new arm > /log 2>&1; cd arm; }"
  echo 'cmake -S . -B build > /log && cmake --build build > /log'
  echo "REHEARSE_GOLDEN=new $entry check"
  echo "$entry check"
  echo "if [[ -e $destination ]] || ls /var/lib/apt/lists/*Packages* 2> /dev/null; then echo 'the image has files of its making'; exit 1; fi"
} > "$root/inside"
run_in_bare "$root" /inside
