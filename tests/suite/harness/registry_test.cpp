#include "suite/harness/registry.h"

#include <gtest/gtest.h>

#include <set>

#include "suite/harness/errors.h"
#include "suite/harness/registry_errors.h"
#include "tests/suite/harness/fake_experiment.h"

namespace physinv {
namespace {

Registry fake_registry() {
  Registry r;
  r.add(fake::experiment());
  return r;
}

/// The complaint about the fake experiment after `change`.
template <class F>
std::string complaint(F change) {
  Experiment e = fake::experiment();
  change(e);
  Registry r;
  r.add(std::move(e));
  const auto lines = r.problems();
  return lines.empty() ? "" : lines.front();
}

TEST(Registry, AcceptsTheFake) {
  EXPECT_TRUE(fake_registry().problems().empty());
  EXPECT_NO_THROW(fake_registry().validate());
}

TEST(Registry, NamesBothSetsOfACaseThatCannotWork) {
  const std::string text =
      complaint([](Experiment& e) { e.problem.provided = Needs::forward; });
  EXPECT_EQ(text,
            "fake/cubic: method descend needs forward|vjp, problem cubic "
            "provides forward");
}

TEST(Registry, FindsWhatIsWrong) {
  EXPECT_NE(complaint([](Experiment& e) { e.name = "Fake cubic"; }), "");
  EXPECT_NE(complaint([](Experiment& e) { e.methods[0].id = "a/b"; }), "");
  EXPECT_NE(complaint([](Experiment& e) { e.methods[1].id = "descend"; }), "");
  EXPECT_NE(complaint([](Experiment& e) { e.methods[0].chain.clear(); }), "");
  EXPECT_NE(complaint([](Experiment& e) {
              e.profiles[0].rows[0].methods = {"nobody"};
            }),
            "");
  EXPECT_NE(complaint([](Experiment& e) { e.profiles[0].rows[0].n = {}; }), "");
  EXPECT_NE(complaint([](Experiment& e) {  // the same cases, other iterations
              e.profiles[0].rows.push_back(e.profiles[0].rows[0]);
              e.profiles[0].rows.back().iterations = 77;
            }),
            "");
  EXPECT_EQ(complaint([](Experiment& e) {
              e.problem.source = "problems/cubic/cubic.h";
            }),
            "fake/cubic: there is no source 'problems/cubic/cubic.h'");
  Registry twice = fake_registry();
  twice.add(fake::experiment());
  EXPECT_THROW(twice.validate(), std::logic_error);
}

TEST(Registry, AStartLooksAtTheExperimentsOfItsCases) {
  Experiment broken = fake::experiment();
  broken.name = "fake/broken";
  broken.problem.provided = Needs::forward;
  Registry r = fake_registry();
  r.add(std::move(broken));
  std::vector<Case> sound, all = r.expand("smoke");
  for (const Case& c : all)
    if (c.info.experiment == "fake/cubic") sound.push_back(c);
  ASSERT_LT(sound.size(), all.size());
  EXPECT_NO_THROW(validate(r, sound));
  try {
    validate(r, all);
    ADD_FAILURE() << "what cannot work is run";
  } catch (const std::logic_error& e) {
    EXPECT_TRUE(std::string(e.what()).starts_with(
        "fake/broken: method descend needs forward|vjp, problem cubic provides "
        "forward"))
        << e.what();
  }
  r.add(fake::experiment());  // a name that two have belongs to neither
  EXPECT_THROW(validate(r, sound), std::logic_error);
}

Claim claim_on(Select select) {
  return {.id = "R1",
          .from = "smoke",
          .says = "s",
          .conditions = {reported("x", median(std::move(select), {}))}};
}

/// The complaint about such a claim.
std::string complaint_of(const Claim& claim) {
  return complaint([&](Experiment& e) { e.claims = {claim}; });
}

TEST(Registry, ChecksWhatClaimsAskFor) {
  EXPECT_EQ(complaint_of(claim_on({"walk", "refine"})), "");
  const auto asks = [](const char* what) {
    return std::string("fake/cubic: claim R1 needs ") + what;
  };
  EXPECT_EQ(complaint_of(claim_on({"wlak"})),
            asks("the unknown method 'wlak' of fake/cubic"));
  EXPECT_EQ(complaint_of(claim_on({"walk", "train"})),
            asks("the unknown stage 'train' of walk"));
  EXPECT_EQ(complaint_of(claim_on(Select{"walk"}.in("fake/quartic"))),
            asks("the unknown experiment 'fake/quartic'"));
  name_elsewhere({"fake/quartic", "other/*"});
  EXPECT_EQ(complaint_of(claim_on(Select{"walk"}.in("fake/quartic"))), "");
  EXPECT_EQ(complaint_of(claim_on(Select{"walk"}.in("other/cubic"))), "");
  EXPECT_EQ(complaint_of(claim_on(Select{"walk"}.in("fake/quintic"))),
            asks("the unknown experiment 'fake/quintic'"));
  name_elsewhere({});
  EXPECT_EQ(
      complaint_of(claim_on(Select{"walk"}.of_sizes(1000))),
      asks("'walk, n >= 1000', which neither profile smoke nor a later one "
           "runs"));
  Claim late = claim_on({"descend"});
  late.from = "yearly";
  EXPECT_EQ(complaint_of(late),
            "fake/cubic: claim R1 is judged from the unknown profile 'yearly'");
}

TEST(Registry, JoinsClaimsAndReportsOfOtherFiles) {
  const auto report = [](const Evidence&) {
    return Section{.title = "from elsewhere"};
  };
  for (const bool first : {true, false}) {
    Registry r;
    if (!first) r.add(fake::experiment());
    r.add_claims("fake/cubic", {claim_on({"descend"})});
    r.add_report("fake/cubic", report);
    if (first) r.add(fake::experiment());
    EXPECT_TRUE(r.problems().empty());
    EXPECT_EQ(r.find("fake/cubic")->claims.size(), 1U);
    EXPECT_EQ(r.find("fake/cubic")->report({{}, {}, "fake/cubic"}).title,
              "from elsewhere");
  }
  Registry alone;
  alone.add_claims("fake/quartic", {claim_on({"descend"})});
  EXPECT_EQ(alone.problems().size(), 1U);
}

TEST(Registry, ExpandsInDeclaredOrder) {
  const auto cases = fake_registry().expand("quick");
  ASSERT_EQ(cases.size(), 18u);
  EXPECT_EQ(cases[0].info.name, "fake/cubic/descend/n=4/seed=0");
  EXPECT_EQ(cases[1].info.name, "fake/cubic/descend/n=4/seed=1");
  EXPECT_EQ(cases[3].info.name, "fake/cubic/walk/n=4/seed=0");
  EXPECT_EQ(cases[9].info.name, "fake/cubic/descend/n=9/seed=0");
  EXPECT_EQ(cases[3].info.stages, (std::vector<std::string>{"fit", "refine"}));
  EXPECT_EQ(cases[3].stage_iterations, (std::vector<Index>{40, 40}));
  EXPECT_GT(cases[3].operations(0), 0);
}

TEST(Registry, ProfilesAreInTheOrderOfAllExperiments) {
  Registry r;
  const auto add = [&](const char* name, std::vector<Profile> profiles) {
    r.add(Experiment{.name = name, .profiles = std::move(profiles)});
  };
  add("a", {{.name = "smoke"}, {.name = "quick"}, {.name = "paper"}});
  add("b", {{.name = "study"}});
  add("c", {{.name = "quick"}, {.name = "standard"}, {.name = "paper"}});
  add("d", {{.name = "paper"}, {.name = "long"}, {.name = "longer"}});
  EXPECT_EQ(
      r.profiles(),
      (std::vector<std::string>{
          "smoke", "quick", "standard", "paper", "study", "long", "longer"}));
}

TEST(Registry, CollapsesDuplicates) {
  Experiment e = fake::experiment();
  e.profiles[0].rows.push_back(e.profiles[0].rows[0]);
  Registry r;
  r.add(std::move(e));
  EXPECT_EQ(r.expand("smoke").size(), fake_registry().expand("smoke").size());
}

TEST(Registry, OverridesKeysOfRows) {
  Overrides o;
  o.n = {2, 3};
  o.seeds = {7};
  o.methods = {"walk", "descend"};
  o.iterations = 5;
  o.precision = Precision::f64;
  const auto cases = fake_registry().expand("smoke", o);
  ASSERT_EQ(cases.size(), 4u);
  EXPECT_EQ(cases[0].info.name, "fake/cubic/walk/n=2/precision=f64/seed=7");
  // A method without a choice of precision does not show one.
  EXPECT_EQ(cases[1].info.name, "fake/cubic/descend/n=2/seed=7");
  EXPECT_EQ(cases[0].stage_iterations[0], 5);
}

TEST(Registry, RefusesWhatIsUnknown) {
  const Registry r = fake_registry();
  EXPECT_THROW(r.expand("enormous"), UsageError);
  EXPECT_THROW(r.expand("smoke", {.methods = {{"magic"}}}), UsageError);
  EXPECT_THROW(r.expand("smoke", {.methods = {}, .n = {{0}}}), UsageError);
}

}  // namespace
}  // namespace physinv
