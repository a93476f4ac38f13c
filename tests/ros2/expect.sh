# shellcheck shell=bash disable=SC2034
# (the scripts that source it use the variables)
# What the scripts of this folder have in common: the commands `begin` and `expect`. After them $failed is 1 if one failed.
failed=0
# begin NAME: what the next commands test.
test_name=
begin() { test_name=$1; }
fail() {
  echo "FAILED: $test_name: $*"
  failed=1
}
# expect STATUS TEXT COMMAND...: the command ends with this status, and its output contains the text.
expect() {
  local status=$1 text=$2 output actual=0
  shift 2
  output=$("$@" 2>&1) || actual=$?
  if ((actual != status)); then
    fail "status $actual, not $status, of: $*"
    echo "$output"
  elif [[ $output != *"$text"* ]]; then
    fail "no '$text' in the output of: $*"
    echo "$output"
  fi
}
# sourced FILE: sources a script of ament, which uses variables that aren't set.
sourced() {
  set +u
  # shellcheck disable=SC1090
  source "$1"
  set -u
}
