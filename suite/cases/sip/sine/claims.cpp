// SIP paper, App. B.1. The ranking of Fig. 5 stands in the main text; what is
// read off that figure makes the suite's own ranges.
#include <vector>

#include "suite/cases/sip/sine/score.h"
#include "suite/harness/registry.h"

namespace physinv::sine {
namespace {

const std::vector<std::string> kOthers = {
    "sgd", "adadelta", "adagrad", "rmsprop"};

Quantity score_at(const Point& p, const std::string& method) {
  return median(Select{method}.in(p.experiment()), score());
}
Quantity hard(const std::string& method) { return score_at(kHard, method); }
/// Over xi: distances stretch with it.
Quantity relative(int xi, const std::string& method) {
  return times(1.0 / xi, score_at({xi, 0}, method));
}
Quantity stretched(const std::string& method) {
  return ratio(relative(64, method), relative(1, method));
}

/// Of all stretches from `first` on.
std::vector<Quantity> relatives(int first, const std::string& method) {
  std::vector<Quantity> all;
  for (const int xi : kStretches)
    if (xi >= first) all.push_back(relative(xi, method));
  return all;
}
std::vector<Quantity> turns(const std::string& method) {
  std::vector<Quantity> all;
  for (const int degrees : kTurns)
    all.push_back(score_at({kStretch, degrees}, method));
  return all;
}
std::vector<Quantity> of_methods(const Point& p,
                                 const std::vector<std::string>& methods) {
  std::vector<Quantity> all;
  for (const auto& m : methods) all.push_back(score_at(p, m));
  return all;
}

Quantity finite_over_infinite(const std::string& method) {
  return ratio(hard(method + "-finite"), hard(method));
}

Claim claim(std::string id,
            std::string from,
            std::string says,
            std::vector<Condition> conditions) {
  return {.id = std::move(id),
          .from = std::move(from),
          .says = std::move(says),
          .conditions = std::move(conditions)};
}

const std::vector<Claim> kPaper = {
    {.id = "P1",
     .origin = Origin::paper,
     .where = "App. B.1",
     .from = "paper",
     .says = "gamma = 10 leads to the fastest convergence",
     .conditions = {},
     .note = "Needs five values of gamma, which no profile runs."},
    {.id = "P2",
     .origin = Origin::paper,
     .where = "App. B.1",
     .from = "paper",
     .says = "The six learning rates work best",
     .conditions = {},
     .note = "Needs five rates of each method, which no profile runs."},
    {.id = "P3",
     .origin = Origin::paper,
     .where = "App. B.1",
     .from = "standard",
     .says = "In ten minutes more than 50,000 updates, about 15,000 of SIP",
     .conditions = {report("updates of Adam in ten minutes",
                           ratio(600, median({"adam"}, seconds_per_update()))),
                    report("of SIP",
                           ratio(600, median({"sip"}, seconds_per_update()))),
                    report("time of an update, SIP over Adam",
                           ratio(median({"sip"}, seconds_per_update()),
                                 median({"adam"}, seconds_per_update())))},
     .note = "Closed forms stand for the paper's eigenvalue solver."},
    {.id = "P4",
     .origin = Origin::paper,
     .where = "App. B",
     .from = "standard",
     .says = "A finite set makes no noticeable change",
     .conditions = {at_most("SIP, 1000 samples over fresh ones",
                            finite_over_infinite("sip"),
                            2),
                    at_most("Adam", finite_over_infinite("adam"), 2)}}};

const std::vector<Claim> kSuite = {
    claim("A1",
          "standard",
          "Stretched and turned, SIP is ten times nearer than all others",
          {within("SIP", hard("sip"), 0.9e-2, 1.8e-2),
           within("Adam", hard("adam"), 0.15, 0.8),
           above("lowest of the others", least(of_methods(kHard, kOthers)), 1),
           at_least(
               "lowest of all others over SIP",
               ratio(least({hard("adam"), least(of_methods(kHard, kOthers))}),
                     hard("sip")),
               10)}),
    claim("A2",
          "paper",
          "SIP's relative distance does not depend on the stretch",
          {at_least("lowest, xi >= 5", least(relatives(5, "sip")), 3e-4),
           at_most("highest", most(relatives(5, "sip")), 6e-4),
           within("xi = 1", relative(1, "sip"), 6e-4, 1.3e-3)}),
    claim("A3",
          "paper",
          "Without a turn Adam is as good where the stretch is small",
          {at_most("Adam over SIP, xi = 1",
                   ratio(relative(1, "adam"), relative(1, "sip")),
                   1),
           at_most(
               "xi = 10", ratio(relative(10, "adam"), relative(10, "sip")), 1),
           at_least("Adam, xi = 64 over xi = 5",
                    ratio(relative(64, "adam"), relative(5, "adam")),
                    1.3)}),
    claim("A4",
          "paper",
          "The others lose with the stretch",
          {at_least("SGD, xi = 64 over xi = 1", stretched("sgd"), 8),
           at_least("Adadelta", stretched("adadelta"), 8),
           at_least("Adagrad", stretched("adagrad"), 8),
           at_least("RMSprop", stretched("rmsprop"), 8)}),
    claim("A5",
          "paper",
          "SIP does not mind the turn",
          {below("SIP, largest over smallest",
                 ratio(most(turns("sip")), least(turns("sip"))),
                 1.5),
           at_least("Adam, 45 degrees over none",
                    ratio(hard("adam"), score_at({kStretch, 0}, "adam")),
                    10)}),
    claim("A6",
          "paper",
          "Turned but not stretched, every method arrives",
          {below("highest",
                 most({score_at(kEasy, "sip"),
                       score_at(kEasy, "adam"),
                       most(of_methods(kEasy, kOthers))}),
                 5e-3),
           at_most("Adam over the lowest",
                   ratio(score_at(kEasy, "adam"),
                         least({score_at(kEasy, "sip"),
                                least(of_methods(kEasy, kOthers))})),
                   1),
           at_least("SGD over the highest of the others",
                    ratio(score_at(kEasy, "sgd"),
                          most(of_methods(kEasy,
                                          {"adadelta", "adagrad", "rmsprop"}))),
                    1)}),
    {.id = "A8",
     .from = "quick",
     .says = "After 8000 updates",
     .conditions =
         {
             below("SIP", median({"sip"}, at_quick(score())), 2.5e-2),
             within("Adam", median({"adam"}, at_quick(score())), 0.3, 1.2),
             above("SGD", median({"sgd"}, at_quick(score())), 1.6),
             above("Adadelta", median({"adadelta"}, at_quick(score())), 1.6),
             above("Adagrad", median({"adagrad"}, at_quick(score())), 1.6),
             above("RMSprop", median({"rmsprop"}, at_quick(score())), 1.6)},
     .note = "Judged by runs of 8000 updates only."}};

const bool kClaims = [] {
  std::vector<Claim> all = kPaper;
  all.insert(all.end(), kSuite.begin(), kSuite.end());
  return register_claims(kHard.experiment(), all);
}();

}  // namespace
}  // namespace physinv::sine
