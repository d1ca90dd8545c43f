#!/bin/sh
# cached.sh CCACHE COMPILER ARGUMENTS: removes the precompiled header that is about
# to be written. ccache would take the old one for an input in place of the headers
# in it, and return what another checkout made of other headers.
for argument; do
  case $argument in *.gch) rm -f "$argument" ;; esac
done
exec "$@"
