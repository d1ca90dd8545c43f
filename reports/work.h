/// What stages did, in words.
#pragma once

#include <string>
#include <string_view>

#include "suite/results/report_model.h"

namespace physinv {

/// Text as Markdown or HTML.
using Writing = std::string (*)(std::string_view text);

/// "Work: 49 simulations. Saved: 7 encodings of inputs. Given up: .. Not
/// counted: `skipped_terms`." What an earlier campaign did not count is not 0.
std::string work_text(const Counts& counts, Writing words, Writing code);

}  // namespace physinv
