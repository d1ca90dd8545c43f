#include "suite/results/verdict_words.h"

#include <fmt/format.h>

#include <cstddef>

namespace physinv {
namespace {

struct Words {
  std::string_view paper, suite, mark;
  bool always = false;  ///< a column of its own, even if there are none
};

constexpr std::array<Words, kVerdictCount> kWords{{
    {"reproduced", "holds", "✓", true},
    {"differs", "differs", "≈"},
    {"depends", "depends", "?"},
    {"contradiction", "contradiction", "≠"},
    {"not reproduced", "fails", "✗", true},
    {"partly judged", "partly judged", "◐"},
    {"not judged", "not judged", "–", true},
    {"reported", "reported", "·", true},
}};

const Words& all_of(Verdict verdict) {
  return kWords[static_cast<std::size_t>(verdict)];
}

}  // namespace

std::vector<Verdict> columns_of(const VerdictCounts& counts) {
  std::vector<Verdict> columns;
  for (const Verdict v : kVerdicts)
    if (all_of(v).always || counts[static_cast<std::size_t>(v)] > 0)
      columns.push_back(v);
  return columns;
}

std::string_view words_of(Verdict verdict, Origin origin) {
  const Words& words = all_of(verdict);
  return origin == Origin::paper ? words.paper : words.suite;
}

std::string_view mark_of(Verdict verdict) { return all_of(verdict).mark; }

std::optional<Verdict> verdict_of(std::string_view words) {
  for (const Verdict v : kVerdicts)
    if (words == all_of(v).paper || words == all_of(v).suite) return v;
  return {};
}

bool is_explained(Verdict verdict) {
  return verdict == Verdict::differs || verdict == Verdict::depends ||
         verdict == Verdict::contradiction;
}

std::string cause_text(Verdict verdict, std::string_view cause) {
  if (cause.empty()) return "";
  const bool stale = verdict == Verdict::reproduced;
  return fmt::format(
      "{}: {}", stale ? "It holds; its cause is stale" : "Cause", cause);
}

}  // namespace physinv
