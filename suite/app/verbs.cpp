#include "suite/app/verbs.h"

#include "suite/app/conclude.h"
#include "suite/harness/outside.h"

namespace physinv {
namespace {

std::vector<Verb> verbs() {
  return {
      kRunVerb,
      {"list", "[FILTER]", "list cases, stages and estimated work", list_verb},
      {"plan", "[FILTER]", "predict time, memory and disk space", plan_verb},
      {"report",
       "RESULTS",
       "write tables, plots and claims of a campaign",
       report_verb},
      {"results", "", "write pages of all published campaigns", results_verb},
      {"reproduce",
       "[CAMPAIGN]",
       "run published campaigns again and compare verdicts",
       reproduce_verb},
      {"history", "", "plot the gate's numbers over commits", history_verb},
      {"verify", "RESULTS", "recompute every final loss", verify_verb},
      {"merge", "OUT SHARD..", "join the results of shards", merge_verb},
      {"baseline",
       "RESULTS",
       "write a campaign's results as a baseline",
       baseline_verb},
      {"gate",
       "[flags]",
       "check for worse results and longer times",
       gate_verb},
      {"compare", "A B..", "compare campaigns", compare_verb},
      {"export", "RESULTS", "convert results for other programs", export_verb},
      {"completion", "SHELL", "print shell completion", completion_verb},
      {"submit", "[flags]", "submit a campaign to Slurm", submit_verb},
      {"status",
       "DIR",
       "print the progress of a submitted campaign",
       status_verb},
      {"conformance",
       "[FILTER]",
       "run contract tests of problems and methods",
       conformance_verb},
      {"kernels",
       "[flags]",
       "run kernel benchmarks (flags of Google Benchmark)",
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
          R"(  PHYSINV_COUNT  the program that gate counts instructions of
  PHYSINV_PUBLISHED_DIR  the papers' numbers (reports/published)
  PHYSINV_SLURM_SECONDS  timeout of sbatch and squeue in seconds (30)
  PHYSINV_NO_REPORT  run writes no page, as with --no-report
)",
      .conclude = conclude};
  return bench;
}

}  // namespace physinv
