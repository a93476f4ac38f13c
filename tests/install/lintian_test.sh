#!/usr/bin/env bash
# lintian_test.sh PACKAGES: asks Debian's own checker about each package. Errors fail; warnings are shown.
set -euo pipefail
lintian --fail-on error --no-tag-display-limit --tag-display-limit 0 --suppress-tags initial-upload-closes-no-bugs "$1"/*.deb
# The files of the command and its headers, without debug symbols and the site of rehearse-doc. The field Installed-Size is no measure: CPack adds the size of a
# library for each link to it.
size=$(for package in "$1"/rehearse_*.deb "$1"/rehearse-dev_*.deb; do dpkg-deb --fsys-tarfile "$package" | tar --list --verbose; done \
  | awk '/^-/ { sum += $3 } END { print int(sum / 1000) }')
echo "installed: $size kB"
((size < 25000)) || { echo "more than 25 MB"; exit 1; }
