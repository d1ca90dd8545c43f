// What a program of contract tests is called in its messages.
#include "suite/app/verbs.h"
#include "suite/harness/outside.h"

namespace physinv {

const Program& program() {
  static const Program tests{.name = outside_program() == nullptr
                                         ? "physinv-conformance"
                                         : outside_program()->name,
                             .verbs = {},
                             .examples = {},
                             .environment = ""};
  return tests;
}

}  // namespace physinv
