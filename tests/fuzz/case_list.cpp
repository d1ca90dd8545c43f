#include "suite/app/options.h"
#include "tests/fuzz/inputs.h"
#include "tests/fuzz/readers.h"

namespace physinv::fuzz {

void case_list(std::string_view bytes) {
  Selection selection;
  selection.list = put("cases.txt", bytes).string();
  documented([&] { selection.cases(); });
}

}  // namespace physinv::fuzz
