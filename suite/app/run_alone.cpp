// The verbs of physinv-run.
#include "suite/app/verbs.h"

namespace physinv {

const std::map<std::string, Verb>& verbs() {
  static const std::map<std::string, Verb> run = {{"run", run_verb}};
  return run;
}

}  // namespace physinv
