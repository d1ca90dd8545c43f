// Arrays by keys of the table, and the table against the page on files.
#include "suite/core/arrays.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <set>
#include <stdexcept>

namespace physinv {
namespace {

template <class Key>
concept Names = requires(Arrays a, const Key& key) {
  a[key];
};
static_assert(!Names<std::string> && !Names<std::string_view>,
              "what is known when it runs says so: ArrayKey::own");

TEST(Arrays, AreFoundByKeysAndStandInTheOrderOfNames) {
  const auto at = [](double value) {
    return Batch<double>::Constant(1, 2, value);
  };
  Arrays arrays = {{"metrics", at(1)}, {"mean_loss", at(2)}};
  arrays[ArrayKey::own("angles")] = at(3);
  EXPECT_EQ(arrays.at("mean_loss")(0), 2);
  EXPECT_EQ(arrays.at(ArrayKey::own("metrics"))(1), 1);
  EXPECT_TRUE(arrays.contains(ArrayKey::own("angles")));
  EXPECT_EQ(arrays.find("rate"), arrays.end());
  EXPECT_THROW(arrays.at("rate"), std::out_of_range);
  std::string names;
  for (const auto& [name, array] : arrays) names += name + ' ';
  EXPECT_EQ(names, "angles mean_loss metrics ");
  EXPECT_EQ(arrays.extract("mean_loss").mapped(), at(2));
  EXPECT_EQ(arrays.size(), 2U);
}

std::string axes(std::string_view name,
                 bool list,
                 const std::set<std::string_view>& all = {}) {
  const ArrayInfo* info = find_array(
      name, list, [&](std::string_view other) { return all.contains(other); });
  return info == nullptr ? "none" : std::string(info->axes);
}

TEST(ArrayTable, TellsMeaningsOfOneNameApart) {
  EXPECT_EQ(axes("kept", true), "updates");
  EXPECT_EQ(axes("kept", true, {"cell"}), "cells");
  EXPECT_EQ(axes("status", false, {"point"}), "cells,checks");
  EXPECT_EQ(axes("status", true, {"cell"}), "cells");
  EXPECT_EQ(axes("status", true), "none");
  EXPECT_EQ(axes("error", true), "samples");
  EXPECT_EQ(axes("error", false, {"point"}), "cells,checks");
  EXPECT_EQ(axes("path", true), "updates");
  EXPECT_EQ(axes("path", false), "points,coordinates");
  EXPECT_EQ(axes("path", true, {"cell"}), "cells");
  EXPECT_EQ(axes("metrics", true), "points,metrics");
  EXPECT_EQ(axes("first_step", false), "none");
  EXPECT_EQ(axes("angles", true), "none");
}

/// The page's lines, in the order of the table.
std::string lines() {
  std::string all;
  for (const ArrayInfo& a : kArrays) {
    std::string meaning;
    for (const char c : a.meaning)
      meaning += c == '|' ? "\\|" : std::string(1, c);
    const std::string beside =
        a.beside.empty() ? "" : fmt::format(" beside `{}`", a.beside);
    all += fmt::format(
        "| `{}`{} | {} | {} | {} |\n", a.name, beside, a.axes, a.unit, meaning);
  }
  return all;
}

TEST(ArrayTable, StandsInThePageOnFiles) {
  std::ifstream in(PHYSINV_SOURCE_DIR "/docs/data.md");
  const std::string page{std::istreambuf_iterator<char>(in), {}};
  const std::string head =
      "| array | axes | unit | content |\n"
      "| --- | --- | --- | --- |\n";
  EXPECT_NE(page.find(head + lines() + "\n"), page.npos)
      << "docs/data.md should have\n"
      << head << lines();
}

TEST(ArrayTable, HasEachMeaningOnce) {
  std::set<std::string> seen;
  for (const ArrayInfo& a : kArrays) {
    EXPECT_TRUE(
        seen.insert(fmt::format("{} {} {}", a.name, a.axes, a.beside)).second)
        << a.name;
    EXPECT_TRUE(a.beside.empty() || find_array(a.beside) != nullptr) << a.name;
    EXPECT_FALSE(a.meaning.empty()) << a.name;
  }
}

}  // namespace
}  // namespace physinv
