// SIP paper, App. B.1. The ranking of Fig. 5 stands in the main text; what is
// read off that figure makes the suite's own ranges.
#include <fmt/format.h>

#include <vector>

#include "suite/cases/sip/sine/problems.h"
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
template <class F>
std::vector<Quantity> of_stretches(int first, F of) {
  return each_if(
      kStretches, [=](int xi) { return xi >= first; }, of);
}
std::vector<Quantity> relatives(int first, const std::string& method) {
  return of_stretches(first, [&](int xi) { return relative(xi, method); });
}
std::vector<Quantity> turns(const std::string& method) {
  return each(kTurns, [&](int degrees) {
    return score_at({kStretch, degrees}, method);
  });
}
std::vector<Quantity> of_methods(const Point& p,
                                 const std::vector<std::string>& methods) {
  return each(methods, [&](const auto& m) { return score_at(p, m); });
}

Quantity finite_over_infinite(const std::string& method) {
  return ratio(hard(method + "-finite"), hard(method));
}

/// Without a turn, over xi, of all stretches from `first` on.
std::vector<Quantity> ranges(int first) {
  return of_stretches(first, [](int xi) {
    return times(
        1.0 / xi,
        median(Select{"adam"}.in(Point{xi, 0}.experiment()), solution_range()));
  });
}

Quantity of_gamma_ten(int xi) {
  return ratio(loss_of_gamma(xi, 10), least(each(kGammas, [=](int gamma) {
                 return loss_of_gamma(xi, gamma);
               })));
}

Condition of_printed_rate(int xi, const MethodName& method) {
  const auto all = each(kFactors, [&](const RateFactor& f) {
    return score_at_rate(xi, method.id, f.name);
  });
  return at_most(fmt::format("{}, xi = {}", method.label, xi),
                 ratio(score_at_rate(xi, method.id, "x1"), least(all)),
                 1.5);
}

std::vector<Condition> of_printed_rates() {
  std::vector<Condition> all;
  for (const int xi : kStudied)
    for (const MethodName& m : kSix) all.push_back(of_printed_rate(xi, m));
  return all;
}

Claim claim(std::string id,
            std::string from,
            std::string says,
            std::vector<Condition> conditions,
            Cause cause = {}) {
  return {.id = std::move(id),
          .from = std::move(from),
          .says = std::move(says),
          .conditions = std::move(conditions),
          .cause = std::move(cause)};
}

const std::vector<Claim> kPaper = {
    {.id = "P1",
     .where = "App. B.1",
     .from = "standard",
     .says = "gamma = 10 leads to the fastest convergence",
     .conditions = {at_most("Adam's loss over the lowest of gamma = 1, 3, 10, "
                            "30, 100; xi = 1, phi = 0, 8000 updates",
                            of_gamma_ten(1),
                            1.2),
                    at_most("xi = 32", of_gamma_ten(32), 1.2)},
     .cause = depends(
         "xi and phi are not printed: at xi = 1 gamma = 10 is best, at xi = 32 "
         "its loss is 23 times the lowest",
         {at_most("at xi = 1", of_gamma_ten(1), 1.2)})},
    {.id = "P2",
     .where = "App. B.1",
     .from = "standard",
     .says = "The six learning rates work best",
     .conditions = of_printed_rates(),
     .note = "Distance after 8000 updates over the lowest of a tenth, a third, "
             "one, three and ten times the rate; phi = 0.",
     .cause = fails(
         "seven of twelve rates are within 1.5 times the best after 8000 "
         "updates; after 50,000, as printed, RMSprop at xi = 32 still is 2.8 "
         "times and Adagrad 1.65 (one seed)")},
    {.id = "P3",
     .where = "App. B.1",
     .from = "standard",
     .says = "In ten minutes more than 50,000 updates, about 15,000 of SIP",
     .conditions =
         {reported("updates of Adam in ten minutes",
                   ratio(600, median({"adam"}, seconds_per_update()))),
          reported("of SIP", ratio(600, median({"sip"}, seconds_per_update()))),
          reported("time of an update, SIP over Adam",
                   ratio_of_medians({"sip"}, {"adam"}, seconds_per_update()))},
     .note = "Closed forms stand for the paper's eigenvalue solver.",
     .cause = reported(
         "updates in ten minutes are the machine's; App. B.1 and Fig. 15 of "
         "the paper disagree about them (sip P1)")},
    {.id = "P4",
     .where = "App. B",
     .from = "standard",
     .says = "A finite set makes no noticeable change",
     .conditions = {at_most("SIP, 1000 samples over fresh ones",
                            finite_over_infinite("sip"),
                            2),
                    at_most("Adam", finite_over_infinite("adam"), 2)}},
    {.id = "P5",
     .where = "App. B.1",
     .from = "quick",
     .says = "With its sign flipped, Newton's step never ascends",
     .conditions = {at_most("highest slope along a step",
                            highest({"adam"}, highest_slope(options_of(kHard))),
                            0),
                    above("share of plain Newton steps that ascend",
                          lowest({"adam"}, newton_ascents(options_of(kHard))),
                          0)},
     .note = "From the solutions of other problems of the record."},
    {.id = "P6",
     .where = "App. B, B.1",
     .from = "quick",
     .says = "Every target has a solution: all optimizers can reach zero loss",
     .conditions =
         {at_most("largest residual with sin(x / xi)",
                  highest({"adam"}, residual(options_of(kHard))),
                  1e-12),
          reported("share of targets out of reach with the printed sin(x) / xi",
                   median({"adam"}, share_beyond(1.0 / kHard.xi)))}},
    {.id = "P7",
     .where = "App. B.1",
     .says = "The range of solutions scales linearly with xi",
     .conditions = {at_most("range over xi, largest over smallest, xi >= 3",
                            ratio(most(ranges(3)), least(ranges(3))),
                            1.2)}}};

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
                    1)},
          fails("Adadelta ends behind SGD on all three seeds")),
    {.id = "A8",
     .says = "After 8000 updates",
     .conditions =
         {
             below("SIP", median({"sip"}, at_quick(score())), 2.5e-2),
             within("Adam", median({"adam"}, at_quick(score())), 0.3, 1.2),
             above("SGD", median({"sgd"}, at_quick(score())), 1.6),
             above("Adadelta", median({"adadelta"}, at_quick(score())), 1.6),
             above("Adagrad", median({"adagrad"}, at_quick(score())), 1.6),
             above("RMSprop", median({"rmsprop"}, at_quick(score())), 1.6)},
     .note = "Judged by runs of 8000 updates only.",
     .cause = fails("Adam is at 0.6 to 1.5 by seed, 1.34 in the median; the "
                    "range is of one seed of another program")}};

}  // namespace

void add_claims(Registry& r) {
  r.add_claims(kHard.experiment(), kPaper);
  r.add_claims(kHard.experiment(), kSuite);
}

}  // namespace physinv::sine
