# shellcheck shell=bash
# find_folder ARGUMENTS: sets `folder` to the folder of suite/cases that has all
# experiments which a run with these arguments can choose, and all that its
# results hold so far, by the list experiments.def; and `filter` to what chooses
# the same in any program, as a word means nothing without the other papers.
# `folder` is empty where more than one has them, and where there is a doubt:
# another verb, a flag that is not listed here, several filters, an expression
# that does not begin with the name of an experiment.
: "${root:?set by who sources this}"

find_folder() {
  local argument profile=quick out='' line names name all=()
  folder='' filter=''
  [[ -z ${!BENCHMARK_*}${PHYSINV_PLUGINS:-} ]] || return 0
  [[ ${1:-} != run ]] || shift
  for argument; do
    case $argument in
      --filter=*) [[ -z $filter ]] || return 0; filter=${argument#*=} ;;
      --profile=smoke | --profile=quick | --profile=paper)
        profile=${argument#*=} ;;
      --out=?*) out=${argument#*=} ;;
      --set=* | --seeds=* | --jobs=* | -j[0-9]* | --threads=* | --trace | \
        --time-budget=* | --checkpoint=* | --resume | --fresh | --dry-run | \
        -q | --quiet | --report | --no-report) ;;
      *) return 0 ;;
    esac
  done

  # A word is a whole part of the name of a paper's experiment; an expression
  # begins with such a name.
  local word='' begin='' rest='' found='' part='[A-Za-z0-9_=.-]'
  if [[ $filter =~ ^[A-Za-z0-9][A-Za-z0-9_=-]*$ ]]; then
    word=$filter
  elif [[ ${filter#^} =~ ^([a-z]+/[a-z0-9-]+)((/($part|\($part*(\|$part*)*\))*)*)\$?$ ]]; then
    begin=${BASH_REMATCH[1]} rest=${BASH_REMATCH[2]}
  else
    return 0
  fi
  while IFS='"' read -r _ line _ _ _ names _; do
    read -ra names <<<"$names"
    for name in "${names[@]}"; do
      can_choose || continue
      [[ -z $found || $found == "$line" ]] || return 0
      found=$line all=("${names[@]}")
      [[ -z $word ]] || filter=^$name/
    done
  done <"$root/suite/cases/common/experiments.def"
  [[ $filter != *'*'/ ]] && results_are_of "${out:-results/$profile}" "${all[@]}" ||
    return 0
  # shellcheck disable=SC2034 # read by the caller
  folder=$found
}

# Can `word`, or `begin` and `rest`, choose cases of an experiment called `name`?
# One with a star stands for all that begin so.
# shellcheck disable=SC2053,SC2154
can_choose() {
  if [[ -n $word ]]; then
    [[ $name != @(matrix|numerics|studies)/* && ${name%%/*}/$word == $name ]]
  else
    [[ $begin == $name || -z $rest && $name == "$begin"* ]]
  fi
}

# results_are_of DIR NAME...: a page is of all that the results hold, by names
# such as jpo+billiards+bfgs+n=8+seed=0.h5.
results_are_of() {
  local file name
  for file in "$1"/cases/*; do
    [[ -e $file ]] || continue
    for name in "${@:2}"; do
      # shellcheck disable=SC2053
      [[ ${file##*/} != ${name//\//+}+* ]] || continue 2
    done
    return 1
  done
}
