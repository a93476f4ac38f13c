#!/usr/bin/env bash
# wings_test.sh SOURCE FOLDER [core]: a choice of wings that can't be built is refused when it is configured. With
# `core` it also builds the core alone: it records, checks and replays, has the core's verbs, and says which wing a
# missing verb needs.
set -euo pipefail
source=$1 folder=$2
fail() { echo "$*" && exit 1; }

# refused WINGS SENTENCE
refused() {
  rm -rf "$folder/refused"
  if output=$(cmake -S "$source" -B "$folder/refused" -G Ninja "-DREHEARSE_WINGS=$1" 2>&1); then
    fail "REHEARSE_WINGS=$1 was configured"
  fi
  tr -s ' \n' ' ' <<<"$output" | grep -qF "$2" || fail "REHEARSE_WINGS=$1: not '$2', but: $output"
}
refused attic "REHEARSE_WINGS: there is no wing 'attic'; there are viewing"
refused "viewing;gtest" "REHEARSE_WINGS: the wing 'gtest' needs the wing 'campaigns'"
[[ ${3:-} == core ]] || exit 0

build=$folder/core
cmake -S "$source" -B "$build" -G Ninja -DREHEARSE_WINGS= -DREHEARSE_TESTS=OFF -DREHEARSE_BENCH=OFF -DREHEARSE_WERROR=ON \
  ${CCACHE_DIR:+-DCMAKE_CXX_COMPILER_LAUNCHER=ccache}
cmake --build "$build" --target rehearse_installed SR1MinimumController
rehearse=$build/bin/rehearse
export REHEARSE_CONTROLLER_PATH=$build/lib/rehearse/controllers
cd "$source"
"$rehearse" record fixtures/scenarios/sr1_minimum.yaml --duration 0.5 -o "$folder/core.mcap"
"$rehearse" replay "$folder/core.mcap"
"$rehearse" info "$folder/core.mcap" | grep -q JointState || fail "info shows no joints"
for verb in map export step report serve ui sweep audit import fuzz fit; do
  "$rehearse" --help | grep -q "^  $verb " && fail "the core's --help lists $verb"
  status=0
  output=$("$rehearse" $verb 2>&1) || status=$?
  [[ $status == 2 && $output == *"this build leaves out the verb $verb"*"REHEARSE_WINGS"* ]] || fail "$verb: $output"
done
status=0
output=$("$rehearse" replay "$folder/core.mcap" --tick 3 2>&1) || status=$?
[[ $status == 2 && $output == *"leaves out --tick"* ]] || fail "replay --tick: $output"
status=0
output=$("$rehearse" record fixtures/scenarios/sr1_minimum.yaml --live -o "$folder/live.mcap" 2>&1) || status=$?
[[ $status == 2 && $output == *"leaves out the option --live"* ]] || fail "record --live: $output"
find "$build/lib" -name 'librehearse_*.so' | grep -E 'logs|viewing|campaigns|audit|choreonoid|testing|fuzz|fitting' && fail "a wing was built"
exit 0
