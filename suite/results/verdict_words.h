/// The words and signs of verdicts on claims: whatever prints, draws, stores or
/// reads a verdict takes them from here.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "suite/results/report_model.h"

namespace physinv {

/// In the order in which they are counted.
inline constexpr std::array kVerdicts{Verdict::reproduced,
                                      Verdict::stronger,
                                      Verdict::weaker,
                                      Verdict::differs,
                                      Verdict::depends,
                                      Verdict::contradiction,
                                      Verdict::not_reproduced,
                                      Verdict::partly_judged,
                                      Verdict::not_judged,
                                      Verdict::reported};
static_assert(kVerdicts.size() == kVerdictCount);

/// How many claims have each.
using VerdictCounts = std::array<int, kVerdictCount>;
/// Those that a table of such counts has columns for: what always is there
/// (reproduced, not reproduced, not judged, reported) and what occurs.
std::vector<Verdict> columns_of(const VerdictCounts& counts);

/// `reproduced`, `differs (stronger)`, `differs (weaker)`, `differs`,
/// `depends`, `contradiction`, `not reproduced`, `partly judged`, `not judged`,
/// `reported`: docs/verdicts.md defines them, of papers' statements and
/// regression checks.
std::string_view words_of(Verdict verdict);

/// One character each: ✓ ↑ ↓ ≈ ? ≠ ✗ ◐ – ·
std::string_view mark_of(Verdict verdict);

/// What the words say, also `holds` and `fails`, which earlier versions wrote
/// for regression checks; nothing if they are no verdict.
std::optional<Verdict> verdict_of(std::string_view words);

/// A condition fails, and the cause says what that is.
bool is_explained(Verdict verdict);

/// In a cause, instead of a number that was not measured.
inline constexpr std::string_view kNumberNotRun = "(not run)";
/// "Cause: the waveform is not printed"; of a claim that holds, that its cause
/// is stale. Empty without one, and if a claim that is not judged lacks numbers
/// of its cause.
std::string cause_text(Verdict verdict, std::string_view cause);

}  // namespace physinv
