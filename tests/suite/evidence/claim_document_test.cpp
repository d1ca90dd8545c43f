#include "suite/evidence/claim_document.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "suite/evidence/bare_numbers.h"
#include "suite/evidence/run_values.h"
#include "suite/evidence/statistics.h"
#include "suite/results/published.h"
#include "tests/suite/evidence/campaigns.h"

namespace physinv {
namespace {

/// Loss 2 of method a, 6 of b, on both seeds.
Results two_methods() {
  std::vector<CaseRecord> cases;
  for (const std::uint64_t seed : {0, 1}) {
    cases.push_back(case_of("a", 2, seed, {"s"}, {stage_of("s", {1, 3})}));
    cases.push_back(case_of("b", 2, seed, {"s"}, {stage_of("s", {5, 7})}));
  }
  for (CaseRecord& c : cases) c.info.profile = "quick";
  return Results(std::move(cases));
}

std::vector<Claim> claims(const std::string& text) {
  ClaimNames names = claim_names();
  names.add("loss", [] { return of_row(losses(), mean_of); });
  names.set("Two", 2);
  names.set("loss_of_run", [](const Run& run) { return run.stage->loss(0); });
  names.add("letters", [](ArrayKey a) { return double(a.name().size()); });
  names.add("refuse", []() -> double { throw std::logic_error("not today"); });
  names.add("pair", [](const Quantity& q) {
    return std::vector{above("one", q, 0), below("two", q, 9)};
  });
  const auto all = read_claims("# toy\n" + text, "claims.md", names);
  EXPECT_EQ(all.size(), 1U);
  return all.empty() ? std::vector<Claim>{} : all.front().claims;
}

Claim claim(const std::string& lines) {
  const auto all = claims("## P1 (Sec. 1)\nIt holds\n\n" + lines);
  return all.empty() ? Claim{} : all.front();
}

ClaimResult judged_claim(const Claim& one) {
  const Results results = two_methods();
  const Published published;
  Claim from_quick = one;
  from_quick.from = "quick";
  return judge({from_quick}, {results, published, "toy"}, {"quick"}).front();
}

/// The value of an expression.
double value(const std::string& expression) {
  const auto r = judged_claim(claim("- v: `" + expression + "`\n"));
  return r.conditions.at(0).value.value_or(-1);
}

std::string error(const std::string& text) {
  try {
    claims(text);
  } catch (const ClaimDocumentError& e) {
    return e.what();
  }
  return "none";
}
std::string error_of_expression(const std::string& expression) {
  return error("## P1 (Sec. 1)\nIt holds\n\n- v: `" + expression + "`\n");
}

TEST(ClaimDocument, HasClaimsWithPlaceProfileNoteAndCause) {
  const auto all = claims(
      "For readers.\n\n- as is this\n\n"
      "## P1 (Sec. 2.1 (b), Fig. 3) from smoke, no gate\nIt holds,\nas long\n"
      "  as it does\n\n- a: `mean(\"a\", loss()) < 3`\n"
      "- long\n  label: `mean(\"b\",\n  loss()) in 1 .. 7`\n\n"
      "Note: Read so,\nand so.\n\nWeaker: by {\"a\"}\n\n- b: `Two > 1`\n\n"
      "## A1\nAnother\n\n- a: `Two`\n\n"
      "## A2 no gate\nOne more\n\nNot run: an hour\n");
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[0].id, "P1");
  EXPECT_EQ(all[0].where, "Sec. 2.1 (b), Fig. 3");
  EXPECT_EQ(all[0].from, "smoke");
  EXPECT_FALSE(all[0].gates);
  EXPECT_EQ(all[0].says, "It holds, as long as it does");
  EXPECT_EQ(all[0].note, "Read so, and so.");
  EXPECT_EQ(all[0].cause.as, Verdict::weaker);
  EXPECT_EQ(all[0].cause.why, "by {\"a\"}");
  ASSERT_EQ(all[0].conditions.size(), 2U);
  EXPECT_EQ(all[0].conditions[1].label, "long label");
  EXPECT_EQ(all[0].conditions[1].bounds, "in 1 .. 7");
  ASSERT_EQ(all[0].cause.shown_by.size(), 1U);
  EXPECT_EQ(all[0].cause.shown_by[0].bounds, "> 1");
  EXPECT_EQ(all[1].origin(), Origin::suite);
  EXPECT_EQ(all[1].conditions[0].bounds, "");
  EXPECT_FALSE(all[2].gates);
  EXPECT_EQ(all[2].cause.as, Verdict::not_judged);
}

/// What the cause says of a claim whose condition `a` fails.
std::string cause(const std::string& text) {
  const auto all = claims(
      "## P1 (Sec. 1) from quick\nIt holds for n = 4\n\n"
      "- a: `mean(\"a\", loss()) > 3`\n\nFails: " +
      text + "\n\n- b: `mean(\"b\", loss())`\n");
  return all.empty() ? "" : judged_claim(all.front()).cause;
}
std::string error_of_cause(const std::string& text) {
  return error(
      "## P1 (Sec. 1)\nIt holds for n = 4\n\n- a: `Two > 3`\n\n"
      "Fails: " +
      text + "\n");
}

TEST(ClaimDocument, FillsInTheNumbersOfACause) {
  EXPECT_EQ(cause("is {\"a\"} and {\"b\"}"), "is 2 and 6");
  EXPECT_EQ(cause("is {percent \"a\"} %"), "is 200 %");
  EXPECT_EQ(cause("is {mean(\"b\", loss()) / mean(\"a\", loss()) of stages}"),
            "is 3");
  EXPECT_EQ(cause("of {runs \"a\"}"), "of 2");
  EXPECT_EQ(cause("is {mean(\"none\", loss()) of stages}"), "is (not run)");
  EXPECT_EQ(cause("with {setting(\"n = 4\")}, not {printed(5.50, \"Table\n"
                  "4\")}, {printed(\"half\", \"Sec. 5\")}"),
            "with n = 4, not 5.50, half");
}

TEST(ClaimDocument, WritesNumbersOfACauseAsInASentence) {
  const auto written = [](const std::string& factor) {
    return cause("{" + factor + " * mean(\"a\", loss()) of stages}");
  };
  EXPECT_EQ(written("28.9489"), "57.9");
  EXPECT_EQ(written("0.11653"), "0.233");
  EXPECT_EQ(written("680.6"), "1,360");
  EXPECT_EQ(written("-6172"), "-12,344");
  EXPECT_EQ(written("499.98"), "1,000");
  EXPECT_EQ(written("0.49999999"), "1");
  EXPECT_EQ(written("2.6e-6"), "5.2e-6");
  EXPECT_EQ(written("1.2345e7"), "2.47e7");
}

TEST(ClaimDocument, NamesWhatIsWrongWithANumberOfACause) {
  EXPECT_EQ(error_of_cause("is {\"c\"}"),
            "claims.md:7:11: the claim has no condition 'c'");
  EXPECT_NE(error_of_cause("is {setting(\"n = 5\")}").find("n = 5"),
            std::string::npos);
  EXPECT_TRUE(error_of_cause("is 12 %").starts_with(
      "claims.md:7:11: the source of '12' is missing"));
  for (const char* text : {"is {2}",
                           "is {2",
                           "is 2}",
                           "is {{2}}",
                           "is {}",
                           "is {printed(2, \"\")}",
                           "is {printed(\"half\", \"\")}",
                           "is {printed(2)}",
                           "is {\"a\" + 1}",
                           "is {mean(\"a\", loss())}",
                           "is {runs 2}",
                           "is {percent 2}"})
    EXPECT_NE(error_of_cause(text), "none") << text;
}

TEST(ClaimDocument, FindsBareNumbers) {
  using Words = std::vector<std::string>;
  const auto bare = [](const char* text) {
    Words all;
    for (const BareNumber& b : bare_numbers(text)) all.push_back(b.text);
    return all;
  };
  EXPECT_EQ(bare("it is 2 (-3e-4 of 5 %)"), (Words{"2", "3e-4", "5"}));
  EXPECT_EQ(bare("P11, x0 and L2 of Tables 4, 5 and Figs. 12b to 13"), Words());
  EXPECT_EQ(bare("Table 4 prints 5; Sec. 3.2: 7"), (Words{"5;", "7"}));
  EXPECT_EQ(bare("in Table 4, 7 % and Table 5 8 %"), (Words{"7", "8"}));
  EXPECT_EQ(bare("Tables 4, 5 6"), Words{"6"});
  EXPECT_EQ(bare("is {printed(5, \"Table 4\")} {\"a 2\"} 3 n=4 \u22655"),
            (Words{"3", "4", "5"}));
  EXPECT_EQ(bare("twice, two-thirds or a tenth; the one that attends"),
            (Words{"twice,", "two-thirds", "tenth;"}));
  EXPECT_EQ(bare_numbers("is -2").front().begin, 4U);
}

TEST(ClaimDocument, ComputesExpressions) {
  EXPECT_EQ(value("1 + 2 * 3 - 8 / 4"), 5);
  EXPECT_EQ(value("(1 + 2) * -3"), -9);
  EXPECT_EQ(value("2.5e1"), 25);
  EXPECT_EQ(value("mean(\"a\", loss())"), 2);
  EXPECT_EQ(value("mean(\"b\", loss()) / mean(\"a\", loss())"), 3);
  EXPECT_EQ(value("mean(\"b\", loss()) - 1"), 5);
  EXPECT_EQ(value("0.5 * mean(\"b\", loss())"), 3);
  EXPECT_EQ(value("least([mean(\"b\", loss()), mean(\"a\", loss())])"), 2);
  EXPECT_EQ(value("median(\"b\", loss() / beside(\"a\", loss()))"), 3);
  EXPECT_EQ(value("median(\"b\", loss_of_run)"), 5);
  EXPECT_EQ(value("letters(\"kept\")"), 4);
}

TEST(ClaimDocument, ReadsEveryRelation) {
  const auto bounds = [](const std::string& relation) {
    return claim("- v: `Two " + relation + "`\n").conditions.at(0).bounds;
  };
  EXPECT_EQ(bounds("> 1"), "> 1");
  EXPECT_EQ(bounds(">= 1"), ">= 1");
  EXPECT_EQ(bounds("< 1"), "< 1");
  EXPECT_EQ(bounds("<= 2 * 3"), "<= 6");
  EXPECT_EQ(bounds("in 1..3"), "in 1 .. 3");
  EXPECT_EQ(bounds("= 2"), "in 2 .. 2");
  EXPECT_EQ(bounds("= 2 +- 0.5"), "in 1.5 .. 2.5");
  EXPECT_EQ(bounds("near 32"), "in 10 .. 102");
  EXPECT_EQ(bounds("about 2"), "about 2");
  EXPECT_EQ(bounds("as stated(2, 4)"), "as printed (2)");
  EXPECT_EQ(bounds("as printed(\"t/x\", 4)"), "as printed (t/x)");
  EXPECT_TRUE(claim("- v: `Two > 1 of stages`\n").conditions.at(0).of_stages);
}

TEST(ClaimDocument, JoinsTextAndNumbersToNames) {
  const auto one = claims(
      "## A1\nSays\n\n- v: `median(\"sip-b\" + 8 + \"-lr\" + 2, "
      "loss())`\n");
  EXPECT_EQ(one.at(0).conditions.at(0).quantities.at(0).runs().at(0).method,
            "sip-b8-lr2");
}

TEST(ClaimDocument, GivesClaimsToEveryExperimentOfAHeading) {
  const auto all = read_claims(
      "# toy\n## P1 (a)\nSays\n\n- v: `1`\n# toy, toy-two\n## P2 (b)\n"
      "Says\n\n- v: `1`\n",
      "claims.md",
      {});
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[0].experiment, "toy");
  EXPECT_EQ(all[1].experiment, "toy");
  EXPECT_EQ(all[2].experiment, "toy-two");
  EXPECT_EQ(all[1].claims.at(0).id, "P2");
  EXPECT_EQ(all[2].claims.at(0).id, "P2");
}

TEST(ClaimDocument, DefinesNamesAndFunctions) {
  const auto one = claims(
      "```claims\nthree = Two +\n  1\nhalf(x) = x / Two\n"
      "mean_loss(m) = mean(m, loss())\n```\n## A1\nSays\n\n"
      "- v: `half(mean_loss(\"b\")) = three`\n");
  ASSERT_EQ(one.size(), 1U);
  EXPECT_EQ(judged_claim(one[0]).verdict, Verdict::reproduced);
}

TEST(ClaimDocument, TakesTheFirstAlternativeThatHolds) {
  const auto r =
      judged_claim(claim("- a: `Two > 3` or b: `Two > 2` or c: `Two > 1`\n"));
  EXPECT_EQ(r.verdict, Verdict::reproduced);
  EXPECT_EQ(r.conditions.at(0).label, "c");
  EXPECT_EQ(claim("- a: `Two > 3`\n  or b: `Two > 2`\n").conditions[0].bounds,
            "> 3, or b > 2");
}

TEST(ClaimDocument, TakesConditionsThatAFunctionMakes) {
  EXPECT_EQ(claim("- `pair(Two)`\n").conditions.size(), 2U);
  const auto seeds =
      claim("- a below b: `below_on_every_seed(\"a\", \"b\", loss())`\n");
  ASSERT_EQ(seeds.conditions.size(), 2U);
  EXPECT_EQ(seeds.conditions[0].label, "a below b, worst seed");
}

TEST(ClaimDocument, ANumberIsKeptByItsLabelWhateverTextIsShown) {
  const Claim before = claim("- old words: `mean(\"a\", loss()) > 1`\n");
  const ClaimResult kept = judged_claim(before);
  const Claim after =
      claim("- new words (kept as old words): `mean(\"a\", loss()) > 1`\n");
  const Results none;
  const Published published;
  const Evidence nothing{none, published, "toy"};
  const ClaimResult again = judge_again(after, kept, {nothing, nothing});
  EXPECT_EQ(again.verdict, Verdict::reproduced);
  EXPECT_EQ(again.evidence, "new words 2 ± 0 (> 1)");
  EXPECT_EQ(judged_claim(after).evidence, again.evidence);
  const Claim renamed = claim("- new words: `mean(\"a\", loss()) > 1`\n");
  EXPECT_EQ(judge_again(renamed, kept, {nothing, nothing}).verdict,
            Verdict::not_judged);
}

TEST(ClaimDocument, ThePageOfClaimsListsEveryName) {
  std::ifstream file(PHYSINV_SOURCE_DIR "/docs/claims.md");
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  for (const std::string& name : claim_names().all())
    EXPECT_NE(page.find("`" + name + "("), std::string::npos) << name;
}

TEST(ClaimDocument, NamesThePlaceOfAnErrorAndWhatWouldBeRight) {
  EXPECT_EQ(error_of_expression("medin(\"a\", loss())"),
            "claims.md:5:7: there is no 'medin'; did you mean median?");
  EXPECT_EQ(error_of_expression("median(\"a\")"),
            "claims.md:5:7: median takes (runs, a value of a run), not (text)");
  EXPECT_EQ(error_of_expression("loss()"),
            "claims.md:5:7: this is a value of a run, a number of the campaign "
            "is needed");
  EXPECT_EQ(error_of_expression("Two > \"x\""),
            "claims.md:5:13: this is text, a number of the campaign is needed");
  EXPECT_EQ(error_of_expression("1 +"),
            "claims.md:5:10: an expression is missing here");
  EXPECT_EQ(error_of_expression("1 2"),
            "claims.md:5:9: '2' is not expected here");
  EXPECT_EQ(error_of_expression("1e999"),
            "claims.md:5:7: 1e999 is outside the range of numbers");
  EXPECT_EQ(error_of_expression("(1"), "claims.md:5:9: ')' is missing here");
  EXPECT_EQ(error_of_expression("Two ; 3"),
            "claims.md:5:11: ';' is not expected here");
  EXPECT_EQ(error_of_expression("\"a\" - 1"),
            "claims.md:5:11: text - a number has no meaning");
  EXPECT_EQ(error_of_expression("1 + refuse()"), "claims.md:5:11: not today");
  EXPECT_EQ(error_of_expression("letters(\"keep\")"),
            "claims.md:5:7: there is no array keep");
  EXPECT_EQ(error_of_expression("Two in 1"),
            "claims.md:5:15: '..' is missing here");
}

TEST(ClaimDocument, NamesThePlaceOfALineThatItCannotRead) {
  EXPECT_EQ(error("## P1 (Sec. 1\nSays\n"),
            "claims.md:2:8: the place in the paper has no end");
  EXPECT_EQ(error("## A1 since quick\nSays\n"),
            "claims.md:2:6: a heading is '## ID (place) from profile, no "
            "gate'");
  EXPECT_EQ(error("## A1\nSays\n\nSays more\n").substr(0, 42),
            "claims.md:5:1: a claim has one sentence; t");
  EXPECT_EQ(error("## A1\nSays\n\n- no code\n"),
            "claims.md:5:3: a condition is 'label: `expression`', with both "
            "backticks");
  EXPECT_EQ(error("## A1\nSays\n\n- a: `1 > 0` and `2 > 1`\n"),
            "claims.md:5:13: 'or' is missing here");
  EXPECT_EQ(error("## A1\nSays\n\n- a:\nb: `1`\n"),
            "claims.md:6:1: a continuation line must be indented");
  EXPECT_EQ(error("```claims\na = 1\n"),
            "claims.md:2:1: this block has no end");
  EXPECT_EQ(error("```claims\nf(x) = f(x)\nb = f(1)\n```\n"),
            "claims.md:3:10: this is nested too deeply");
  EXPECT_EQ(error("```claims\na(x) = x + x + x + x + x + x + x + x + x + x\n"
                  "b = a(a(a(a(\"x\"))))\n```\n"),
            "claims.md:3:10: this text is too long");
}

}  // namespace
}  // namespace physinv
