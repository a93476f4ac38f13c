# shellcheck shell=bash
# Functions of the action's steps. A step gets its inputs from the environment, and keeps its files in $kept, which
# becomes the artifact.
set -euo pipefail

# shellcheck disable=SC2034  # the steps use it
kept=${RUNNER_TEMP:?the runner sets it}/rehearse

# shellcheck disable=SC2034
golden_name='^[A-Za-z0-9_][A-Za-z0-9_-]*(\.[A-Za-z0-9_-]+)+$' # Suite.Test

# A workflow command: the line is shown beside the job. `warning TEXT` doesn't fail the step, `fail TEXT` does.
warning() { printf '::warning::%s\n' "$*"; }
fail() {
  printf '::error::%s\n' "$*"
  exit 2
}

# output NAME VALUE: an output of the step, of one line.
output() { printf '%s=%s\n' "$1" "${2//$'\n'/ }" >> "${GITHUB_OUTPUT:?the runner sets it}"; }

# api METHOD PATH [FILE]: a request to GitHub with the body of a file; prints the answer.
api() {
  local body=()
  if (($# == 3)); then body=(--data-binary "@$3"); fi
  curl --silent --show-error --fail-with-body --max-time 60 --request "$1" "${body[@]}" \
    --header "Authorization: Bearer ${TOKEN:?the input token}" --header "Accept: application/vnd.github+json" \
    "${GITHUB_API_URL:?the runner sets it}/repos/${GITHUB_REPOSITORY:?the runner sets it}/$2"
}
