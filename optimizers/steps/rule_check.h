/// Options of update rules that no rule can follow, refused with their names.
#pragma once

#include "optimizers/steps/rule.h"

namespace physinv {

/// Numbers that T can hold, decays in [0, 1), nothing negative but the rate of
/// SGD, which then ascends.
template <class T>
void check_rule(const StepOptions& options);

extern template void check_rule<float>(const StepOptions&);
extern template void check_rule<double>(const StepOptions&);

}  // namespace physinv
