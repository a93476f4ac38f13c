#!/usr/bin/env bash
# main_packages_test.sh SOURCE BUILD: the packages of `tools/setup main`, and those on which they depend, contain every
# header that the command and its libraries include. Exit status 77: apt has no lists of packages here.
set -euo pipefail

source=$1 build=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
skip() { echo "skipped: $*"; exit 77; }

packages=$(sed -n '/^main_packages="/,/^"/p' "$source/tools/setup" | sed '1d; $d; s/#.*//')
touch "$work/nothing_installed"
# shellcheck disable=SC2086
apt-get --simulate --no-install-recommends -o Dir::State::status="$work/nothing_installed" install $packages \
  > "$work/simulation" 2> "$work/errors" || skip "$(tail -n 1 "$work/errors")"
awk '$1 == "Inst" { print $2 }' "$work/simulation" | sort -u > "$work/installed"

cd "$build"
ninja -t inputs rehearse_installed SR1MinimumController | grep '\.o$' | xargs ninja -t deps \
  | sed -n 's|^ *\(/usr/.*\)|\1|p' | xargs realpath | sort -u > "$work/headers"
[[ -s $work/headers ]] || { echo "ninja knows no header: is everything built?"; exit 1; }
xargs dpkg --search < "$work/headers" | sed 's/: .*//; s/:[a-z0-9]*$//' | sort -u > "$work/needed"
comm -23 "$work/needed" "$work/installed" > "$work/missing"
echo "$(wc -l < "$work/headers") headers of $(wc -l < "$work/needed") packages, $(wc -l < "$work/installed") installed"
[[ ! -s $work/missing ]] || { echo "not installed by tools/setup main: $(paste -sd ' ' "$work/missing")"; exit 1; }
