#include "reports/work.h"

#include <fmt/format.h>

#include <cstddef>
#include <utility>

namespace physinv {

std::string work_text(const Counts& counts, Writing words, Writing code) {
  std::string done, saved, given_up, unknown;
  for (std::size_t i = 0; i < kCounters; ++i) {
    const auto c = static_cast<Counter>(i);
    const bool abandoned = kCounterNames[i].starts_with("abandoned_");
    const bool skipped = kCounterNames[i].starts_with("skipped_");
    const auto add = [](std::string& list, const std::string& what) {
      list += (list.empty() ? "" : ", ") + what;
    };
    if (!counts.knows(c)) {
      add(unknown, code(kCounterNames[i]));
    } else if (counts[c] > 0) {
      add(abandoned ? given_up
          : skipped ? saved
                    : done,
          words(fmt::format("{} {}", counts[c], kCounterWords[i])));
    }
  }
  std::string out;
  for (const auto& [head, list] : {std::pair("Work", done),
                                   std::pair("Saved", saved),
                                   std::pair("Given up", given_up),
                                   std::pair("Not counted", unknown)})
    if (!list.empty())
      out += fmt::format("{}{}: {}.", out.empty() ? "" : " ", head, list);
  return out;
}

}  // namespace physinv
