/// Guessing: each problem's estimate is the solution of another one, drawn from
/// the same distribution by a separate set. What a method must beat to have
/// seen the observations at all. Stage `solve`.
#pragma once

#include <memory>

#include "suite/core/method.h"

namespace physinv {

std::shared_ptr<const Stage> prior_guess();

}  // namespace physinv
