#include "suite/results/nearest.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "suite/core/rng.h"

namespace physinv {
namespace {

TEST(Nearest, FindsTheTypo) {
  const std::vector<std::string> names = {"jpo/billiards/bfgs/n=8/seed=0",
                                          "jpo/waves/bfgs/n=8/seed=0"};
  EXPECT_EQ(nearest_names(names, "biliards").front(), "jpo/billiards");
  EXPECT_EQ(nearest_names(names, "jpo/wave").front(), "jpo/waves");
  // Thousands of sizes of one experiment do not hide another one.
  std::vector<std::string> many;
  for (int n = 0; n < 5000; ++n) many.push_back(fmt::format("a/b/n={}", n));
  many.emplace_back("sip/heat/n=4");
  EXPECT_EQ(nearest_names(many, "sip/haet").front(), "sip/heat");
  EXPECT_TRUE(nearest_names({}, "x").empty());
  EXPECT_FALSE(nearest_names(names, std::string(1'000'000, 'x')).empty());
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
  EXPECT_EQ(edit_distance("kitten", "sitting", 3), 3u);
  EXPECT_GT(edit_distance("kitten", "sitting", 2), 2u);
  EXPECT_GT(edit_distance("kitten", "a kitten's", 3), 3u);
  EXPECT_EQ(nearest_word({"--jobs", "--out"}, "--job"), "--jobs");
  EXPECT_EQ(nearest_word({"--jobs", "--out"}, "--completely-else"), "");
}

/// Row by row, as it is defined.
std::size_t by_table(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({diagonal + 1, row[j - 1] + 1, replaced});
    }
  }
  return row[b.size()];
}

TEST(Nearest, DistancesAreThoseOfTheTable) {
  Stream random = Rng::root("words", 0).stream();
  const auto word = [&](int longest) {
    std::string w(static_cast<std::size_t>(random.uniform(0, longest + 1)),
                  ' ');
    for (char& c : w) c = static_cast<char>('a' + random.uniform(0, 4));
    return w;
  };
  for (int i = 0; i < 3000; ++i) {
    const std::string text = word(90), near = word(64);
    const std::size_t d = by_table(text, near);
    EXPECT_EQ(edit_distance(text, near), d) << text << " " << near;
    for (const std::size_t most : {d + 1, d, d - std::min<std::size_t>(d, 1)}) {
      if (d <= most)
        EXPECT_EQ(edit_distance(text, near, most), d);
      else
        EXPECT_GT(edit_distance(text, near, most), most);
    }
  }
}

}  // namespace
}  // namespace physinv
