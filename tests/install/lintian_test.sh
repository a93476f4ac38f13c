#!/usr/bin/env bash
# lintian_test.sh PACKAGES: asks Debian's own checker about each package. Errors fail; warnings are shown.
set -euo pipefail
lintian --fail-on error --no-tag-display-limit --tag-display-limit 0 --suppress-tags initial-upload-closes-no-bugs "$1"/*.deb
# what users download and unpack, without debug symbols
size=$(for package in "$1"/*.deb; do dpkg-deb --field "$package" Installed-Size; done | awk '{ sum += $1 } END { print sum }')
echo "installed: $size kB"
((size < 25000)) || { echo "more than 25 MB"; exit 1; }
