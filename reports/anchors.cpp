#include "reports/anchors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <climits>
#include <numeric>
#include <set>
#include <utility>

namespace physinv {
namespace {

class Ids {
 public:
  std::string make(const std::string& words) {
    std::string id;
    for (const char c : words) {
      id += std::isalnum(static_cast<unsigned char>(c)) || c == '_' ? c : '-';
    }
    std::string free = id;
    for (int k = 2; !taken_.insert(free).second; ++k) {
      free = fmt::format("{}-{}", id, k);
    }
    return free;
  }

 private:
  // Of the page itself.
  std::set<std::string> taken_{"top", "contents", "provenance"};
};

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)); }
bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)); }

/// Words, numbers and single signs.
std::vector<std::string> tokens_of(std::string_view text) {
  std::vector<std::string> tokens;
  for (std::size_t at = 0; at < text.size();) {
    std::size_t end = at + 1;
    for (const auto is : {is_letter, is_digit})
      if (is(text[at]))
        while (end < text.size() && is(text[end])) ++end;
    tokens.emplace_back(text.substr(at, end - at));
    at = end;
  }
  return tokens;
}

/// "fig", "table", or nothing if the word is neither.
std::string kind_of(const std::string& word) {
  std::string lower;
  for (const char c : word)
    lower += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (lower.starts_with("fig")) return "fig";
  return lower == "table" || lower == "tables" ? "table" : "";
}

}  // namespace

std::vector<Anchors> anchors_of(const std::vector<Section>& sections) {
  Ids ids;
  std::vector<Anchors> all;
  for (const Section& s : sections) {
    Anchors a{.section = ids.make(s.experiment)};
    const auto below = [&](const std::string& id) {
      return ids.make(s.experiment + '-' + id);
    };
    for (const auto& c : s.claims) a.claims.push_back(below(c.id));
    for (const auto& t : s.tables) a.tables.push_back(below(t.id));
    for (const auto& f : s.figures) a.figures.push_back(below(f.id));
    a.statements = below("statements");
    all.push_back(std::move(a));
  }
  return all;
}

std::vector<std::string> places_of(std::string_view text) {
  std::vector<std::string> places;
  std::string kind;
  int last = -1;
  bool to = false;  // a range continues: "8 to 11"
  for (const std::string& token : tokens_of(text)) {
    if (is_digit(token.front())) {
      if (kind.empty() || token.size() > 4) continue;
      const int number = std::stoi(token);
      for (int k = to ? last + 1 : number; k <= number; ++k)
        places.push_back(fmt::format("{} {}", kind, k));
      last = number;
      to = false;
    } else if (token == "to" || token == "-") {
      to = !kind.empty() && last >= 0;
    } else if (token.size() > 1 && token != "and") {
      // A letter alone is a panel's.
      kind = kind_of(token);
      last = -1;
      to = false;
    }
  }
  return places;
}

bool share_place(std::string_view a, std::string_view b) {
  const auto of_a = places_of(a), of_b = places_of(b);
  return std::any_of(of_a.begin(), of_a.end(), [&](const auto& place) {
    return std::find(of_b.begin(), of_b.end(), place) != of_b.end();
  });
}

namespace {

/// Number and letter of the first figure that is named; {INT_MAX, ""} if none
/// is.
std::pair<int, std::string> figure_of(std::string_view where) {
  bool figures = false;
  std::pair<int, std::string> place{INT_MAX, ""};
  for (const std::string& token : tokens_of(where)) {
    if (place.first != INT_MAX) {
      if (token.size() == 1 && is_letter(token.front())) place.second = token;
      return place;
    }
    if (is_letter(token.front()))
      figures = kind_of(token) == "fig";
    else if (figures && is_digit(token.front()) && token.size() <= 4)
      place.first = std::stoi(token);
  }
  return place;
}

}  // namespace

std::vector<std::size_t> order_of(const std::vector<Figure>& figures) {
  std::vector<std::size_t> order(figures.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) {
    const Figure &f = figures[a], &g = figures[b];
    return std::pair(!f.picture, figure_of(f.where)) <
           std::pair(!g.picture, figure_of(g.where));
  });
  return order;
}

}  // namespace physinv
