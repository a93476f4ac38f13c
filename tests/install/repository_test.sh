#!/usr/bin/env bash
# repository_test.sh SOURCE PACKAGES WORK: makes an apt repository of the packages, twice, and compares the bytes. A bare
# Debian installs from it, by file: and from a web server, and refuses it after a change. Exit status 77: no bare Debian can
# be made here.
set -euo pipefail
source=$1 packages=$2 work=$3
# shellcheck source=tests/install/bare.sh
source "$(dirname "$0")/bare.sh"
make_bare "$work"
root=$work/root
begin_repository "$source" "$packages"

make_repository "$scratch/first"
sleep 1
make_repository "$scratch/second" > /dev/null
diff --recursive "$scratch/first" "$scratch/second" || { echo "the same packages give other bytes"; exit 1; }
make_repository "$scratch/first" > /dev/null || { echo "the same packages can't be added twice"; exit 1; }
package=$(basename "$(ls "$scratch"/first/pool/rehearse-dev_*.deb)")
echo >> "$scratch/second/pool/$package"
if make_repository "$scratch/second" > /dev/null 2> "$scratch/refusal"; then
  echo "a package with other bytes replaces a published one"
  exit 1
fi
grep "is there with other bytes" "$scratch/refusal"

make_repository "$root/repository" "Test of Rehearse"
cp "$root/repository/rehearse.asc" "$root/etc/apt/keyrings/" 2> /dev/null \
  || install -D "$root/repository/rehearse.asc" "$root/etc/apt/keyrings/rehearse.asc"
serve "$root/repository" "$root/port"

cat > "$root/inside" << 'INSIDE'
set -euo pipefail
export DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8
list=/etc/apt/sources.list.d/rehearse.list
apt-get update > /log 2>&1
for url in file:/repository "http://127.0.0.1:$(cat /port)"; do
  echo "deb [signed-by=/etc/apt/keyrings/rehearse.asc] $url stable main" > "$list"
  began=$SECONDS
  apt-get -o Acquire::http::Proxy::127.0.0.1=DIRECT update > /log 2>&1 || { tail -n 20 /log; exit 1; }
  if grep "^[WE]:" /log; then exit 1; fi
  apt-get -o Acquire::http::Proxy::127.0.0.1=DIRECT install --yes --no-install-recommends rehearse rehearse-dev > /log 2>&1 \
    || { tail -n 20 /log; exit 1; }
  rehearse --version
  apt-cache policy rehearse | grep -F "$url"
  echo "installed from $url in $((SECONDS - began)) s"
  apt-get purge --yes rehearse rehearse-dev > /log 2>&1
  apt-get clean
done
# a change behind the signature
echo "deb [signed-by=/etc/apt/keyrings/rehearse.asc] file:/repository stable main" > "$list"
sed -i 's/^Description:/Description: changed/' /repository/dists/stable/main/binary-*/Packages
rm /repository/dists/stable/main/binary-*/Packages.gz
rm -rf /var/lib/apt/lists/*repository*
if apt-get update > /log 2>&1 && ! grep "^[WE]:" /log; then
  echo "apt takes a changed index"
  exit 1
fi
grep -m 1 "^[WE]:" /log
INSIDE
run_in_bare "$root" /inside
