/// Files whose checksums of zeros are made right.
#pragma once

#include "tests/fuzz/inputs.h"

namespace physinv::fuzz {

/// A journal: each line has its own.
std::string sealed_lines(std::string_view bytes);
/// A checkpoint: it comes first, over the rest.
std::string sealed_front(std::string_view bytes);
/// A plan: one of its values, over the others.
std::string sealed_plan(std::string_view bytes);
/// A baseline: its last line, over those before.
std::string sealed_end(std::string_view bytes);

}  // namespace physinv::fuzz
