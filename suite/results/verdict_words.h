/// The words and signs of verdicts on claims: whatever prints, draws, stores or
/// reads a verdict takes them from here.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "suite/results/report_model.h"

namespace physinv {

/// In the order in which they are counted.
inline constexpr std::array kVerdicts{Verdict::reproduced,
                                      Verdict::not_reproduced,
                                      Verdict::not_judged,
                                      Verdict::reported};
static_assert(kVerdicts.size() == kVerdictCount);

/// Of the paper's claims `reproduced`, `not reproduced`, of the suite's ranges
/// `holds`, `fails`; of both `not judged`, `reported`.
std::string_view words_of(Verdict verdict, Origin origin);

/// One character each: ✓ ✗ – ·
std::string_view mark_of(Verdict verdict);

/// What the words of either origin say; nothing if they are no verdict.
std::optional<Verdict> verdict_of(std::string_view words);

}  // namespace physinv
