#!/usr/bin/env bash
# package_test.sh PACKAGES WORK: installs the Debian packages into a bare Debian 12, where no checkout and no build tree
# are, and goes the way of a new user there: the commands of the README, those that `rehearse new` prints, an accepted
# change, the steps of the new project's workflow. It measures what apt fetches, and the time. Then it removes the packages
# and looks for what they left. Exit status 77: no bare Debian can be made here.
set -euo pipefail

packages=$1 work=$2
root=$work/root
# shellcheck source=tests/install/bare.sh
source "$(dirname "$0")/bare.sh"
make_bare "$work"
mkdir "$root/packages"
cp "$packages"/rehearse*.deb "$root/packages/"
readme=$(dirname "$0")/../../README.md
sed -n 's|^sudo apt-get install \(.*\) ./build/packages/.*|\1|p' "$readme" > "$root/compiler"
# the commands of the first five minutes; a check that finds the planted difference has to fail
sed -n '/^## Five minutes/,/^## A test/s/^\$ //p' "$readme" \
  | sed 's/^rehearse check$/if rehearse check; then echo "a weaker controller passes"; exit 1; fi/' > "$root/five_minutes"

cat > "$root/inside" << 'EOF'
set -euo pipefail
export DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8
began=$SECONDS
apt-get update > /log 2>&1
find / -xdev -not -path '/proc/*' -not -path '/var/*' -not -path '/etc/*' | sort > /before
fetched=$(apt-get install --simulate /packages/*.deb | grep -c ^Inst)
megabytes=$(apt-get install --yes --print-uris /packages/*.deb | awk "/^'/ { bytes += \$3 } END { printf \"%.0f\", bytes / 1e6 }")
echo "apt fetches $fetched packages, $megabytes MB"
((fetched <= 150 && megabytes <= 100)) || { echo "at most 150 packages and 100 MB are allowed"; exit 1; }
apt-get install --yes $(cat /compiler) /packages/*.deb > /log 2>&1 || { tail -n 30 /log; exit 1; }
echo "installed, with a compiler, in $((SECONDS - began)) s"
dpkg-query --show --showformat='${Package} ${Installed-Size} kB\n' rehearse rehearse-dev
rehearse --version

mkdir /home/new && cd /home/new
grep -q ctest /five_minutes
began_readme=$SECONDS
bash -e /five_minutes > /log 2>&1 || { tail -n 40 /log; exit 1; }
grep "100% tests passed" /log
echo "the README's commands took $((SECONDS - began_readme)) s"
((SECONDS - began_readme <= 300)) || { echo "at most five minutes are allowed"; exit 1; }

rehearse new "my other arm" | tee /steps
# its own commands, as it prints them
sed -n '/^  cd /,$p' /steps > /commands
grep -q ctest /commands
bash -e /commands > /log 2>&1 || { tail -n 40 /log; exit 1; }
grep "100% tests passed" /log

cd my_arm
rehearse check
sed -i 's/stiffness = 60.0/stiffness = 59.0/' hold.cpp
cmake --build build > /log 2>&1
if ctest --test-dir build > /log 2>&1; then echo "a weaker controller passes"; exit 1; fi
if rehearse check > /verdict; then echo "a weaker controller passes check"; exit 1; fi
cat /verdict
grep -q "the controller changed" /verdict
test -f build/traces/Hold.ComesBackAfterAPush.html
rehearse golden accept --all
# the stiffness itself is tested by a number
sed -i 's/-6.0, 1e-12/-5.9, 1e-12/' hold_test.cpp
cmake --build build > /log 2>&1
ctest --test-dir build --output-on-failure > /log 2>&1 || { tail -n 40 /log; exit 1; }
# programs that apt doesn't fetch by default
if rehearse replay golden/Hold.ComesBackAfterAPush.mcap --gdb > /log 2>&1; then echo "gdb isn't missed"; exit 1; fi
grep "apt-get install gdb" /log || { cat /log; exit 1; }
if rehearse audit scenarios/hold.yaml --valgrind > /log 2>&1; then echo "valgrind isn't missed"; exit 1; fi
grep "apt-get install valgrind" /log || { cat /log; exit 1; }

# the workflow's own steps, in a checkout, with a release in a folder; the history stays in the cache by default
test -f .github/workflows/test.yml || rehearse new --workflow --origin file:///origin --commit "$(printf "%040d" 1)" .
mkdir /home/new/checkout && cp -r .github .gitattributes .gitignore * /home/new/checkout/ && cd /home/new/checkout
rm -r build
awk '/^ +- name: / { of_branch = 0 } /^ +if: .*REHEARSE_HISTORY == .branch./ { of_branch = 1 } of_branch { block = 0; next }
     /^ +run: \|$/ { block = 1; next } /^ +run: / { sub(/^ +run: /, ""); print; next }
     block && /^          / { print; next } { block = 0 }' .github/workflows/test.yml > /workflow
grep -q "rehearse check" /workflow
release=/origin/releases/download/v$(rehearse --version | grep -o "[0-9.]*" | head -n 1)
mkdir -p "$release" && cp /packages/*.deb "$release"
CI=true REHEARSE_ORIGIN=file:///origin REHEARSE_PACKAGES=/kept bash -e /workflow > /log 2>&1 || { tail -n 40 /log; exit 1; }
test -f build/check.xml
man -w rehearse-record > /dev/null 2>&1 || test -f /usr/share/man/man1/rehearse-record.1.gz
echo "from the packages to an accepted change in $((SECONDS - began)) s"

cd / && rm -r /home/new /kept /origin ~/.cache/rehearse # of the user
apt-get purge --yes rehearse rehearse-dev > /log 2>&1
apt-get autoremove --purge --yes > /log 2>&1
find / -xdev -not -path '/proc/*' -not -path '/var/*' -not -path '/etc/*' | sort > /after
if comm -13 /before /after | grep -i rehearse; then echo "the packages left these behind"; exit 1; fi
EOF
run_in_bare "$root" /inside
