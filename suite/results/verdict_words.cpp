#include "suite/results/verdict_words.h"

#include <cstddef>

namespace physinv {
namespace {

struct Words {
  std::string_view paper, suite, mark;
};

constexpr std::array<Words, kVerdictCount> kWords{{
    {"reproduced", "holds", "✓"},
    {"not reproduced", "fails", "✗"},
    {"not judged", "not judged", "–"},
    {"reported", "reported", "·"},
}};

const Words& all_of(Verdict verdict) {
  return kWords[static_cast<std::size_t>(verdict)];
}

}  // namespace

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

}  // namespace physinv
