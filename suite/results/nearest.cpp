#include "suite/results/nearest.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <set>
#include <utility>

namespace physinv {
namespace {

constexpr std::size_t kLongest = 64;  ///< of a word; bits of a column
constexpr std::size_t kMostCompared = 1000;

/// Distances to one word.
class Distance {
 public:
  explicit Distance(std::string_view word)
      : size_(std::min(word.size(), kLongest)) {
    for (std::size_t i = 0; i < size_; ++i)
      places_[static_cast<unsigned char>(word[i])] |= std::uint64_t{1} << i;
  }

  std::size_t operator()(std::string_view text, std::size_t most) const {
    if (std::max(text.size(), size_) - std::min(text.size(), size_) > most)
      return most + 1;
    if (size_ == 0) return text.size();
    // Where a column grows and falls from one place of the word to the next.
    std::uint64_t grows = ~std::uint64_t{0}, falls = 0;
    const std::uint64_t last = std::uint64_t{1} << (size_ - 1);
    std::size_t distance = size_, left = text.size();
    for (const char c : text) {
      const std::uint64_t same = places_[static_cast<unsigned char>(c)];
      const std::uint64_t kept = same | falls;
      const std::uint64_t chained = (((same & grows) + grows) ^ grows) | same;
      std::uint64_t up = falls | ~(chained | grows), down = grows & chained;
      if ((up & last) != 0) ++distance;
      if ((down & last) != 0) --distance;
      if (distance > most + --left) return most + 1;
      up = up << 1 | 1, down <<= 1;
      grows = down | ~(kept | up), falls = up & kept;
    }
    return distance;
  }

 private:
  std::size_t size_;
  std::array<std::uint64_t, 256> places_{};  ///< of each character, as bits
};

/// The `count` nearest of what is offered, the nearest first; of those at the
/// same distance in the order of their names, each once.
class Nearest {
 public:
  Nearest(std::string_view word, std::size_t count)
      : distance_(word), count_(count) {}

  /// `name` is as near as the nearest of `texts`.
  void offer(std::string_view name,
             std::initializer_list<std::string_view> texts) {
    std::size_t least = most() + 1;
    for (const auto text : texts)
      least = std::min(least, distance_(text, least - 1));
    if (least > most()) return;
    best_.emplace(least, name);
    if (best_.size() > count_) best_.erase(std::prev(best_.end()));
  }
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& [distance, name] : best_) all.emplace_back(name);
    return all;
  }

 private:
  /// What still has a place.
  std::size_t most() const {
    return best_.size() < count_ ? std::numeric_limits<std::size_t>::max() / 2
                                 : best_.rbegin()->first;
  }

  Distance distance_;
  std::size_t count_;
  std::set<std::pair<std::size_t, std::string>> best_;
};

}  // namespace

std::size_t edit_distance(std::string_view text,
                          std::string_view word,
                          std::size_t most) {
  return Distance(word)(text, most);
}

std::vector<std::string> nearest_names(const std::vector<std::string>& names,
                                       std::string_view pattern,
                                       std::size_t count) {
  Nearest nearest(pattern, count);
  // Beginnings of paths, the shortest of all names first.
  std::set<std::string_view> seen;
  std::vector<std::size_t> begins(names.size(), 0);
  for (bool longer = true; longer;) {
    longer = false;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const std::string_view name = names[i];
      if (begins[i] > name.size()) continue;
      if (seen.size() >= kMostCompared) return nearest.names();
      const std::size_t begin = begins[i];
      const std::size_t end = std::min(name.find('/', begin), name.size());
      const auto head = name.substr(0, end);
      if (seen.insert(head).second)
        nearest.offer(head, {head.substr(begin), head});
      begins[i] = end + 1;
      longer = true;
    }
  }
  return nearest.names();
}

std::vector<std::string> nearest_words(const std::vector<std::string>& known,
                                       std::string_view word,
                                       std::size_t count) {
  Nearest nearest(word, count);
  for (const auto& k : known) nearest.offer(k, {k});
  return nearest.names();
}

std::string nearest_word(const std::vector<std::string>& known,
                         std::string_view word) {
  if (word.size() > kLongest) return {};
  const Distance distance(word);
  std::string best;
  std::size_t least = std::max<std::size_t>(2, word.size() / 2) + 1;
  for (const auto& k : known) {
    const std::size_t d = distance(k, least);
    if (d < least) least = d, best = k;
  }
  return best;
}

}  // namespace physinv
