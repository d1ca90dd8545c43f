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
      --filter=libraries | --filter=libraries/* | --filter=^libraries/* | \
        --filter=studies/whose-bfgs* | --filter=^studies/whose-bfgs*)
        # shellcheck disable=SC2034 # read by the caller
        plugin=libraries ;;
    esac
  done
}

# build_plugin TREE NAME: TREE/NAME.so, on what TREE has built. It is a project
# of its own, as anybody's: the suite is installed for it into TREE/prefix. Its
# compiler is that of TREE, whatever $CXX says now; the configuration is fresh,
# as another compiler or another checkout may have left one.
build_plugin() {
  local tree=$1 at=$1/plugins/$2 compiler
  compiler=$(sed -n 's/^CMAKE_CXX_COMPILER:[A-Z]*=//p' "$tree/CMakeCache.txt")
  quietly "$tree/install.log" cmake --install "$tree" --component development \
    --prefix "$tree/prefix" || build_failed
  quietly "$tree/configure.log" cmake --fresh \
    -S "$root/baselines/$2" -B "$at" -G Ninja \
    -DCMAKE_PREFIX_PATH="$tree/prefix" -DCMAKE_CXX_COMPILER="$compiler" \
    -DCMAKE_LIBRARY_OUTPUT_DIRECTORY="$tree" || build_failed
  build "$at"
}
