#include "suite/planning/submission.h"

#include "tests/fuzz/inputs.h"
#include "tests/fuzz/readers.h"

namespace physinv::fuzz {

void submission(std::string_view bytes) {
  const auto path = put("submission/submission.json", bytes);
  documented([&] { states_of(Submission::read(path.parent_path())); });
}

}  // namespace physinv::fuzz
