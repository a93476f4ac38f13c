#!/usr/bin/env bash
# control_test.sh BUILD WORK WORKSPACE: runs controllers of ros2_control on an arm. WORKSPACE is the install folder of a
# workspace with ros2_control and ros2_controllers, built by colcon against the client library of BUILD.
set -euo pipefail

build=$1 work=$2 workspace=$3
tests=$(realpath "$(dirname "$0")")
root=$tests/../..
prefix=$build/lib/rehearse/ros2
if [[ -z $workspace ]]; then
  echo "skipped: -DREHEARSE_ROS2_WORKSPACE= names no workspace with controller_manager"
  exit 77
fi
if ! [[ -e $prefix/setup.sh ]] || ! command -v colcon > /dev/null; then
  echo "skipped: tools/setup ros2 and tools/ros2 $build build the packages that this test needs"
  exit 77
fi
export PATH=$build/bin:/usr/bin:/bin CMAKE_GENERATOR=Ninja
source "$tests/expect.sh"
mkdir -p "$work"
cd "$work"
sourced "$prefix/setup.sh"
sourced "$workspace/local_setup.sh"

begin "the packages are built by colcon against the workspace"
if ! colcon --log-base log build --merge-install --base-paths "$root/controllers/ros2_control" "$tests/control/package" \
  --build-base build --install-base install --cmake-args -DBUILD_TESTING=OFF -DCMAKE_CXX_FLAGS=-O1 > build.log 2>&1; then
  cat build.log
  echo "FAILED: $test_name"
  exit 1
fi
sourced install/local_setup.sh

# describe ROBOT MODEL: a model of the fixtures, with what ros2_control knows of the robot.
describe() {
  sed '/<\/robot>/d' "$root/fixtures/models/$2.urdf"
  cat "$tests/control/$1.ros2_control.xml"
  echo '</robot>'
}
describe arm six_joint_arm > arm.urdf
describe pendulum pendulum > pendulum.urdf
describe scout scout > scout.urdf
cp "$tests"/control/*.yaml .

# last TOPIC RECORDING: the last message of the topic.
# shellcheck disable=SC2317  # it is called by expect
last() { rehearse cat --topics "$1" "$2" | tail -n 1; }
commanded=/Arm/Manager/variable/command%2F

begin "a trajectory is followed by the workspace's own controller"
expect 0 "recorded trajectory" rehearse record trajectory_run.yaml -o trajectory.mcap
expect 0 "position=[0.30" last /Arm/joints trajectory.mcap
expect 0 "Loaded hardware 'arm' from plugin 'rehearse_ros2_control/System'" rehearse cat --topics /events trajectory.mcap

begin "interfaces, states of controllers and their topics are recorded"
for series in state%2FJ1%2Fposition command%2FJ2%2Feffort arm%2Fstate joint_states%2Fposition%2F0 \
  arm%2Fcontroller_state%2Ferror%2Fpositions%2F5; do
  expect 0 "/Arm/Manager/variable/$series" rehearse info trajectory.mcap
done

begin "controllers are active from the end of the first tick on"
expect 0 "data=3" sh -c "rehearse cat --topics /Arm/Manager/variable/arm%2Fstate trajectory.mcap | head -n 1"

begin "two runs are equal, bit for bit"
expect 0 "" rehearse record trajectory_run.yaml -o again.mcap
expect 0 "equal bit for bit" rehearse diff trajectory.mcap again.mcap

begin "a replay without physics repeats the commands"
expect 0 "equal bit for bit" rehearse replay trajectory.mcap

begin "unchanged controllers are proved"
expect 0 "" rehearse check trajectory_run.yaml --golden trajectory.mcap
expect 0 "proved without simulating" rehearse check trajectory_run.yaml --golden trajectory.mcap

begin "commands don't depend on the order of the manager's threads"
expect 0 "bit for bit, in 20 other orders" rehearse audit trajectory.mcap --orders 20

begin "gdb stops in update() of the controller"
if command -v gdb > /dev/null; then
  expect 0 "joint_trajectory_controller::JointTrajectoryController::update" \
    rehearse replay trajectory.mcap --gdb=Manager --tick 300 --gdb-arg=-batch \
    --gdb-arg=-ex --gdb-arg='break joint_trajectory_controller::JointTrajectoryController::update' \
    --gdb-arg=-ex --gdb-arg=continue
fi

begin "a smaller gain is found: the joint and the file are named"
sed -i 's/J2: {p: 2000.0/J2: {p: 1990.0/' trajectory.yaml
expect 1 "trajectory.yaml has changed since the recording" rehearse check trajectory_run.yaml --golden trajectory.mcap
expect 1 "J2/u" rehearse replay trajectory.mcap

begin "faults of parameters are found in a replay without physics"
# fault PATTERN TEXT: a replay with parameters that are changed by the pattern of sed differs, and says this.
fault() {
  sed "$1" "$tests/control/trajectory.yaml" > trajectory.yaml
  expect 1 "$2" rehearse replay trajectory.mcap
}
fault 's/J3: {p: 400.0, d: 12.0}/J3: {p: 400.0, d: 12.1}/' "J3/u"
fault 's/J5: {p: 20.0/J5: {p: -20.0/' "J5/u"
fault 's/gains:/interpolation_method: none\n    gains:/' "/u is"
fault 's/J2: {/J2: {ff_velocity_scale: 0.01, /' "J2/u"
fault 's/update_rate: 500/update_rate: 250/' "/u is"
fault 's/J4: {p: 5.0/J4: {i: 0.5, i_clamp_max: 1.0, i_clamp_min: -1.0, p: 5.0/' "J4/u"
cp "$tests/control/trajectory.yaml" .
expect 0 "equal bit for bit" rehearse replay trajectory.mcap

begin "a chain of a trajectory and a PID controller has its closed form"
expect 0 "" rehearse record chain_run.yaml -o chain.mcap
expect 0 "largest effort" python3 "$tests/control/closed_form.py" chain.mcap
sed -i 's/p: 900.0/p: 900.000000001/' chain.yaml
expect 0 "" rehearse record chain_run.yaml -o chain.mcap
expect 1 "largest effort" python3 "$tests/control/closed_form.py" chain.mcap

begin "messages are forwarded, and events switch controllers"
expect 0 "" rehearse record forward_run.yaml -o forward.mcap
expect 0 "data=0.3" last "${commanded}J2%2Fposition" forward.mcap
expect 0 "data=0.4" last "${commanded}J3%2Fposition" forward.mcap
expect 0 "data=3" last /Arm/Manager/variable/both%2Fstate forward.mcap
expect 0 "data=2" last /Arm/Manager/variable/shoulder%2Fstate forward.mcap

begin "a goal of an action is followed"
sed 's/duration: 1.5/duration: 3/; /publish:/,$d' trajectory_run.yaml > goal_run.yaml
cat >> goal_run.yaml << 'end'
              goal: /arm/follow_joint_trajectory
              message:
                trajectory:
                  joint_names: [J1, J2, J3, J4, J5, J6]
                  points: [{positions: [0.3, 0.2, 0.4, -0.5, 0.6, 0.7], time_from_start: {sec: 1}}]
end
expect 0 "" rehearse record goal_run.yaml -o goal.mcap
expect 0 "[INFO] [/arm/follow_joint_trajectory]: the goal succeeded" rehearse cat --topics /events goal.mcap
sed 's/joint_names: \[J1, /joint_names: [J9, /' goal_run.yaml > wrong.yaml
expect 3 "the action '/arm/follow_joint_trajectory' rejected the goal" rehearse record wrong.yaml -o wrong.mcap

begin "a robot drives by the velocities of its wheels"
if [[ -e $workspace/share/diff_drive_controller ]]; then
  expect 0 "" rehearse record drive_run.yaml -o drive.mcap
  # (0.4 m/s -+ 0.5 rad/s 0.16 m) / 0.1 m
  expect 0 "data=3.1999999" last /Scout/Manager/variable/command%2FLEFT_WHEEL%2Fvelocity drive.mcap
  expect 0 "data=4.8" last /Scout/Manager/variable/command%2FRIGHT_WHEEL%2Fvelocity drive.mcap
  expect 0 "data=0.399" last /Scout/Manager/variable/drive%2Fodom%2Ftwist%2Ftwist%2Flinear%2Fx drive.mcap
  expect 0 "equal bit for bit" rehearse replay drive.mcap
else
  echo "left out: $test_name: the workspace has no diff_drive_controller"
fi

begin "an asynchronous controller has one result"
sed -i 's/{joints: \[J2\], interface_name: position}/{joints: [J2], interface_name: position, is_async: true}/' forward.yaml
expect 0 "" rehearse record forward_run.yaml -o forward.mcap
expect 0 "is_async" grep is_async forward.yaml
expect 0 "" rehearse record forward_run.yaml -o again.mcap
expect 0 "equal bit for bit" rehearse diff forward.mcap again.mcap
cp "$tests/control/forward.yaml" .

begin "two robots have a manager each, in namespaces"
sed 's|^\([a-z_]*\):$|/**/\1:|' forward.yaml > wild.yaml
expect 0 "" rehearse record two_run.yaml -o two.mcap
expect 0 "data=0.1" last "/Left/Manager/variable/command%2FJ3%2Fposition" two.mcap
expect 0 "data=0.2" last "/Right/Manager/variable/command%2FJ3%2Fposition" two.mcap
expect 0 "equal bit for bit" rehearse replay two.mcap

begin "sensors are devices, and what the robot doesn't have keeps its first value"
expect 0 "" rehearse record sensors_run.yaml -o sensors.mcap
for series in gyro%2Fangular_velocity.y imu%2Flinear_acceleration.z imu%2Fangular_velocity.y hinge%2Fposition; do
  expect 0 "/Pendulum/Manager/variable/state%2F$series" rehearse info sensors.mcap
done
expect 0 "the robot has no 'hinge/temperature': it keeps its first value" rehearse cat --topics /events sensors.mcap

begin "periods are those of the cycle"
expect 0 "" rehearse record failing_run.yaml -o failing.mcap
expect 0 "data=0.009899999" last "${commanded}J1%2Fposition" failing.mcap    # 99 cycles of 1 ms at 0.1 rad/s
sed -i 's/update_rate: 1000/update_rate: 500/' failing.yaml
expect 0 "" rehearse record failing_run.yaml -o failing.mcap
expect 0 "data=0.0098" last "${commanded}J1%2Fposition" failing.mcap    # 49 cycles of 2 ms
sed -i 's/update_rate: 500/update_rate: 1000/' failing.yaml

# fails FAILURE TEXT: the controller that fails in its cycle 50 ends the run at this tick.
fails() {
  sed "s/failure: none/failure: $1/" "$tests/control/failing.yaml" > failing.yaml
  expect 3 "$2" rehearse record failing_run.yaml -o failing.mcap
  expect 3 "at tick 50" rehearse record failing_run.yaml -o failing.mcap
}
begin "failures in a cycle name the controller and the tick"
fails error "update() failed, so the manager deactivated 'arm'"
fails exception "the arm is cold"
fails nan "the controller 'arm' commands nan to 'J1/position'"

begin "a fallback controller takes over"
sed 's/{failure: none}/{failure: error}/' "$tests/control/failing.yaml" > failing.yaml
sed -i 's|arm: {type: test_controllers/Failing}|arm: {type: test_controllers/Failing, fallback_controllers: [hold]}|' failing.yaml
cat >> failing.yaml << 'end'
hold:
  ros__parameters: {type: forward_command_controller/ForwardCommandController, joints: [J1], interface_name: position}
end
expect 0 "" rehearse record failing_run.yaml -o failing.mcap
expect 0 "data=3" last /Arm/Manager/variable/hold%2Fstate failing.mcap
expect 0 "data=2" last /Arm/Manager/variable/arm%2Fstate failing.mcap

# mistake TEXT PATTERN: the scenario with forward controllers, changed by the pattern of sed, fails with this text.
mistake() {
  sed "$2" forward_run.yaml > wrong.yaml
  expect 3 "$1" rehearse record wrong.yaml -o wrong.mcap
}
begin "mistakes are named"
mistake "the command interface 'J2/position' will be used by another controller" 's/\[shoulder, elbow\]$/[shoulder, both]/'
mistake "the command interface 'J2/position' is currently claimed" 's/deactivate: \[shoulder, elbow\]/deactivate: [elbow]/'
mistake "the command interface 'J2/temperature' is not available" 's/controllers: \[shoulder, elbow\]/controllers: [unknown]/'
mistake "'strong' claims 'J2/effort', but 'shoulder' commands another quantity" \
  's/controllers: \[shoulder, elbow\]/controllers: [shoulder, strong]/'
mistake "The 'type' param was not defined for 'nobody'" 's/controllers: \[shoulder, elbow\]/controllers: [nobody]/'
mistake "the description 'none.urdf' can't be read" 's/description: arm/description: none/'
mistake "the options have no 'description'" '/description/d'
mistake "isn't a whole number of ticks: update_rate is 1000 Hz" 's/time_step: 0.001/time_step: 0.0015/'
mistake "'hard' isn't known here" 's/strictness: strict/strictness: hard/'

if ((failed == 0)); then echo "all of $(basename "$0") passed"; fi
exit $failed
