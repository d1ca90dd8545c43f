// The HDF5 file of one case, its checksum taken as right: what is read is what
// comes before it.
#include <fmt/format.h>

#include "suite/store/case_file.h"
#include "tests/fuzz/inputs.h"
#include "tests/fuzz/readers.h"

namespace physinv::fuzz {

void hdf5(std::string_view bytes) {
  const std::string name = "jpo/billiards/bfgs/n=4/seed=0";
  const auto sealed = fmt::format("{}physinv:{}", bytes, checksum(bytes));
  StageRecord stage;
  stage.stage = "solve";
  documented([&] {
    const CaseFile file(sealed, "case.h5", name);
    documented([&] { file.data(); });
    documented([&] { file.has_stage(stage, "hash"); });
    documented([&] { file.read_stage(stage, "hash"); });
  });
}

}  // namespace physinv::fuzz
