#include "suite/app/verbs.h"

#include "suite/app/conclude.h"
#include "suite/harness/outside.h"

namespace physinv {
namespace {

std::vector<Verb> verbs() {
  return {
      {"run", "[FILTER]", "run cases (the default verb)", run_verb},
      {"list",
       "[FILTER]",
       "the cases, their stages and estimated work",
       list_verb},
      {"plan", "[FILTER]", "time, memory and disk of a selection", plan_verb},
      {"report",
       "RESULTS",
       "tables, plots and claims of a campaign",
       report_verb},
      {"results", "", "pages of all published campaigns", results_verb},
      {"reproduce",
       "[CAMPAIGN]",
       "run published campaigns again, and what differs",
       reproduce_verb},
      {"history",
       "",
       "the gate's numbers over the commits, as a page",
       history_verb},
      {"verify", "RESULTS", "recompute every final loss", verify_verb},
      {"merge", "OUT SHARD..", "join the results of shards", merge_verb},
      {"baseline",
       "RESULTS",
       "what a campaign came to, as a text for reviews",
       baseline_verb},
      {"gate", "[flags]", "runs a baseline's cases: worse? slower?", gate_verb},
      {"compare",
       "A B..",
       "campaigns side by side, what changed most",
       compare_verb},
      {"export", "RESULTS", "for dashboards and other programs", export_verb},
      {"completion",
       "SHELL",
       "completion for bash, zsh or fish",
       completion_verb},
      {"submit",
       "[flags]",
       "a campaign as an array of Slurm jobs",
       submit_verb},
      {"status", "DIR", "how it stands", status_verb},
      {"conformance",
       "[FILTER]",
       "contract tests over what is registered",
       conformance_verb},
      {"kernels",
       "[flags]",
       "kernel benchmarks (flags of Google Benchmark)",
       kernels_verb}};
}

}  // namespace

const Program& program() {
  static const Program bench{
      .name = outside_program() == nullptr ? "physinv-bench"
                                           : outside_program()->name,
      .verbs = verbs(),
      .examples = {"run billiards",
                   "--profile=paper --filter=billiards --out=results/paper",
                   "list --profile=smoke",
                   "report results/quick"},
      .environment =
          R"(  PHYSINV_COUNT  the program whose instructions gate counts
  PHYSINV_PUBLISHED_DIR  the papers' numbers (reports/published)
  PHYSINV_SLURM_SECONDS  how long sbatch and squeue may take to answer (30)
  PHYSINV_NO_REPORT  run ends without a page, as with --no-report
)",
      .conclude = conclude};
  return bench;
}

}  // namespace physinv
