#!/usr/bin/env bash
# Debian 12's cross compiler for ARM (cpp-12-aarch64-linux-gnu 12.2.0-14cross1) reads
# headers of the C library from the machine's own /usr/aarch64-linux-gnu/include even
# when it is given --sysroot: that folder stands before SYSROOT/usr/include in the list
# of folders, and the sysroot's headers are never reached. One would expect, as GCC's
# manual says of --sysroot, that SYSROOT takes the place of / for headers. So a program
# may be compiled against one version of the C library and linked with another.
#
# Seen on 2026-11-27:
#   .../aarch64-linux-gnu/include
#   SYSROOT/usr/include
#   features.h of the sysroot: not read
#
# Needs apt-get, dpkg and a Debian 12 for amd64 (libisl23, libmpc3, libmpfr6).
# Status 0: as described. 1: no more.
set -euo pipefail

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
apt-get -qq download cpp-12-aarch64-linux-gnu=12.2.0-14cross1 \
  libc6-dev-arm64-cross=2.36-8cross1 2>/dev/null
for package in *.deb; do dpkg -x "$package" compiler; done

mkdir -p sysroot/usr/include
echo '#define FROM sysroot' >sysroot/usr/include/features.h
printf '#include <features.h>\nfrom FROM\n' >source.h

output=$(compiler/usr/bin/aarch64-linux-gnu-cpp-12 \
  --sysroot="$folder/sysroot" -v source.h 2>&1)
order=$(sed -n '/^#include <...> search starts here/,/^End of search/{/^ /p}' \
  <<<"$output" | sed "s|^ $folder/||")
echo "$order"

own=$(grep -n 'aarch64-linux-gnu/include$' <<<"$order" | head -n1 | cut -d: -f1)
given=$(grep -n '^sysroot/usr/include$' <<<"$order" | cut -d: -f1)
if ((own < given)) && grep -q '^from FROM' <<<"$output"; then
  echo "features.h of the sysroot: not read"
else
  echo "features.h of the sysroot is read now"
  exit 1
fi
