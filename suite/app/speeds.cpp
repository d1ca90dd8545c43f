#include "suite/app/speeds.h"

#include <fmt/format.h>

#include <cstdio>

namespace physinv {

Trials known_speeds() {
  Trials trials;
  if (!trials.warning().empty()) fmt::print(stderr, "{}\n", trials.warning());
  return trials;
}

}  // namespace physinv
