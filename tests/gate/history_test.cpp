#include "suite/gate/history.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace physinv {
namespace {

PastBaseline baseline(const char* machine, const char* stages, int count) {
  PastBaseline past = past_baseline(
      std::string("physinv-bench baseline 1\nprofile smoke\nmachine ") +
      machine + "\nstages 2\n" + stages +
      "instructions 1 callgrind x86-64-v3\njpo/toy/a/n=1/seed=0 " +
      std::to_string(count) + "\nchecksum 00000000\n");
  past.commit = "0123456789abcdef";
  past.date = "2026-01-02T03:04:05Z";
  past.subject = "Faster";
  return past;
}

PastBaseline first() {
  return baseline("one",
                  "jpo/toy/a/n=1/seed=0/fit trajectory=1 results=aa "
                  "stop=iterations loss=1,2,3 digits=5 ms=4..5\n"
                  "hig/toy/b/n=1/seed=0/fit results=bb loss=1,8,9\n",
                  1000);
}

PastBaseline second(const char* machine = "one") {
  return baseline(machine,
                  "jpo/toy/a/n=1/seed=0/fit results=cc loss=1,1,1 ms=2..5\n"
                  "sip/toy/c/n=1/seed=0/fit results=dd loss=1,1,1 ms=1..5\n",
                  1100);
}

TEST(History, ReadsBaselinesOfAnyVersion) {
  const PastBaseline past = first();
  EXPECT_EQ(past.machine, "one");
  EXPECT_EQ(past.counter, "callgrind x86-64-v3");
  ASSERT_EQ(past.stages.size(), 2U);
  const auto& stage = past.stages.at("jpo/toy/a/n=1/seed=0/fit");
  EXPECT_EQ(stage.results, "aa");
  EXPECT_EQ(stage.loss, 2);
  EXPECT_EQ(stage.fastest_ms, 4);
  EXPECT_EQ(past.stages.at("hig/toy/b/n=1/seed=0/fit").fastest_ms, 0);
  EXPECT_EQ(past.instructions.at("jpo/toy/a/n=1/seed=0"), 1000U);
  EXPECT_THROW(past_baseline("something else"), std::runtime_error);
  EXPECT_THROW(past_baseline("physinv-bench baseline 1\n"), std::runtime_error);
}

/// Of the group jpo at the last commit.
double last_of(const Figure& figure) {
  for (const Series& s : figure.panels[0].series)
    if (s.label == "jpo") return s.y.back();
  return NAN;
}

TEST(History, LinksWhatTwoBaselinesHave) {
  const auto sections = history_of({first(), second()});
  ASSERT_EQ(sections.size(), 1U);
  const auto& figures = sections[0].figures;
  ASSERT_EQ(figures.size(), 3U);
  EXPECT_DOUBLE_EQ(last_of(figures[0]), 0.5);
  EXPECT_DOUBLE_EQ(last_of(figures[1]), 1.1);
  EXPECT_DOUBLE_EQ(last_of(figures[2]), 0.5);
  const Table& table = sections[0].tables[0];
  ASSERT_EQ(table.rows.size(), 2U);
  const auto& cells = table.rows[0].cells;
  EXPECT_EQ(cells[0].text, "2026-01-02");
  EXPECT_EQ(cells[2].ours, 1) << "new";
  EXPECT_EQ(cells[3].ours, 1) << "gone";
  EXPECT_EQ(cells[4].ours, 0) << "failed";
  EXPECT_EQ(cells[5].ours, 1) << "other bits";
  EXPECT_EQ(cells[6].ours, 1) << "other losses";
  EXPECT_EQ(table.rows[0].label, "2: 012345678 Faster");
}

TEST(History, AnotherMachineLinksNoSeconds) {
  const auto sections = history_of({first(), second("two")});
  EXPECT_DOUBLE_EQ(last_of(sections[0].figures[2]), 1);
  EXPECT_EQ(sections[0].tables[0].rows[0].cells[8].text, "–");
  EXPECT_TRUE(history_of({first()}).empty());
}

/// A baseline with one stage that ended so.
PastBaseline ended(const std::string& words) {
  return baseline(
      "one",
      ("jpo/toy/a/n=1/seed=0/fit results=aa " + words + "\n").c_str(),
      1);
}

TEST(History, SolvedLossesAreEqual) {
  const auto to = [](const char* from, const char* loss) {
    const auto sections = history_of(
        {ended(std::string("stop=converged loss=0,") + from + ",1"),
         ended(std::string("stop=converged loss=0,") + loss + ",1")});
    return std::pair(last_of(sections[0].figures[0]),
                     sections[0].tables[0].rows[0].cells[6].ours.value());
  };
  EXPECT_EQ(to("1e-12", "7e-14"), std::pair(1.0, 0.0));
  EXPECT_EQ(to("7e-14", "0"), std::pair(1.0, 0.0));
  EXPECT_DOUBLE_EQ(to("1e-10", "0").first, 1e-2) << "solved by now";
  EXPECT_NEAR(to("1e-13", "1e-8").first, 1e4, 1e-8) << "no longer solved";
}

TEST(History, WhatFailsIsCountedAndMakesNothingLowerOrFaster) {
  const PastBaseline good = ended("stop=iterations loss=1,2,3 ms=4..5");
  for (const char* stop : {"failed", "skipped", "diverged"}) {
    const auto sections = history_of(
        {good,
         ended(std::string("stop=") + stop + " loss=0.1,0.2,0.3 ms=1..2")});
    EXPECT_EQ(last_of(sections[0].figures[0]), 1) << stop;
    EXPECT_EQ(last_of(sections[0].figures[2]), 1) << stop;
    const auto& cells = sections[0].tables[0].rows[0].cells;
    EXPECT_EQ(cells[4].ours, 1) << stop;
    EXPECT_EQ(cells[6].ours, 1) << stop << ": other losses";
  }
  // The median of the others alone is not a lower loss.
  const auto some = history_of(
      {good, ended("stop=iterations loss=0.1,0.2,0.3 nonfinite=2 ms=4..5")});
  EXPECT_EQ(last_of(some[0].figures[0]), 1);
  EXPECT_EQ(some[0].tables[0].rows[0].cells[6].ours, 1);
  const auto none =
      history_of({good, ended("stop=iterations loss=nan,nan,nan ms=4..5")});
  EXPECT_EQ(none[0].tables[0].rows[0].cells[6].ours, 1);
}

}  // namespace
}  // namespace physinv
