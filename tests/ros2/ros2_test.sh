#!/usr/bin/env bash
# ros2_test.sh BUILD WORK: builds the packages of this folder with colcon in WORK, tests the client library, and runs nodes
# as guests of the scenarios beside this file.
set -euo pipefail

build=$1 work=$2
tests=$(realpath "$(dirname "$0")")
prefix=$build/lib/rehearse/ros2
if ! [[ -e $prefix/setup.sh ]] || ! command -v colcon > /dev/null; then
  echo "skipped: tools/setup ros2 and tools/ros2 $build build the packages that this test needs"
  exit 77
fi
export PATH=$build/bin:/usr/bin:/bin CMAKE_GENERATOR=Ninja

# shellcheck source-path=SCRIPTDIR
source "$tests/expect.sh"

begin "setup.sh is refused beside another rclcpp"
mkdir -p "$work/other/share/rclcpp"
expect 1 "$work/other has another rclcpp" env AMENT_PREFIX_PATH="$work/other" sh -c ". '$prefix/setup.sh'"

mkdir -p "$work"
cd "$work"
sourced "$prefix/setup.sh"

begin "the packages are built by colcon"
if ! colcon --log-base log build --merge-install --base-paths "$tests/packages" --build-base build --install-base install \
  --cmake-args -DBUILD_TESTING=OFF -DCMAKE_CXX_FLAGS=-O1 > build.log 2>&1; then
  cat build.log
  echo "FAILED: $test_name"
  exit 1
fi
sourced install/local_setup.sh

begin "the client library behaves as its documents say"
expect 0 "[  PASSED  ]" install/lib/rehearse_client_library_tests/client_library_test

scenarios=$tests/scenarios
hold=$scenarios/hold.yaml
begin "a node holds a pendulum, and its lines and topics are recorded"
expect 0 "" rehearse record "$hold" -o hold.mcap
expect 0 "[INFO] [hold]: rests at 0.0 rad" rehearse cat --topics /events hold.mcap
expect 0 "/Pendulum/Hold/variable/hold%2Fangle%2Fdata" rehearse info hold.mcap

begin "messages, parameters, calls and goals of the scenario reach the node"
expect 0 "[INFO] [/hold/turn]: the goal succeeded" rehearse cat --topics /events hold.mcap
expect 0 "[hold]: at 0.178 rad" rehearse cat --topics /events hold.mcap

begin "a node in a thread of its own hears the other one"
expect 0 "/Pendulum/Filter/variable/smooth%2Fdata" rehearse info hold.mcap

begin "two runs are equal, bit for bit"
expect 0 "" rehearse record "$hold" -o again.mcap
expect 0 "equal bit for bit" rehearse diff hold.mcap again.mcap

begin "a replay without physics repeats the commands"
expect 0 "equal bit for bit" rehearse replay hold.mcap

begin "an unchanged node is proved"
expect 0 "proved" rehearse check "$hold" --golden hold.mcap

begin "a smaller gain is found, and the controller is named"
expect 1 "the controller changed" \
  rehearse check "$hold" --golden hold.mcap --controller Hold=libweaker_nodes.so:test_nodes::Hold
expect 1 "hinge/u" rehearse replay hold.mcap --controller Hold=libweaker_nodes.so:test_nodes::Hold

begin "gdb stops in the callback of the node"
if command -v gdb > /dev/null; then
  expect 0 "test_nodes::Hold::command" rehearse replay hold.mcap --gdb=Hold --tick 100 \
    --gdb-arg=-batch --gdb-arg=-ex --gdb-arg='break test_nodes::Hold::command' --gdb-arg=-ex --gdb-arg=continue
fi

begin "nodes are functions of their inputs"
expect 0 "Pendulum/Hold and Pendulum/Filter are functions of their inputs" rehearse audit hold.mcap

begin "a lifecycle node acts while it is active"
expect 0 "" rehearse record "$scenarios/managed.yaml" -o managed.mcap
# from 0.2 s to 0.4 s: 200 ticks
expect 0 " 200 " sh -c "rehearse info managed.mcap | grep /Pendulum/Managed/variable/commands%2Feffort%2F0"

# mistake STATUS TEXT PATTERN: the first scenario, changed by the pattern of sed, ends with this status and text.
mistake() {
  sed "$3; s|\.\./\.\./\.\./fixtures|$tests/../../fixtures|" "$hold" > wrong.yaml
  expect "$1" "$2" rehearse record wrong.yaml -o wrong.mcap
}
begin "mistakes are named"
mistake 3 "options, line 1: 'topicz' isn't known here" 's/  topics:/  topicz:/'
mistake 3 "the robot has no joint 'knee'" 's/\[hinge\]/[knee]/'
mistake 3 "'a' is no value of this field" 's/{data: 0.2}/{data: a}/'
mistake 3 "'request' doesn't belong to 'publish'" 's/message: {data: 0.2}/request: {data: 0.2}/'
mistake 3 "options, line 7: parameters are a map of names and values" 's/{stiffness: 50.0}/50.0/'
mistake 3 "nobody has the action '/hold/go'" 's|goal: /hold/turn|goal: /hold/go|'
mistake 3 "bad file: none.yaml" 's/{damping: 5.0}/none.yaml/'
mistake 3 "options, line 4: a node has no controllers" 's/parameters: {damping: 5.0}/controllers: [arm]/'
mistake 3 "'strictness' belongs to activate and deactivate" 's/message: {data: 0.2}/strictness: strict/'
mistake 3 "a node has no controllers to activate" 's|publish: /hold/target, message: {data: 0.2}|activate: [arm]|'
mistake 2 "it has test_nodes::Filter" 's/test_nodes::Hold/test_nodes::Hole/'
mistake 2 "not found" 's/libtest_nodes.so:test_nodes::Hold/libnone.so:test_nodes::Hold/'
mistake 3 "no more" 's/test_nodes::Filter/test_nodes::Thrower/'
mistake 3 "'/talker' is never idle" 's/test_nodes::Filter/test_nodes::Talker/'

if ((failed == 0)); then echo "all of $(basename "$0") passed"; fi
exit $failed
