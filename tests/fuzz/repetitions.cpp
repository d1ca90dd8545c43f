#include "suite/store/repetitions.h"

#include "tests/fuzz/inputs.h"
#include "tests/fuzz/readers.h"

namespace physinv::fuzz {

void repetitions(std::string_view bytes) {
  const auto path = put("repetitions/repetitions.json", bytes);
  documented([&] {
    StageRecord stage{.case_name = "fake/cubic/descend/n=4/seed=0",
                      .stage = "solve",
                      .key = "0123456789abcdef0123456789abcdef"};
    std::vector<CaseRecord> cases = {{.info = {.name = stage.case_name},
                                      .data = {},
                                      .stages = {std::move(stage)}}};
    add_repetitions(cases, read_repetitions(path.parent_path()));
    solving_time(cases[0].stages[0]);
  });
}

}  // namespace physinv::fuzz
