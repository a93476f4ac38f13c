#!/usr/bin/env bash
# reproducible_test.sh SOURCE WORK: one commit, packaged in two folders with other names and masks of permissions, gives
# packages with the same bytes, and no path of either folder is in them.
set -euo pipefail
source=$1 work=$2
rm -rf "$work"
mkdir -p "$work/a" "$work/longer/name"
folders=("$work/a" "$work/longer/name")
masks=(022 027)
for i in 0 1; do
  git clone --quiet "$source" "${folders[i]}/rehearse"
  (umask "${masks[i]}" && cd "${folders[i]}/rehearse" && CCACHE_DISABLE=1 tools/package > "$work/log" 2>&1) \
    || { tail -n 40 "$work/log"; exit 1; }
done
status=0
for package in "${folders[0]}"/rehearse/build/packages/*eb; do
  name=$(basename "$package")
  if cmp "$package" "${folders[1]}/rehearse/build/packages/$name"; then
    echo "$name: $(sha256sum < "$package" | cut -c1-16), twice"
  else
    status=1
  fi
  content=$(mktemp --directory)
  dpkg-deb --raw-extract "$package" "$content"
  if grep --recursive --files-with-matches --fixed-strings "$work" "$content"; then
    echo "$name names the folder in which it was built"
    status=1
  fi
  if ! (cd "$content" && md5sum --quiet --check DEBIAN/md5sums); then status=1; fi
  rm -rf "$content"
done
exit "$status"
