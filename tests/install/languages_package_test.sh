#!/usr/bin/env bash
# languages_package_test.sh PACKAGES WORK: goes the way of a new user in C and in Rust in a bare Debian 12: the project that
# `rehearse new` writes, its golden, a red test, an accepted change. package_test.sh goes it in C++, python_package_test.sh
# in Python. Exit status 77: no bare Debian can be made here.
set -euo pipefail

packages=$1 work=$2
root=$work/root
# shellcheck source=tests/install/bare.sh
source "$(dirname "$0")/bare.sh"
make_bare "$work"
mkdir "$root/packages"
cp "$packages"/rehearse_*.deb "$packages"/rehearse-dev_*.deb "$root/packages/"
readme=$(dirname "$0")/../../README.md
sed -n 's|^sudo apt-get install \(.*\) ./build/packages/.*|\1|p' "$readme" > "$root/compiler"

cat > "$root/inside" << 'INSIDE'
set -euo pipefail
export DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8
apt-get update > /log 2>&1
apt-get install --yes --no-install-recommends cargo $(cat /compiler) /packages/*.deb > /log 2>&1 || { tail -n 30 /log; exit 1; }
mkdir /home/new
way_of_a_newcomer() { # LANGUAGE SOURCE
  local began=$SECONDS
  cd /home/new
  rehearse new --language "$1" "in_$1" > /steps
  sed -n '/^  cd /,$p' /steps > /commands
  grep -q ctest /commands
  bash -e /commands > /log 2>&1 || { tail -n 40 /log; exit 1; }
  grep "100% tests passed" /log
  cd "in_$1"
  sed -i 's/= 60.0/= 59.0/' "$2"
  cmake --build build > /log 2>&1 || { tail -n 40 /log; exit 1; }
  if ctest --test-dir build > /log 2>&1; then echo "a weaker controller in $1 passes"; exit 1; fi
  if rehearse check > /verdict; then echo "a weaker controller in $1 passes check"; exit 1; fi
  grep "the controller changed" /verdict
  rehearse golden accept --all
  sed -i 's/-6.0, 1e-12/-5.9, 1e-12/' hold_test.cpp
  cmake --build build > /log 2>&1 || { tail -n 40 /log; exit 1; }
  ctest --test-dir build --output-on-failure > /log 2>&1 || { tail -n 40 /log; exit 1; }
  echo "$1: from nothing to an accepted change in $((SECONDS - began)) s"
}
way_of_a_newcomer c hold.c
way_of_a_newcomer rust src/lib.rs
INSIDE
run_in_bare "$root" /inside
