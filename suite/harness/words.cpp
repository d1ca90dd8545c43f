#include "suite/harness/words.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <set>

#include "suite/harness/select.h"

namespace physinv {
namespace {

std::string first_part(const std::string& name) {
  return name.substr(0, name.find('/'));
}

/// What a word may be searched in: all names, and those of papers.
class Names {
 public:
  explicit Names(const std::vector<Case>& cases) {
    std::set<std::string> papers;
    for (const Case& c : cases) {
      all_.push_back(&c.info.name);
      if (is_of_paper(*c.experiment)) papers.insert(first_part(c.info.name));
    }
    papers_.assign(papers.begin(), papers.end());
  }

  bool any(const std::string& pattern) const {
    const NameFilter filter({pattern});
    return std::any_of(all_.begin(), all_.end(), [&](const std::string* name) {
      return filter.matches(*name);
    });
  }

  bool same(const std::string& a, const std::string& b) const {
    const NameFilter one({a}), other({b});
    return std::all_of(all_.begin(), all_.end(), [&](const std::string* name) {
      return one.matches(*name) == other.matches(*name);
    });
  }

  const std::vector<std::string>& papers() const { return papers_; }

 private:
  std::vector<const std::string*> all_;
  std::vector<std::string> papers_;
};

/// In names of papers; `part` searches behind the first part of a name.
template <class First>
std::string in_papers(const Names& names,
                      const std::string& part,
                      First&& is_meant) {
  std::vector<std::string> meant;
  for (const auto& paper : names.papers())
    if (is_meant(paper)) meant.push_back("^" + paper + "/");
  meant.push_back(
      fmt::format("^({})/{}", fmt::join(names.papers(), "|"), part));
  return fmt::format("{}", fmt::join(meant, "|"));
}

/// From what is meant first to what is meant last.
std::vector<std::string> readings(const std::string& word,
                                  const Names& names,
                                  bool all) {
  const std::string whole = fmt::format("(^|/){}(/|$)", word);
  // '.*' keeps it from being read as a word of papers again.
  if (all) return {whole, ".*" + word};
  if (names.papers().empty()) return {whole, word};
  return {in_papers(names,
                    fmt::format("(.*/)?{}(/|$)", word),
                    [&](const std::string& paper) { return paper == word; }),
          whole,
          in_papers(names,
                    ".*" + word,
                    [&](const std::string& paper) {
                      return paper.find(word) != std::string::npos;
                    }),
          word};
}

std::string expression_of(const std::string& filter,
                          const Names& names,
                          bool all) {
  const bool takes_out = filter.starts_with('-');
  const std::string word = takes_out ? filter.substr(1) : filter;
  if (!is_plain_word(word)) return filter;
  for (const auto& reading : readings(word, names, all || takes_out)) {
    if (!names.any(reading)) continue;
    const bool plain = (takes_out || !all) && names.same(reading, word);
    return (takes_out ? "-" : "") + (plain ? word : reading);
  }
  return filter;
}

}  // namespace

bool is_plain_word(std::string_view text) {
  const auto plain = [](unsigned char c) {
    return std::isalnum(c) != 0 && c < 0x80;
  };
  return !text.empty() && plain(static_cast<unsigned char>(text[0])) &&
         std::all_of(text.begin(), text.end(), [&](unsigned char c) {
           return plain(c) || c == '_' || c == '-' || c == '=';
         });
}

bool is_of_paper(const Experiment& experiment) {
  const std::string& paper = experiment.citation.paper;
  return !paper.empty() && experiment.name.starts_with(paper + "/");
}

std::vector<std::string> expressions_of(const std::vector<std::string>& filters,
                                        const std::vector<Case>& cases,
                                        bool all) {
  const bool any = std::any_of(filters.begin(), filters.end(), [](auto& f) {
    return is_plain_word(f.substr(f.starts_with('-') ? 1 : 0));
  });
  if (!any) return filters;
  const Names names(cases);
  std::vector<std::string> expressions;
  for (const auto& filter : filters)
    expressions.push_back(expression_of(filter, names, all));
  return expressions;
}

}  // namespace physinv
