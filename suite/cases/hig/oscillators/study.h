/// Batches that the figures of App. C may have been made with.
#pragma once

#include <fmt/format.h>

#include <string>

#include "suite/core/batch.h"

namespace physinv::hig::ablation_batch {

/// Table 2 has 128 for Fig. 2b; the suite's figures have 64.
inline constexpr Index kBatches[] = {128, 64};

/// A study for each; tables of both stand with the first one.
inline std::string name_of(Index batch) {
  return fmt::format("studies/oscillators-batch-{}", batch);
}

}  // namespace physinv::hig::ablation_batch
