#!/usr/bin/env bash
# action_bare_test.sh SOURCE PACKAGES WORK: a bare Debian 12 with nothing but an apt repository on the loopback address goes
# the way of a team's first pull request: the action's install, a new project with goldens, a change that turns the check
# red, its table and report, the accept on request, green. It prints the times. Exit status 77: no bare Debian can be made
# here.
set -euo pipefail
source=$1 packages=$2 work=$3
# shellcheck source=tests/install/bare.sh
source "$(dirname "$0")/bare.sh"
make_bare "$work"
root=$work/root
begin_repository "$source" "$packages"
make_repository "$scratch/apt" "Test of Rehearse" > /dev/null
serve "$scratch" "$root/port"
mkdir "$root/action"
cp -r "$source/.github/actions/." "$root/action/"
# apt's proxy of this machine doesn't reach the server
echo 'Acquire::http::Proxy::127.0.0.1 "DIRECT";' > "$root/etc/apt/apt.conf.d/99loopback"

cat > "$root/inside" << 'INSIDE'
set -euo pipefail
export DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 no_proxy=127.0.0.1
export CI=true GITHUB_ACTIONS=true GITHUB_OUTPUT=/output GITHUB_STEP_SUMMARY=/summary GITHUB_EVENT_PATH=/event RUNNER_TEMP=/runner
export GITHUB_SERVER_URL=file:///server GITHUB_REPOSITORY=owner/name GITHUB_RUN_ID=42 GITHUB_ACTOR=someone ARTIFACT=rehearse
mkdir /runner
began=$SECONDS
quietly() { "$@" > /log 2>&1 || { tail -n 40 /log; exit 1; }; }
FROM=http://127.0.0.1:$(cat /port)/apt VERSION= KEY= quietly /action/check/install
rehearse --version
echo "installed from the loopback address in $((SECONDS - began)) s"
quietly apt-get install --yes --no-install-recommends cmake g++ make

# on a person's machine: a project, its goldens, a first commit
cd /home
env -u CI rehearse new my_arm > /log
cd my_arm
quietly cmake -S . -B build
quietly cmake --build build
REHEARSE_GOLDEN=new CI= quietly ctest --test-dir build
git config --global user.name A
git config --global user.email a@b
git init --quiet --bare /server/owner/name
git init --quiet --initial-branch topic
git remote add origin /server/owner/name
git add --all
git commit --quiet --message Begin
ARGUMENTS=--strict quietly /action/check/check
grep -qx status=0 /output

# a pull request makes the controller weaker
: > /output
sed -i 's/stiffness = 60.0/stiffness = 59.0/' hold.cpp
git commit --quiet --all --message "Weaken the arm"
git push --quiet origin topic
quietly cmake --build build
ARGUMENTS=--strict quietly /action/check/check
grep -qx status=1 /output
quietly /action/check/table
grep -F "| ❌ hold | the controller changed: fed with the golden's inputs, SHOULDER/u is beyond" /runner/rehearse/table.md
test -s /runner/rehearse/pending/Hold.ComesBackAfterAPush.html
GOLDENS=Hold.ComesBackAfterAPush PENDING=/runner/rehearse/pending BRANCH=topic RUN=42 quietly /action/check/accept
git --git-dir /server/owner/name log --format=%s topic

# the next run of CI
rm -rf /home/next
git clone --quiet --branch topic /server/owner/name /home/next
cd /home/next
: > /output
quietly cmake -S . -B build
quietly cmake --build build
ARGUMENTS=--strict quietly /action/check/check
grep -qx status=0 /output
echo "from nothing to an accepted pull request in $((SECONDS - began)) s"
INSIDE
run_in_bare "$root" /inside
