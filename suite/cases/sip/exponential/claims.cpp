// SIP paper, App. C.2, which prints no accuracy: its main text shows what the
// networks predict after 10,000 updates. Errors are those of x.
#include <vector>

#include "suite/cases/sip/exponential/metrics.h"
#include "suite/evidence/training.h"
#include "suite/harness/registry.h"

namespace physinv::exponential {
namespace {

Quantity of(const char* method, MetricRow row) {
  return median({method}, last_of(metric(row)));
}
Quantity best(const char* method, MetricRow row) {
  return lowest({method}, last_of(metric(row)));
}
Quantity worst(const char* method, MetricRow row) {
  return highest({method}, last_of(metric(row)));
}

RunValue low_over_high() {
  return over(last_of(metric(kLow)), last_of(metric(kHigh)));
}
Quantity worst_ratio(const char* a, const char* b, MetricRow row) {
  return physinv::worst_ratio({a}, {b}, last_of(metric(row)));
}

const std::vector<Claim> kClaimsOfAll = {
    {.id = "P1",
     .where = "App. C.2",
     .from = "quick",
     .says = "SGD converges very slowly",
     .conditions = {above("share of the error left",
                          lowest({"sgd"}, share_left(metric(kMean))),
                          0.1)}},
    {.id = "P2",
     .where = "App. C.2",
     .from = "quick",
     .says = "Adam converges very slowly",
     .conditions = {above("share of the error left",
                          lowest({"adam"}, share_left(metric(kMean))),
                          0.1)}},
    {.id = "P3",
     .where = "App. C.2",
     .from = "quick",
     .says = "The cause: gradients scale with exp x",
     .conditions = {above("SGD, error below -8 over that above -4",
                          lowest({"sgd"}, low_over_high()),
                          2),
                    above("Adam", lowest({"adam"}, low_over_high()), 2)}},
    {.id = "P4",
     .where = "App. C.2",
     .from = "quick",
     .says = "Normalising the gradient cures it",
     .conditions = {below("error over Adam's, worst seed",
                          worst_ratio("norm", "adam", kMean),
                          1),
                    below("over SGD's, worst seed",
                          worst_ratio("norm", "sgd", kMean),
                          1)}},
    {.id = "A1",
     .says = "Mean errors, every seed in order",
     .conditions = {below("Adam's over SGD's, worst seed",
                          worst_ratio("adam", "sgd", kMean),
                          1),
                    within("normalised", of("norm", kMean), 0.4, 1.2),
                    within("Adam", of("adam", kMean), 1.5, 3.2),
                    within("SGD", of("sgd", kMean), 3.2, 4.6)}},
    {.id = "A3",
     .says = "Below -8 Adam and SGD predict nearly one number",
     .conditions =
         {below("normalised over Adam, worst seed",
                worst_ratio("norm", "adam", kLow),
                0.4),
          below(
              "Adam over SGD, worst seed", worst_ratio("adam", "sgd", kLow), 1),
          above("Adam's error, best seed", best("adam", kLow), 3.5),
          above("SGD's, best seed", best("sgd", kLow), 6),
          below("range of Adam's below -9", worst("adam", kSpread), 0.1),
          below("of SGD's", worst("sgd", kSpread), 0.1)}},
    {.id = "A4",
     .says = "In y the order is the other way round",
     .conditions = {below("Adam's loss over the normalised one's",
                          ratio_of_medians({"adam"}, {"norm"}, last_loss()),
                          1)}},
    {.id = "A5",
     .from = "standard",
     .says = "The signs of the distances do as well as the distances",
     .conditions = {within("normalised over distances",
                           ratio(of("norm", kMean), of("gt", kMean)),
                           0.5,
                           2)}},
    {.id = "A6",
     .says = "SGD barely leaves the best constant",
     .conditions = {below(
         "estimate at -3 over that at -12", of("sgd", kRise), 0.2)}},
};

}  // namespace

void add_claims(Registry& r) { r.add_claims("sip/exponential", kClaimsOfAll); }

}  // namespace physinv::exponential
