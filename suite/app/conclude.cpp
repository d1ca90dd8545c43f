#include "suite/app/conclude.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "reports/report.h"
#include "reports/statements.h"
#include "suite/app/load.h"
#include "suite/app/sections.h"
#include "suite/app/speeds.h"
#include "suite/core/clock.h"
#include "suite/harness/columns.h"
#include "suite/harness/output.h"
#include "suite/harness/registry.h"
#include "suite/planning/forecast.h"
#include "suite/results/shortened.h"
#include "suite/results/verdict_words.h"
#include "suite/store/folder.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

/// More experiments than this have a line each.
constexpr std::size_t kMostInFull = 6;
/// Of an experiment, its name and the heads included.
constexpr std::size_t kMostLines = 8;
/// Fewer cut words to nothing.
constexpr std::size_t kColumnsOfTable = 60;
/// Of a line, what a condition may take.
constexpr std::size_t kConditionShare = 3;

/// The sections of the run's experiments.
std::vector<const Section*> own_sections(const std::vector<Section>& sections,
                                         const RunEnd& end) {
  std::vector<const Section*> own;
  for (const Section& s : sections)
    if (end.experiments.contains(s.experiment)) own.push_back(&s);
  return own;
}

/// Where no table has room.
std::string in_two_lines(const Statement& s, std::size_t room) {
  const std::string here = s.here.empty() ? "" : s.here + ", ";
  return fmt::format(
      "{} {}\n  {}\n",
      mark_of(s.verdict),
      shortened(s.what, room - 2),
      shortened(fmt::format("{}{}: {}", here, s.paper, words_of(s.verdict)),
                room - 2));
}

std::string more_text(std::size_t more) {
  return more == 0 ? "" : fmt::format("   {} more on the page\n", more);
}

std::string in_full(const Section& section, std::size_t room) {
  const bool narrow = room < kColumnsOfTable;
  const std::size_t most = narrow ? (kMostLines - 1) / 2 : kMostLines - 2;
  auto statements = statements_of(section);
  const std::size_t all = statements.size();
  statements.resize(std::min(all, most));
  const std::size_t more = all - statements.size();
  std::string text =
      fmt::format("{} ({})\n", section.title, section.experiment);
  if (statements.empty()) return text;
  if (narrow) {
    text = shortened(text.substr(0, text.size() - 1), room) + '\n';
    for (const Statement& s : statements) text += in_two_lines(s, room);
    return text + more_text(more);
  }
  Columns table(
      {"<", "<  statement", "measured", "<condition or printed", "<verdict"});
  for (const Statement& s : statements)
    table.add({std::string(mark_of(s.verdict)),
               s.what,
               s.here,
               shortened(s.paper, room / kConditionShare),
               std::string(words_of(s.verdict))});
  return shortened(text.substr(0, text.size() - 1), room) + '\n' +
         table.text(room) + more_text(more);
}

/// "11 of 12 reproduced", of those that are judged; "–" if none is.
std::string checks_text(const VerdictCounts& counts) {
  int judged = 0;
  for (const Verdict v : kVerdicts)
    if (v != Verdict::not_judged && v != Verdict::reported)
      judged += counts[static_cast<std::size_t>(v)];
  if (judged == 0) return "–";
  return fmt::format("{} of {} reproduced",
                     counts[static_cast<std::size_t>(Verdict::reproduced)],
                     judged);
}

/// A line for each: how many statements of the papers have which verdict, and
/// how many regression checks are reproduced.
std::string in_brief(const std::vector<const Section*>& sections,
                     std::size_t room) {
  VerdictCounts all{};
  for (const Section* s : sections) {
    const Tally counts = tally(*s, Origin::paper);
    for (std::size_t k = 0; k < all.size(); ++k) all[k] += counts[k];
  }
  std::vector<std::string> heads = {"<experiment"};
  for (const Verdict v : columns_of(all)) heads.emplace_back(words_of(v));
  heads.emplace_back("regression checks");
  Columns table(heads);
  for (const Section* s : sections) {
    std::vector<std::string> row = {s->experiment};
    const Tally counts = tally(*s, Origin::paper);
    for (const Verdict v : columns_of(all))
      row.push_back(std::to_string(counts[static_cast<std::size_t>(v)]));
    row.push_back(checks_text(tally(*s, Origin::suite)));
    table.add(std::move(row));
  }
  return table.text(room);
}

/// Of statements that are not judged, how many need a later profile, and which
/// decides them all; and how many need runs that were left out.
struct Undecided {
  std::size_t later = 0, left_out = 0;
  std::string profile;
};

Undecided undecided_in(const std::vector<const Section*>& sections,
                       const std::string& profile) {
  const auto profiles = registry().profiles();
  const auto rank = [&](const std::string& name) {
    return std::find(profiles.begin(), profiles.end(), name) - profiles.begin();
  };
  Undecided u{.profile = profile};
  for (const Section* s : sections) {
    for (const ClaimResult& c : s->claims) {
      if (c.origin != Origin::paper || c.verdict != Verdict::not_judged)
        continue;
      const bool later = rank(c.from) > rank(profile);
      ++(later ? u.later : u.left_out);
      if (later && rank(c.from) > rank(u.profile)) u.profile = c.from;
    }
  }
  return u;
}

/// What another profile of the same selection takes; nothing if not known.
std::string seconds_text(const RunEnd& end, const std::string& profile) {
  Selection selection = end.selection;
  selection.profile = profile;
  selection.shard.clear();
  auto cases = selection.cases();
  std::erase_if(cases, [&](const Case& c) {
    return !end.experiments.contains(c.info.experiment);
  });
  return about_text(cases, end.jobs, durations_file());
}

std::string undecided_text(const RunEnd& end,
                           const std::vector<const Section*>& sections) {
  const Undecided u = undecided_in(sections, end.selection.profile);
  std::string text;
  if (u.later > 0)
    text += fmt::format(
        "to decide the other {} statements of the papers: "
        "--profile={}{}\n",
        u.later,
        u.profile,
        seconds_text(end, u.profile));
  if (u.left_out > 0)
    text += fmt::format(
        "{} statements of the papers need runs that are not selected\n",
        u.left_out);
  return text;
}

std::string no_time_text(const char* what, const RunEnd& end) {
  return fmt::format(
      "not written within the time budget: {}; run ./bench report {}\n",
      what,
      end.out);
}

}  // namespace

void conclude(const RunEnd& end) {
  const double begun = wall_now();
  if (begun > end.until) {
    put(end.screen.stream, no_time_text("the numbers and the page", end));
    return;
  }
  const Loaded loaded = load(end.out, end.screen.stream);
  const Published numbers = printed_numbers();
  const auto sections = sections_of(loaded.results, numbers);
  const auto own = own_sections(sections, end);
  if (own.empty()) return;
  // Pages take once or twice as long as what they show took to read.
  const bool written = 3 * wall_now() - 2 * begun <= end.until;
  const fs::path page = fs::path(end.out) / "report";
  if (written)
    write_report(Folder(end.out).make("report").path(),
                 sections,
                 provenance(loaded, sections, numbers),
                 {.one_file = false, .groups = groups_of(numbers)});
  std::string text;
  if (own.size() > kMostInFull) {
    text = in_brief(own, end.screen.room());
  } else {
    for (const Section* s : own) text += in_full(*s, end.screen.room());
  }
  text += written ? fmt::format("page: {}\n", (page / "index.html").string())
                  : no_time_text("the page", end);
  put(end.screen.stream, text + undecided_text(end, own));
}

}  // namespace physinv
