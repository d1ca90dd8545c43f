#!/usr/bin/env bash
# With ccache (Debian 12, 4.8+really4.7.5-1) and GCC 12, an edit of nothing but a comment
# in a precompiled header that says #pragma once breaks the next compilation. ccache is
# set up as its manual asks for precompiled headers (sloppiness pch_defines and
# time_macros, -fpch-preprocess). It strips comments before it hashes, finds the result of
# the header as it was, and restores it; GCC recognizes a header of #pragma once by its
# bytes, which are others now, and reads it a second time: "redefinition". One would
# expect what ccache restores to be as good as what the compiler would make.
# CCACHE_COMMENTS=1 (keep_comments_cpp) avoids it.
#
# Seen on 2026-11-28:
#   first: compiles
#   after the comment was edited: a.h:3:8: error: redefinition of 'struct A'
#   the same with CCACHE_COMMENTS=1: compiles
#
# Needs apt-get, dpkg and a Debian 12 for amd64 with g++ 12 (12.2.0-14+deb12u1).
# Status 0: as described. 1: no more.
set -euo pipefail

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
apt-get -qq download ccache=4.8+really4.7.5-1 libhiredis0.14=0.14.1-3 2>/dev/null
for package in *.deb; do dpkg -x "$package" tools; done
export LC_ALL=C LD_LIBRARY_PATH=$folder/tools/usr/lib/x86_64-linux-gnu
export CCACHE_SLOPPINESS=pch_defines,time_macros

compile() {  # VALUE OF b
  rm -f pch.h.gch
  tools/usr/bin/ccache g++-12 -fpch-preprocess -x c++-header -c pch.h -o pch.h.gch
  printf '#include "a.h"\nA a;\nint b = %s;\n' "$1" >source.cpp
  tools/usr/bin/ccache g++-12 -fpch-preprocess -include pch.h -c source.cpp \
    -o source.o 2>&1 | sed -n '/error/{p;q}' || true
}
header() {  # COMMENT
  printf '#pragma once\n// %s\nstruct A {};\n' "$1" >a.h
  touch -d '5 seconds ago' a.h  # ccache does not trust what is newer
}
edited() {  # CACHE: what the compiler says after the comment's edit
  export CCACHE_DIR=$folder/$1
  echo '#include "a.h"' >pch.h
  touch -d '5 seconds ago' pch.h
  header one
  [[ -z $(compile 1) ]] || return 1
  header two
  compile 2
}

without=$(edited without) || exit 1
kept=$(CCACHE_COMMENTS=1 edited kept) || exit 1
echo "first: compiles"
echo "after the comment was edited: ${without:-compiles}"
echo "the same with CCACHE_COMMENTS=1: ${kept:-compiles}"
[[ $without == *redefinition* && -z $kept ]]
