# shellcheck shell=bash
# Sourced by ./bench and ./check: packages, configure, build. Everything here
# writes to stderr and ends in status 9 when the machine, not the suite, is at
# fault: packages missing, configuring failed, the code does not compile.
# When nothing changed since the last build, only find is started.
: "${root:?set by the launcher}"
# cmake and ctest take a checkout's path from it, where it is the same folder:
# through a symbolic link they would see another one, and build all again.
export -n PWD

say() { printf '%s: %s\n' "${0##*/}" "$*" >&2; }
die() { say "$*"; exit 9; }

# lock FILE: held until `unlock`, so that concurrent launchers take turns.
lock() {
  exec {lock_fd}>"$1"
  flock -n "$lock_fd" && return
  say "waiting for another build (${1%/*})"
  flock "$lock_fd"
}
unlock() { exec {lock_fd}>&-; }

# quietly LOG COMMAND...: shows the output only if the command fails.
quietly() {
  local log=$1
  shift
  "$@" >"$log" 2>&1 </dev/null {lock_fd}>&- || { cat "$log" >&2; return 1; }
}

# On ARM the compiler is clang: GCC 12 keeps what is wider than a register, as
# packs of 256 bits are there, in memory.
on_arm() { [[ $HOSTTYPE == aarch64 ]]; }

# packages_of SECTION: sets `packages`.
packages_of() {
  local line in_section=
  packages=()
  while read -r line; do
    case $line in
      '' | '#'*) ;;
      '['*) [[ $line == "[$1]" ]] && in_section=1 || in_section= ;;
      *) [[ -z $in_section ]] || packages+=("$line") ;;
    esac
  done <"$root/apt-packages.txt"
  ! on_arm || case $1 in
    bench) packages+=(clang) ;;
    test) packages+=(libclang-rt-dev) ;;  # its sanitizers
  esac
}

# need SECTION: installs what the machine lacks. The stamp holds the list that
# was last found complete; a failed build removes it.
need() {
  local stamp=$root/build/.packages-$1 known=
  packages_of "$1"
  [[ -r $stamp ]] && read -r known <"$stamp"
  [[ $known == "${packages[*]}" ]] && return
  command -v dpkg-query >/dev/null ||
    { say "not a Debian system: assuming that the packages of [$1] are installed"; return; }

  mkdir -p "$root/build"
  lock "$root/build/.lock"
  local installed missing=() package
  installed=$(dpkg-query -W -f='${db:Status-Status} ${Package}\n' \
    "${packages[@]}" 2>/dev/null) || true
  for package in "${packages[@]}"; do
    [[ $'\n'$installed$'\n' == *$'\n'"installed $package"$'\n'* ]] ||
      missing+=("$package")
  done
  [[ ${#missing[@]} -eq 0 ]] || install "${missing[@]}"
  printf '%s\n' "${packages[*]}" >"$stamp"
  unlock
}

install() {
  local apt=(apt-get -y --no-install-recommends install "$@") as_root=()
  local hint="packages are missing; run: sudo ${apt[*]}"
  if [[ $EUID -ne 0 ]]; then
    command -v sudo >/dev/null || die "$hint"
    [[ -t 0 ]] || sudo -n true 2>/dev/null || die "$hint"
    as_root=(sudo)
  fi
  as_root+=(env DEBIAN_FRONTEND=noninteractive)
  say "installing $*"
  local log=$root/build/apt.log
  "${as_root[@]}" "${apt[@]}" >"$log" 2>&1 </dev/null ||
    { "${as_root[@]}" apt-get update &&
      "${as_root[@]}" "${apt[@]}"; } >>"$log" 2>&1 </dev/null ||
    { tail -n 5 "$log" >&2; die "$hint"; }
}

# configure TREE ON|OFF: once, and again when tests are wanted for the first
# time. A tree that was copied or moved with its checkout is made again.
configure() {
  local tree=$1 tests=$2 known_tests='' known_root=''
  [[ ! -r $tree/.configured ]] ||
    read -r known_tests known_root <"$tree/.configured"
  if [[ $known_root != "$root" ]]; then
    rm -rf "$tree"/{CMakeCache.txt,CMakeFiles,build.ninja}
  elif [[ -e $tree/build.ninja && ($known_tests == ON || $tests == OFF) ]]; then
    return
  fi
  say "configuring ${tree#"$root/"}"
  local compiler=()
  ! on_arm || compiler=(-DCMAKE_CXX_COMPILER=clang++)
  quietly "$tree/configure.log" cmake -S "$root" --preset "${tree##*/}" \
    -DPHYSINV_TESTS="$tests" "${compiler[@]}" || build_failed
  printf '%s\n' "$tests $root" >"$tree/.configured"
}

# is_built TREE PROGRAM...: are they as `built` noted them, and is nothing newer that
# a build reads? Sources, git's present commit, the tree's configuration, the machine's
# headers by its packages. Ninja would look at each of its thousands of files.
is_built() {
  local tree=$1 git=$root/.git known='' file
  shift
  local stamp="$tree/.built-$*"
  [[ -r $stamp ]] && read -r known <"$stamp" && [[ $known == "$root" ]] || return
  [[ -e /var/lib/dpkg/status ]] || return  # no Debian: ninja looks
  for file; do [[ -x $tree/$file ]] || return; done
  if [[ -f $git ]]; then  # of a linked worktree
    read -r _ git <"$git"
    [[ $git == /* ]] || git=$root/$git
  fi
  for file in "$git"{,/HEAD,/logs/HEAD,/packed-refs} "$tree/build.ninja" \
    /var/lib/dpkg/status; do
    [[ ! $file -nt $stamp ]] || return
  done
  [[ -z $(find "$root" /usr/local/include \
    \( -path "$root/build" -o -path "$root/results" -o -name .git \) -prune \
    -o -newer "$stamp" -print -quit 2>/dev/null) ]]
}
# built TREE PROGRAM...: by what was there when `begin TREE` was called.
begin() { printf '%s\n' "$root" >"$1/.begun"; }
built() { mv "$1/.begun" "$1/.built-${*:2}"; }

# build TREE [TARGET...]: one moving line on a terminal, one line elsewhere;
# warnings and errors in full.
build() {
  local tree=$1
  shift
  NINJA_STATUS='[%f/%t] ' ninja -C "$tree" "$@" 2>&1 {lock_fd}>&- |
    show_progress >&2 || build_failed
}
show_progress() {
  local line announced=
  while IFS= read -r line; do
    case $line in
      'ninja: no work to do.' | 'ninja: Entering directory'* | '-- '*) ;;
      '['*'] Re-running CMake'* | '[0/'*'Re-checking globbed'*) ;;
      '['*/*']'*)
        if [[ -t 1 ]]; then
          printf '\r\e[K%.79s' "$line"
        elif [[ -z $announced ]]; then
          line=${line%%]*}
          say "building ${line#*/} steps"
        fi
        announced=1
        ;;
      *) printf '%s\n' "$line" ;;
    esac
  done
  [[ -z $announced || ! -t 1 ]] || printf '\r\e[K'
}
build_failed() {
  rm -f "$root"/build/.packages-*
  die "the build failed, see above"
}
