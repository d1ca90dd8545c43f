#include <fmt/format.h>

#include "suite/app/options.h"

namespace physinv {
namespace {

/// Verbs and flags are asked of the program itself, so that they stay true.
constexpr std::string_view kBash =
    R"sh(# source <(physinv-bench completion bash)
_physinv_bench() {
  local program=${COMP_WORDS[0]} word=${COMP_WORDS[COMP_CWORD]} verb=run i words
  for ((i = 1; i < COMP_CWORD; ++i)); do
    [[ ${COMP_WORDS[i]} == -* ]] || { verb=${COMP_WORDS[i]}; break; }
  done
  COMPREPLY=()
  if [[ $word == -* ]]; then
    words=$("$program" "$verb" --list-flags 2>/dev/null)
    COMPREPLY=($(compgen -W "$words" -- "$word"))
  elif ((COMP_CWORD == 1)); then
    words=$("$program" --list-verbs 2>/dev/null)
    COMPREPLY=($(compgen -W "$words" -- "$word"))
  else
    COMPREPLY=($(compgen -f -- "$word"))
  fi
}
complete -o filenames -F _physinv_bench physinv-bench bench
)sh";

constexpr std::string_view kZsh =
    R"sh(#compdef physinv-bench bench
# source <(physinv-bench completion zsh)
_physinv_bench() {
  local verb=run
  (( CURRENT > 2 )) && [[ $words[2] != -* ]] && verb=$words[2]
  if [[ $PREFIX == -* ]]; then
    compadd -- ${(f)"$($words[1] $verb --list-flags 2>/dev/null)"}
  elif (( CURRENT == 2 )); then
    compadd -- ${(f)"$($words[1] --list-verbs 2>/dev/null)"}
  else
    _files
  fi
}
compdef _physinv_bench physinv-bench bench
)sh";

constexpr std::string_view kFish =
    R"sh(# physinv-bench completion fish | source
function __physinv_bench_flags
  set -l words (commandline -opc)
  set -l verb run
  if set -q words[2]; and not string match -q -- '-*' $words[2]
    set verb $words[2]
  end
  $words[1] $verb --list-flags 2>/dev/null
end
complete -c physinv-bench -n __fish_use_subcommand \
  -a '(physinv-bench --list-verbs 2>/dev/null)'
complete -c physinv-bench -n 'string match -q -- "-*" (commandline -ct)' \
  -a '(__physinv_bench_flags)'
)sh";

}  // namespace

ExitCode completion_verb(const Arguments& arguments) {
  std::string shell;
  if (!parse("completion",
             "Prints the completion of verbs, flags and files for a shell.",
             {{"SHELL", "bash, zsh or fish", &shell}},
             arguments))
    return ExitCode::good;
  if (shell != "bash" && shell != "zsh" && shell != "fish")
    throw UsageError(fmt::format(
        "there is no completion for '{}'; known shells: bash, zsh, fish",
        shell));
  fmt::print("{}", shell == "bash" ? kBash : shell == "zsh" ? kZsh : kFish);
  return ExitCode::good;
}

}  // namespace physinv
