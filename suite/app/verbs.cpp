#include "suite/app/verbs.h"

namespace physinv {

const std::map<std::string, Verb>& verbs() {
  static const std::map<std::string, Verb> all = {
      {"run", run_verb},
      {"list", list_verb},
      {"plan", plan_verb},
      {"report", report_verb},
      {"results", results_verb},
      {"verify", verify_verb},
      {"merge", merge_verb},
      {"baseline", baseline_verb},
      {"gate", gate_verb},
      {"compare", compare_verb},
      {"export", export_verb},
      {"submit", submit_verb},
      {"status", status_verb},
      {"completion", completion_verb},
      {"kernels", kernels_verb}};
  return all;
}

}  // namespace physinv
