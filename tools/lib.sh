# Functions that the scripts in tools/ share and source. The scripts run from the repository's root.

set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

fail() {
  printf '%s: %s\n' "$(basename "$0")" "$*" >&2
  exit 2
}

# quietly LOG COMMAND...: writes the command's output to a file, and prints its end only if the command fails.
quietly() {
  local log=$1 status=0
  shift
  mkdir -p "$(dirname "$log")"
  "$@" > "$log" 2>&1 || status=$?
  if ((status != 0)); then
    tail -n 60 "$log" >&2
    printf '%s: failed (exit %d): %s\nall of its output: %s\n' "$(basename "$0")" "$status" "$*" "$log" >&2
  fi
  return "$status"
}

# build_folder PRESET: the build folder of the preset in CMakePresets.json.
build_folder() {
  case $1 in
    release | ci) echo build ;;
    asan-ubsan) echo build-asan ;;
    *) echo "build-$1" ;;
  esac
}

# The folder of Debian's arm64 libraries, which tools/setup arm64 unpacks.
arm64_root() { echo "${REHEARSE_ARM64_ROOT:-${XDG_CACHE_HOME:-$HOME/.cache}/rehearse/arm64-root}"; }

# progress NAME [UNIT]: reads lines "DONE TOTAL" and prints, every 15 seconds, the progress and the time left.
progress() {
  local name=$1 unit=${2:-} begin=$SECONDS next=$((SECONDS + 15)) done total left amount
  while read -r done total; do
    ((SECONDS >= next && done > 0)) || continue
    next=$((SECONDS + 15)) left=$(((SECONDS - begin) * (total - done) / done))
    if [[ $unit ]]; then amount="$done of $total $unit"; else amount="$((100 * done / total)) %"; fi
    printf '%s%s, about %d:%02d min left\n' "$name" "$amount" $((left / 60)) $((left % 60))
  done
}

# with_progress FILTER NAME UNIT COMMAND...: runs the command, and prints its progress on descriptor 3: FILTER converts
# the command's output to lines for progress.
with_progress() {
  local filter=$1 name=$2 unit=$3
  shift 3
  "$@" 2>&1 | tee >("$filter" | progress "$name" "$unit" >&3)
}

ninja_progress() { sed --unbuffered -nE 's/^\[([0-9]+)\/([0-9]+)\].*/\1 \2/p'; }

# origin_of REMOTE: the address of a remote as a browser opens it, from which anyone can fetch; nothing for a folder.
origin_of() { sed -nE 's#^(https?://|ssh://git@|git@)([^/:@]+)[:/](.+)$#https://\2/\3#p' <<< "${1%.git}"; }

# The version that CMakeLists.txt states.
project_version() { sed -nE 's/^project\(Rehearse VERSION ([0-9.]+).*/\1/p' CMakeLists.txt; }

# Options of cmake, besides those of the preset.
configure_options=()

# configure_and_build PRESET [TARGET...]: everything, or only the targets; a few seconds if nothing changed.
configure_and_build() {
  local preset=$1 folder launcher=() targets=()
  shift
  if (($# > 0)); then targets=(--target "$@"); fi
  folder=$(build_folder "$preset")
  if command -v ccache > /dev/null; then
    launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
    # In CI every run is a new checkout: let all runs share a compiler cache, whatever the folder of the checkout.
    if [[ ${CI:-} == true ]]; then export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1; fi
  fi
  quietly "$folder/configure.log" cmake --preset "$preset" "${launcher[@]}" "${configure_options[@]}"
  NINJA_STATUS="[%f/%t] " quietly "$folder/build.log" with_progress ninja_progress "build: " units \
    cmake --build "$folder" --parallel "$(nproc)" "${targets[@]}" 3>&1
}
