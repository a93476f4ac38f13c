#!/usr/bin/env bash
# python_package_test.sh PACKAGES WORK: installs rehearse and python3-rehearse into a bare Debian 12, where no checkout, no
# compiler and no build tree are, and goes the way of a new user there: a project in Python, its golden, a red test, an
# accepted change, a recording as arrays. Then it removes the packages and looks for what they left. Exit status 77: no bare
# Debian can be made here.
set -euo pipefail

packages=$1 work=$2
root=$work/root
# shellcheck source=tests/install/bare.sh
source "$(dirname "$0")/bare.sh"
make_bare "$work"
mkdir "$root/packages"
cp "$packages"/rehearse_*.deb "$packages"/python3-rehearse_*.deb "$root/packages/"

cat > "$root/inside" << 'INSIDE'
set -euo pipefail
export DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8
began=$SECONDS
apt-get update > /log 2>&1
find / -xdev -not -path '/proc/*' -not -path '/var/*' -not -path '/etc/*' | sort > /before
apt-get install --yes --no-install-recommends python3-pytest /packages/*.deb > /log 2>&1 || { tail -n 30 /log; exit 1; }
dpkg-query --show --showformat='${Package} ${Installed-Size} kB\n' python3-rehearse
mkdir /home/new && cd /home/new
rehearse new --language python my_arm > /steps
sed -n '/^  cd /,$p' /steps > /commands
grep -q pytest /commands
bash -e /commands > /log 2>&1 || { tail -n 40 /log; exit 1; }
grep "3 passed" /log
cd my_arm
sed -i 's/STIFFNESS = 60.0/STIFFNESS = 59.0/' hold.py
if python3 -m pytest > /log 2>&1; then echo "a weaker controller passes"; exit 1; fi
grep "the controller changed" /log
if rehearse check > /verdict; then echo "a weaker controller passes check"; exit 1; fi
rehearse golden accept --all
sed -i 's/approx(-6.0/approx(-5.9/' test_hold.py
python3 -m pytest > /log 2>&1 || { tail -n 40 /log; exit 1; }
python3 -c 'import rehearse; t = rehearse.Trace("golden/Hold.ComesBackAfterAPush.mcap"); print(t, t["Arm/SHOULDER/q"].min())'
echo "from the packages to an accepted change in $((SECONDS - began)) s"

cd / && rm -r /home/new ~/.cache/rehearse # the user's project and cache
apt-get purge --yes rehearse python3-rehearse > /log 2>&1
apt-get autoremove --purge --yes > /log 2>&1
find / -xdev -not -path '/proc/*' -not -path '/var/*' -not -path '/etc/*' | sort > /after
if comm -13 /before /after | grep -i rehearse; then echo "the packages left these behind"; exit 1; fi
INSIDE
run_in_bare "$root" /inside
