#include "suite/results/verdict_words.h"

#include <fmt/format.h>

#include <cstddef>

namespace physinv {
namespace {

struct Words {
  std::string_view word, mark;
  bool always = false;  ///< a column of its own, even if there are none
};

constexpr std::array<Words, kVerdictCount> kWords{{
    {"reproduced", "✓", true},
    {"differs (stronger)", "↑"},
    {"differs (weaker)", "↓"},
    {"differs", "≈"},
    {"depends", "?"},
    {"contradiction", "≠"},
    {"not reproduced", "✗", true},
    {"partly judged", "◐"},
    {"not judged", "–", true},
    {"reported", "·", true},
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

std::string_view words_of(Verdict verdict) { return all_of(verdict).word; }

std::string_view mark_of(Verdict verdict) { return all_of(verdict).mark; }

std::optional<Verdict> verdict_of(std::string_view words) {
  if (words == "holds") return Verdict::reproduced;
  if (words == "fails") return Verdict::not_reproduced;
  for (const Verdict v : kVerdicts)
    if (words == all_of(v).word) return v;
  return {};
}

bool is_explained(Verdict verdict) {
  return verdict == Verdict::stronger || verdict == Verdict::weaker ||
         verdict == Verdict::differs || verdict == Verdict::depends ||
         verdict == Verdict::contradiction;
}

std::string cause_text(Verdict verdict, std::string_view cause) {
  if (cause.empty()) return "";
  if (verdict == Verdict::not_judged &&
      cause.find(kNumberNotRun) != std::string_view::npos)
    return "";
  const bool stale = verdict == Verdict::reproduced;
  return fmt::format(
      "{}: {}", stale ? "Reproduced; its cause is stale" : "Cause", cause);
}

}  // namespace physinv
