#include "suite/harness/words.h"

#include <gtest/gtest.h>

#include <memory>

#include "suite/harness/select.h"

namespace physinv {
namespace {

/// Cases of two papers and of none.
std::vector<Case> cases() {
  std::vector<Case> all;
  for (const auto& [experiment, paper, methods] :
       {std::tuple("jpo/billiards", "jpo", "jpo adam"),
        std::tuple("hig/poisson", "hig", "adam adam-b16 hig"),
        std::tuple("hig/poisson-fine", "hig", "adam"),
        std::tuple("matrix/billiards", "", "adam sgd"),
        std::tuple("numerics/poisson", "hig", "stability")}) {
    auto e = std::make_shared<Experiment>();
    e->name = experiment;
    e->citation.paper = paper;
    std::istringstream words(methods);
    for (std::string method; words >> method;) {
      Case c;
      c.experiment = e;
      c.info.experiment = experiment;
      c.info.name = std::string(experiment) + "/" + method + "/n=4/seed=0";
      all.push_back(std::move(c));
    }
  }
  return all;
}

std::string chosen(const std::vector<std::string>& filters, bool all = false) {
  std::string names;
  for (const Case& c :
       NameFilter(expressions_of(filters, cases(), all)).apply(cases()))
    names += (names.empty() ? "" : " ") +
             c.info.name.substr(0, c.info.name.find("/n="));
  return names;
}

TEST(Words, AWordIsLettersDigitsAndSigns) {
  for (const char* word : {"billiards", "robotic-arm", "seed=0", "na", "3d"})
    EXPECT_TRUE(is_plain_word(word)) << word;
  for (const char* other :
       {"", "-na", "jpo/", "a|b", "n=.", "^jpo", "x*", "(a)", "\xc3\xa9"})
    EXPECT_FALSE(is_plain_word(other)) << other;
}

TEST(Words, PapersOwnExperimentsAreThoseOfTheirName) {
  std::string of_papers;
  for (const Case& c : cases())
    if (is_of_paper(*c.experiment) &&
        c.info.name.find("adam/") != c.info.name.npos)
      of_papers += c.info.experiment + " ";
  EXPECT_EQ(of_papers, "jpo/billiards hig/poisson hig/poisson-fine ");
}

TEST(Words, MeanPapersExperimentsFirst) {
  EXPECT_EQ(chosen({"billiards"}), "jpo/billiards/jpo jpo/billiards/adam");
  EXPECT_EQ(chosen({"billiards"}, true),
            "jpo/billiards/jpo jpo/billiards/adam matrix/billiards/adam "
            "matrix/billiards/sgd");
  EXPECT_EQ(chosen({"adam"}),
            "jpo/billiards/adam hig/poisson/adam hig/poisson-fine/adam");
  EXPECT_EQ(chosen({"jpo"}), "jpo/billiards/jpo jpo/billiards/adam");
}

TEST(Words, WholePartsGoBeforeOnesInside) {
  EXPECT_EQ(chosen({"poisson"}),
            "hig/poisson/adam hig/poisson/adam-b16 hig/poisson/hig");
  EXPECT_EQ(chosen({"poiss"}),
            "hig/poisson/adam hig/poisson/adam-b16 hig/poisson/hig "
            "hig/poisson-fine/adam");
  EXPECT_EQ(chosen({"fine"}), "hig/poisson-fine/adam");
}

TEST(Words, WhatNoPaperHasIsMeantAllTheSame) {
  EXPECT_EQ(chosen({"numerics"}), "numerics/poisson/stability");
  EXPECT_EQ(chosen({"matrix"}), "matrix/billiards/adam matrix/billiards/sgd");
  EXPECT_EQ(chosen({"sgd"}), "matrix/billiards/sgd");
  EXPECT_EQ(chosen({"stabil"}), "numerics/poisson/stability");
  EXPECT_EQ(chosen({"nowhere"}), "");
}

TEST(Words, RegularExpressionsStandAsTheyAre) {
  EXPECT_EQ(chosen({"billiards/"}),
            "jpo/billiards/jpo jpo/billiards/adam matrix/billiards/adam "
            "matrix/billiards/sgd");
  EXPECT_EQ(chosen({"sgd|stability"}),
            "matrix/billiards/sgd numerics/poisson/stability");
  EXPECT_EQ(chosen({"billiards", "matrix/.*sgd"}),
            "jpo/billiards/jpo jpo/billiards/adam matrix/billiards/sgd");
}

TEST(Words, ThatTakeOutDoSoEverywhere) {
  EXPECT_EQ(chosen({"-adam"}),
            "jpo/billiards/jpo hig/poisson/adam-b16 hig/poisson/hig "
            "matrix/billiards/sgd numerics/poisson/stability");
  EXPECT_EQ(chosen({"-ada"}),
            "jpo/billiards/jpo hig/poisson/hig matrix/billiards/sgd "
            "numerics/poisson/stability");
  EXPECT_EQ(chosen({"poisson", "-hig/poisson/adam"}), "hig/poisson/hig");
}

TEST(Words, StayAsTypedWhereThatMeansTheSame) {
  const auto typed = [](const std::string& word, bool all = false) {
    return expressions_of({word}, cases(), all).front();
  };
  for (const char* word :
       {"fine", "numerics", "matrix", "nowhere", "-ada", "jpo/billiards"})
    EXPECT_EQ(typed(word), word);
  EXPECT_EQ(typed("billiards"), "^(hig|jpo)/(.*/)?billiards(/|$)");
  EXPECT_EQ(typed("-adam"), "-(^|/)adam(/|$)");
  EXPECT_EQ(typed("poiss", true), ".*poiss");
  // What has been read once is read the same again.
  for (const char* word : {"billiards", "-adam", "poiss", "adam", "sgd"})
    for (const bool all : {false, true})
      EXPECT_EQ(typed(typed(word, all)), typed(word, all)) << word;
}

}  // namespace
}  // namespace physinv
