// Every number in the causes of claims.md says where it comes from.
#include "suite/evidence/cause_numbers.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "suite/evidence/bare_numbers.h"
#include "suite/harness/judge.h"
#include "suite/harness/registry.h"

namespace physinv::test {
namespace {

using Kind = CauseNumber::Kind;

/// Experiments and papers that have claims.
std::map<std::string, std::vector<Claim>> all_claims() {
  std::map<std::string, std::vector<Claim>> all;
  for (const auto& e : registry().experiments()) all[e->name] = e->claims;
  for (const Overview& o : registry().overviews()) all[o.paper] = o.claims;
  return all;
}

/// Do labels of the experiment's claims have these words?
bool names(const std::vector<Claim>& claims, const std::string& words) {
  return std::any_of(claims.begin(), claims.end(), [&](const Claim& claim) {
    return std::any_of(claim.conditions.begin(),
                       claim.conditions.end(),
                       [&](const Condition& c) {
                         return c.label.find(words) != std::string::npos;
                       });
  });
}

TEST(CauseNumbers, SayWhereTheyComeFrom) {
  const auto all = all_claims();
  std::map<Kind, int> counts;
  for (const auto& [name, claims] : all) {
    for (const Claim& claim : claims) {
      for (const BareNumber& bare : bare_numbers(claim.cause.why))
        ADD_FAILURE() << name << " " << claim.id << ": nothing says where "
                      << bare.text << " in its cause comes from";
      for (const CauseNumber& n : claim.cause.numbers) {
        ++counts[n.kind];
        if (n.kind != Kind::setting || n.of.empty()) continue;
        const auto study = all.find(n.of);
        EXPECT_TRUE(study != all.end() && names(study->second, n.text))
            << name << " " << claim.id << ": no label of " << n.of
            << " has the setting " << n.text;
      }
    }
  }
  for (const auto& [kind, word] : {std::pair{Kind::evidence, "evidence"},
                                   {Kind::printed, "printed"},
                                   {Kind::setting, "setting"},
                                   {Kind::count, "count"}}) {
    EXPECT_GT(counts[kind], 0) << word;
    fmt::print("{}: {}\n", word, counts[kind]);
  }
}

}  // namespace
}  // namespace physinv::test
