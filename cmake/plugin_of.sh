# shellcheck shell=bash
# find_plugin ARGUMENTS: sets `plugin` to the folder of baselines whose plug-in
# has the experiments that a filter among these arguments names, and is the
# section of apt-packages.txt with what it needs; empty if no filter names any.
: "${root:?set by who sources this}"

find_plugin() {
  local argument
  plugin=''
  for argument; do
    case $argument in
      --filter=libraries | --filter=libraries/* | --filter=^libraries/*)
        # shellcheck disable=SC2034 # read by who calls this
        plugin=libraries ;;
    esac
  done
}

# build_plugin TREE NAME: TREE/NAME.so, on what TREE has built. It is a project
# of its own, as anybody's: the suite is installed for it into TREE/prefix. Its
# compiler is that of TREE, whatever $CXX says now; what another compiler or
# another checkout left there is made anew.
build_plugin() {
  local tree=$1 at=$1/plugins/$2 from=$root/baselines/$2 compiler
  compiler=$(compiler_of "$tree")
  if [[ $(compiler_of "$at") != "$compiler" ]] ||
    ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$from" "$at/CMakeCache.txt"; then
    rm -rf "$at"
  fi
  quietly "$tree/install.log" cmake --install "$tree" --component development \
    --prefix "$tree/prefix" || build_failed
  quietly "$tree/configure.log" cmake -S "$from" -B "$at" -G Ninja \
    -DCMAKE_PREFIX_PATH="$tree/prefix" -DCMAKE_CXX_COMPILER="$compiler" \
    -DCMAKE_LIBRARY_OUTPUT_DIRECTORY="$tree" || build_failed
  build "$at"
}
compiler_of() {
  [[ ! -e $1/CMakeCache.txt ]] ||
    sed -n 's/^CMAKE_CXX_COMPILER:[A-Z]*=//p' "$1/CMakeCache.txt"
}
