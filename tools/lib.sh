# What the scripts in tools/ share; sourced by them. They run from the repository's root.

set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

fail() {
  printf '%s: %s\n' "$(basename "$0")" "$*" >&2
  exit 2
}

# quietly LOG COMMAND...: keeps the command's output in a file, and shows its end only if the command fails.
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

# build_folder PRESET: where CMakePresets.json builds it.
build_folder() {
  case $1 in
    release | ci) echo build ;;
    asan-ubsan) echo build-asan ;;
    *) echo "build-$1" ;;
  esac
}

# configure_and_build PRESET [TARGET...]: everything, or only the targets; a few seconds if nothing changed. On a terminal
# Ninja shows its progress.
configure_and_build() {
  local preset=$1 folder launcher=() targets=()
  shift
  if (($# > 0)); then targets=(--target "$@"); fi
  folder=$(build_folder "$preset")
  if command -v ccache > /dev/null; then
    launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
    # In CI every run is a new checkout: let what one compiled serve the next, wherever it lies.
    if [[ ${CI:-} == true ]]; then export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1; fi
  fi
  quietly "$folder/configure.log" cmake --preset "$preset" "${launcher[@]}"
  if [[ -t 1 ]]; then
    cmake --build "$folder" --parallel "$(nproc)" "${targets[@]}"
  else
    quietly "$folder/build.log" cmake --build "$folder" --parallel "$(nproc)" "${targets[@]}"
  fi
}
