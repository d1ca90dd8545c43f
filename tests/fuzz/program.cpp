// The program that reads the command line: over the fake experiment, with one
// verb.
#include "suite/app/verbs.h"
#include "suite/harness/registry.h"
#include "tests/suite/harness/fake_experiment.h"

namespace physinv {
namespace {

const auto kRegistered = register_experiment(fake::experiment());

}  // namespace

const Program& program() {
  static const Program fuzzed{
      .name = "physinv-fuzzed",
      .verbs = {{"run", "[flags]", "run cases", run_verb}},
      .examples = {},
      .environment = ""};
  return fuzzed;
}

}  // namespace physinv
