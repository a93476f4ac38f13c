# shellcheck shell=bash
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

# with_progress FILTER NAME COMMAND...: runs the command, and prints its progress on descriptor 3 every 15 seconds: FILTER
# converts the command's output to lines "DONE TOTAL".
with_progress() {
  local filter=$1 name=$2
  shift 2
  "$@" 2>&1 | tee >("$filter" | progress "$name" >&3)
}

progress() {
  local begin=$SECONDS next=$((SECONDS + 15)) part total left
  while read -r part total; do
    ((SECONDS >= next && part > 0)) || continue
    next=$((SECONDS + 15)) left=$(((SECONDS - begin) * (total - part) / part))
    printf '%s%d %%, about %d:%02d min left\n' "$1" $((100 * part / total)) $((left / 60)) $((left % 60))
  done
}

# What tools/demo builds; tools/bench --build measures it.
# shellcheck disable=SC2034  # for scripts that source this
demo_targets=(rehearse_core SR1MinimumController)

# The processor time of each output of a build, which tools/bench --build --costs measures; without it no time left is shown.
build_costs=tools/build_costs.txt

# planned FOLDER COSTS TARGET...: a line "SECONDS OUTPUT" for each unit that ninja is going to make, with its processor
# time by COSTS. An output that isn't there has the median of its kind.
planned() {
  local folder=$1 costs=$2
  shift 2
  # named by its absolute path, build.ninja isn't an output that cmake has to make anew before ninja can plan
  NINJA_STATUS="[%f/%t] " ninja -C "$folder" -f "$PWD/$folder/build.ninja" -n "$@" 2> /dev/null \
    | awk -v costs="$costs" -v statements="$folder/build.ninja" '
      function kind(output) {
        return (output ~ /^tests\// ? "test " : "") \
          (output ~ /\.o$/ ? "object" : output ~ /\.gch$/ ? "header" : output ~ /^bin\/|\.so[.0-9]*$|\.a$/ ? "program" : "other")
      }
      function median(of, n, i, j, x) {
        if (of in medians) return medians[of]
        n = count[of]
        for (i = 2; i <= n; ++i) {
          x = seconds[of, i]
          for (j = i; j > 1 && seconds[of, j - 1] > x; --j) seconds[of, j] = seconds[of, j - 1]
          seconds[of, j] = x
        }
        return medians[of] = n ? seconds[of, int((n + 1) / 2)] : 1
      }
      BEGIN {
        while ((getline < costs) > 0)
          if ($1 + 0 > 0) {
            cost[$2] = $1
            seconds[kind($2), ++count[kind($2)]] = $1
          }
        # what ninja calls a command that neither compiles nor links: its description, or else the command itself
        while ((getline < statements) > 0) {
          if ($1 == "build") { output = $2; sub(/:$/, "", output) }
          if ($1 == "COMMAND" || $1 == "DESC") { sub(/^[^=]*= /, ""); named[$0] = output }
        }
      }
      sub(/^\[[0-9]+\/[0-9]+\] /, "") {
        output = ($1 == "Building" || $1 == "Linking") ? $NF : named[$0]
        if (output != "") print (output in cost ? cost[output] : median(kind(output))), output
      }'
}

# estimate PLAN BEFORE LOG ELAPSED JOBS [REMAINING]: a line "DONE TOTAL PERCENT LEFT OUTPUT" of a build that has lasted
# ELAPSED seconds: units, per cent of the cost, seconds left, and what is being made now. PLAN is of `planned`, LOG is
# ninja's log, BEFORE its copy of before the build. REMAINING units are left by ninja's count: fewer than planned, if
# an output turned out as it was.
estimate() {
  awk -v elapsed="$4" -v jobs="$5" -v remaining="${6:-}" '
    file == "plan" { cost[$2] = $1; total += $1; unit[++units] = $2; next }
    /^#/ { next }
    file == "before" { old[$0]; next }
    !($0 in old) && ($4 in cost) && !($4 in is_done) {
      is_done[$4]
      end[++finished] = $2 / 1000
      done += cost[$4]
      # seconds of the clock for a second of cost, by what ended last rather than by what ended long ago
      weight = exp(($2 / 1000 - elapsed) / 180)
      weighted_busy += weight * ($2 - $1) / 1000
      weighted_cost += weight * cost[$4]
    }
    END {
      if (!units) exit
      # until something has ended, the machine is taken for as fast as that which measured the costs
      slowness = (weighted_busy + 5) / (weighted_cost + 5)
      # The first units of the plan that are left are running: the one in the n-th place since n - jobs units had ended. What
      # costs less than a second is left out, as it may wait for others. In the beginning, a unit that takes longer than
      # expected counts as if it had ended.
      for (i = 1; i <= units && running < jobs; ++i) {
        if (unit[i] in is_done || cost[unit[i]] < 1) continue
        if (++running == 1) now = unit[i]
        ran[i] = elapsed - (i > jobs ? end[i - jobs < finished ? i - jobs : finished] : 0)
        if (done < 0.1 * total && cost[unit[i]] > 5 && ran[i] > slowness * cost[unit[i]]) {
          weighted_busy += ran[i]
          weighted_cost += cost[unit[i]]
        }
      }
      if (done < 0.1 * total) slowness = (weighted_busy + 5) / (weighted_cost + 5)
      unfinished = units - finished
      if (remaining > 0 && remaining < unfinished) slowness *= remaining / unfinished
      # the rest goes to the cores in the order of the plan
      for (i = 1; i <= units; ++i) {
        if (unit[i] in is_done) continue
        seconds = slowness * cost[unit[i]]
        if (i in ran) seconds -= ran[i] < 0.9 * seconds ? ran[i] : 0.9 * seconds
        first = 1
        for (j = 2; j <= jobs; ++j) if (core[j] + 0 < core[first] + 0) first = j
        core[first] += seconds
        if (core[first] > left) left = core[first]
      }
      printf "%d %d %d %d %s\n", finished, units, total ? 100 * done / total : 0, left + 0.5, now
    }' file=plan "$1" file=before "$2" file=log "$3"
}

# name_of OUTPUT: an output of the build in words: for an object of a room its folder, else "TARGET of FOLDER".
name_of() {
  sed -E 's#^(.*/)?CMakeFiles/(rehearse_room_)?([^/]+)\.dir/.*#\3 of \1#; s#_(cold|hot|gdb) of# of#; s#/$##; s# of $##; s#^(.*) of (.*/)?\1$#\2\1#' <<< "$1"
}

# show_estimates FOLDER JOBS: until it or the script is ended, prints the progress of ninja's build in that folder: on a
# terminal as one line that changes, else every 15 seconds. FOLDER/estimate/ has the plan and the log of before.
show_estimates() {
  local folder=$1 jobs=$2 begin=$SECONDS pause=15 clear='' finished units percent left output remaining line
  [[ -s $folder/estimate/plan ]] || return 0
  if [[ -t 1 ]]; then pause=1 clear='\r\033[K'; fi
  trap 'kill $! 2> /dev/null; printf "$clear"; exit' TERM
  while kill -0 $$ 2> /dev/null; do
    sleep "$pause" > /dev/null 2>&1 &  # in the background, because a signal ends only the wait for it
    wait $!
    remaining=$(tail -c 4000 "$folder/build.log" | awk -F '[][/]' '/^\[[0-9]+\/[0-9]+\]/ { n = $3 - $2 } END { print n }')
    read -r finished units percent left output < <(estimate "$folder"/estimate/{plan,before} "$folder/.ninja_log" \
      $((SECONDS - begin)) "$jobs" "$remaining") || continue
    line="build: $percent %, $finished of $units units"
    if [[ $output ]]; then line="build: $(name_of "$output"); $percent %, $finished of $units units"; fi
    if [[ -f $build_costs ]]; then line+=", about $((left / 60)):$(printf %02d $((left % 60))) min left"; fi
    if [[ $clear ]]; then
      printf "$clear%s" "${line:0:$(($(tput cols 2> /dev/null || echo 80) - 1))}"
    else
      echo "$line"
    fi
  done
}

# origin_of REMOTE: the address of a remote as a browser opens it, from which anyone can fetch; nothing for a folder.
origin_of() { sed -nE 's#^(https?://|ssh://git@|git@)([^/:@]+)[:/](.+)$#https://\2/\3#p' <<< "${1%.git}"; }

# The version that CMakeLists.txt states.
project_version() { sed -nE 's/^project\(Rehearse VERSION ([0-9.]+).*/\1/p' CMakeLists.txt; }

# Options of cmake, besides those of the preset.
configure_options=()

# set_up_ccache: puts the settings of ccache, which all builds by these scripts share, into the environment.
set_up_ccache() {
  # ccache compares the contents of precompiled headers, not their times.
  export CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
  # ccache compares sources and headers byte for byte, not the preprocessor's output: a changed comment leaves that output
  # equal, but gcc finds the header in a precompiled one only if its bytes are equal.
  export CCACHE_DEPEND=1
  # In CI every run is a new checkout: let all runs share a compiler cache, whatever the folder of the checkout.
  if [[ ${CI:-} == true ]]; then export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1; fi
}

configure() {
  local preset=$1 launcher=()
  if command -v ccache > /dev/null; then
    launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
    set_up_ccache
  fi
  quietly "$(build_folder "$preset")/configure.log" cmake --preset "$preset" "${launcher[@]}" "${configure_options[@]}"
}

# configure_and_build PRESET [TARGET...]: everything, or only the targets; a few seconds if nothing changed.
configure_and_build() {
  local folder
  folder=$(build_folder "$1")
  configure "$1"
  shift
  quietly "$folder/build.log" with_estimates "$folder" "$@" 3>&1
}

# with_estimates FOLDER TARGET...: builds the targets, and prints the progress on descriptor 3.
with_estimates() {
  local folder=$1 jobs shower status=0 targets=()
  shift
  jobs=$(nproc)
  if (($# > 0)); then targets=(--target "$@"); fi
  mkdir -p "$folder/estimate"
  cat "$folder/.ninja_log" > "$folder/estimate/before" 2> /dev/null || true
  planned "$folder" "$build_costs" "$@" > "$folder/estimate/plan"
  if [[ -f $build_costs ]]; then
    awk -v jobs="$jobs" '{ seconds += $1 / jobs } END { if (seconds > 60)
      printf "build: %d units, about %.0f min on %d cores if no compiler cache helps\n", NR, seconds / 60, jobs
    }' "$folder/estimate/plan" >&3
  fi
  show_estimates "$folder" "$jobs" >&3 &
  shower=$!
  NINJA_STATUS="[%f/%t] " cmake --build "$folder" --parallel "$jobs" "${targets[@]}" || status=$?
  kill "$shower" 2> /dev/null || true
  wait "$shower" 2> /dev/null || true
  return "$status"
}
