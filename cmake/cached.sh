#!/bin/sh
# cached.sh CCACHE COMPILER ARGUMENTS: removes the precompiled header that is about
# to be written. ccache would take the old one for an input in place of the headers
# in it, and return what another checkout made of other headers. Clang is given the
# header as an argument wherever it reads one, too: there it stays.
previous=
for argument; do
  case "$previous $argument" in "-o "*.gch) rm -f "$argument" ;; esac
  previous=$argument
done
exec "$@"
