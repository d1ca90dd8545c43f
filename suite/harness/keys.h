/// Content keys: what decides a stage's result, as 32 hexadecimal digits.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "suite/harness/case.h"
#include "suite/store/plan.h"

namespace physinv {

/// The data of a case, truth included, and their hash.
CaseData draw_data(const Case& c);

/// Text that a stage's results depend on, apart from data and numerics:
/// problem, setting and networks, n, seed, and for this stage and those before
/// it name, options, iterations and (if it matters) precision. The method's id
/// is not part of it: chains with the same beginning share it.
std::string recipe_text(const Case& c, std::size_t position);

/// Stands for the sources and the build that the numbers of a stage and those
/// before it come from.
using Numerics = std::function<std::string(const Case&, std::size_t position)>;

/// One key per stage.
std::vector<std::string> content_keys(const Case& c,
                                      std::string_view data_hash,
                                      const Numerics& numerics);

/// Fingerprint of this build's sources.
std::string numerics_of_build(const Case& c, std::size_t position);
/// The same, found out once for each method, all of which must stay.
Numerics remembered_numerics();

/// What a plan says of cases that it may not have drawn data for.
std::vector<PlannedCase> planned(const std::vector<Case>& cases);

}  // namespace physinv
