// What HIG paper Sec. 3.3, App. B.4 and C, Figs. 4, 8 to 11 say of the quantum
// dipole steered by a network, and what our runs showed.
#include <vector>

#include "suite/cases/hig/quantum_dipole/quantities.h"
#include "suite/harness/registry.h"

namespace physinv::dipole {
namespace {

constexpr const char* kFrom24 =
    "Bounds: ends of tolerance intervals from 24 seeds, which hold 80 % of all "
    "seeds with a confidence of 95 %.";

const std::vector<Claim> kDenseSuite = {
    {.id = "A1",
     .says = "HIG leaves the plateau within 160 updates on most seeds",
     .conditions = {at_most("after 160 updates, four seeds of five",
                            most_stay_below(kHig, loss_after(160)),
                            0.15)}},
    {.id = "A1b",
     .from = "standard",
     .says = "HIG after 512 updates",
     .conditions = {at_most("median", median_after(kHig, 512), 2e-2),
                    at_most("lowest", lowest(kHig, loss_after(512)), 5e-4),
                    at_most("highest", highest(kHig, loss_after(512)), 0.1)}},
    {.id = "A2",
     .says =
         "To a test loss of 0.1, HIG takes fewer updates than Adam with b = "
         "256; four seeds of five keep each bound",
     .conditions = {at_most("HIG", most_stay_below(kHig, to_a_tenth(224)), 189),
                    at_least("Adam b=256",
                             most_stay_above(kAdam256, to_a_tenth(960)),
                             300),
                    at_most("Adam b=256",
                            most_stay_below(kAdam256, to_a_tenth(960)),
                            1000),
                    at_least("over HIG", over_hig(kAdam256, 960), 2.5)},
     .note = "HIG's bound: end of a tolerance interval from 24 seeds (80 % of "
             "all, confidence 95 %); the others stand as earlier runs set "
             "them."},
    {.id = "A2b",
     .from = "standard",
     .says = "The same for Adam with b = 16 and 1e-4",
     .conditions =
         {at_least("Adam b=16", most_stay_above(kAdam, to_a_tenth(8000)), 2354),
          at_most("Adam b=16", most_stay_below(kAdam, to_a_tenth(8000)), 5990),
          at_least("over HIG", over_hig(kAdam, 8000), 14.1)},
     .note = kFrom24},
    {.id = "A3",
     .says = "Adam (b=16, 1e-4) stays near one half for long, HIG does not",
     .conditions = {at_least(
                        "Adam b=16 in [0.4, 0.56], four seeds of five",
                        most_stay_above(
                            kAdam, if_ran(3000, plateau(updates(), 0.4, 0.56))),
                        1000),
                    at_most("HIG, longest",
                            highest(kHig, plateau(updates(), 0.4, 0.56)),
                            64)}},
    {.id = "A4",
     .says =
         "HIG lowers the losses of both levels together; four seeds of five "
         "keep each bound",
     .conditions = {at_most("lag", most_stay_below(kHig, lag), 1.9),
                    at_most("rise", most_stay_below(kHig, rise), 0.0192)},
     .note = kFrom24},
    {.id = "A4b",
     .from = "standard",
     .says = "Adam (b=16, 1e-4) lowers the low level first and lets it rise "
             "again",
     .conditions =
         {at_least("lag", most_stay_above(kAdam, if_ran(8000, lag)), 2.89),
          at_least("rise", most_stay_above(kAdam, if_ran(8000, rise)), 0.0325)},
     .note = kFrom24},
    {.id = "A5",
     .from = "standard",
     .says = "Of Adam's rates (b=16), a large one falls first and ends higher "
             "than a small one",
     .conditions = {at_most("1e-3 to 1e-2, median updates",
                            median(kAdam10, if_ran(2000, first_below(1e-2))),
                            2000),
                    above("1e-4 to 1e-2, median updates",
                          median(kAdam, if_ran(8000, first_below(1e-2))),
                          4000),
                    above("after 25000, loss at 3e-3 over 1e-4",
                          ratio_of_medians(
                              kAdam30, kAdam, if_ran(25'000, settled_loss())),
                          1)}},
    {.id = "A6",
     .from = "standard",
     .says = "After 256 updates HIG does well for tau 1e-3 and worse for 1e-2; "
             "with the gradient projected, 1e-6 is as good as 1e-5",
     .conditions = {at_most("tau 1e-3", median_after(kTau3, 256), 5e-3),
                    reported("1e-4", median_after(kTau4, 256)),
                    above("tau 1e-2 over 1e-3",
                          ratio_of_medians(kTau2, kTau3, loss_after(256)),
                          10),
                    within("tau 1e-6 over 1e-5",
                           ratio_of_medians(kTau6, kHig, loss_after(256)),
                           0.2,
                           5)}},
    {.id = "A8",
     .says = "Gauss-Newton (not in the paper) stays finite on all seeds",
     .conditions = {at_most("highest end", highest(kGn, last_loss()), 1),
                    reported("median", median_at_end(kGn)),
                    reported("HIG", median_at_end(kHig))}}};

/// After the time of Fig. 4b, and until a loss, by the paper's clock.
const RunValue kAtEnd = loss_at(paper(), kEnd),
               kTimeToAHundredth = time_to(paper(), 1e-2);
/// Updates that Adam stagnates.
const RunValue kOnPlateau = plateau(updates(), 0.4, 0.6);
/// With the truncations that Fig. 9 has accurate.
const std::vector<Quantity> kAccurate =
    medians({kHig, kTau4, kTau3}, loss_after(256));

const std::vector<Claim> kDensePaper = {
    {.id = "P1",
     .where = "Sec. 3.3, Fig. 4b",
     .from = "standard",
     .says = "HIG minimises the loss faster than Adam",
     .conditions =
         {below("time to 1e-2 by the paper's clock, HIG over the fastest Adam "
                "but for the largest rate",
                ratio(median(kHig, kTimeToAHundredth),
                      least(medians({kAdam, kAdam10, kAdam256},
                                    kTimeToAHundredth))),
                1),
          below("the same on the best seeds",
                ratio(lowest(kHig, kTimeToAHundredth),
                      least(lowests({kAdam, kAdam10, kAdam256},
                                    kTimeToAHundredth))),
                1),
          reported("over Adam with the largest rate",
                   ratio_of_medians(kHig, kAdam30, kTimeToAHundredth))},
     .note = "That Adam with the largest rate drops first, the paper says "
             "itself (P3). Table 5 has no Adam with b = 16; it is taken to "
             "last as long as with 256, which favours HIG."},
    {.id = "P2",
     .where = "Sec. 3.3, Fig. 4b",
     .says = "HIG reaches a better final accuracy than Adam",
     .conditions = {below("end of the best HIG over the best Adam",
                          ratio(least(medians(kFig4Hig, kAtEnd)),
                                least(medians(kFig4Adam, kAtEnd))),
                          1),
                    below("on the best seeds",
                          ratio(least(lowests(kFig4Hig, kAtEnd)),
                                least(lowests(kFig4Adam, kAtEnd))),
                          1),
                    reported("Adam b=256", median(kAdam256, kAtEnd))},
     .note = "After 5400 s by the paper's clock; the rates of Fig. 4b are not "
             "printed."},
    {.id = "P3",
     .where = "Sec. 3.3, Fig. 4b",
     .says = "Adam with the largest rate drops first and ends worst of all",
     .conditions = {below("time to 0.5, rate 3e-3 over the fastest other Adam",
                          ratio(median(kAdam30, time_to(paper(), 0.5)),
                                least(medians({kAdam, kAdam3, kAdam10},
                                              time_to(paper(), 0.5)))),
                          1),
                    above("its end over the highest other",
                          ratio(median(kAdam30, kAtEnd),
                                most({most(medians({kAdam, kAdam3, kAdam10},
                                                   kAtEnd)),
                                      most(medians(kFig4Hig, kAtEnd))})),
                          1)}},
    {.id = "P4",
     .where = "Sec. 3.3",
     .says = "The final losses differ less than in the other experiments",
     .conditions = {below("Adam over HIG at the end",
                          ratio(least(medians(kFig4Adam, kAtEnd)),
                                least(medians(kFig4Hig, kAtEnd))),
                          ratio_of_medians(Select{"adam"}.in("hig/oscillators"),
                                           Select{"hig"}.in("hig/oscillators"),
                                           last_loss()))},
     .note = "The other one: the oscillators, whose runs end after an hour of "
             "the paper's clock.",
     .cause =
         fails("Adam ends 18 times above HIG on the dipole and 8 times on the "
               "oscillators; on Poisson's equation, where HIG is not ahead, 92 "
               "times below (one seed of each)")},
    {.id = "P5",
     .where = "Sec. 3.3",
     .says = "A pure physics optimisation reaches about 1e-6, and networks "
             "cannot improve beyond",
     .conditions = {near("control alone in float, 1 - |<t, psi>|^2",
                         median(Select{"hig-f32"}.in(kDirect),
                                last_of({"metrics", kOverlap})),
                         1e-6),
                    at_least("lowest test loss of a network",
                             least({least(lowests(kFig4Hig, lowest_loss())),
                                    least(lowests(kFig4Adam, lowest_loss()))}),
                             3e-7),
                    reported("control alone in float, |psi - <t, psi> t|^2",
                             median(Select{"hig-f32"}.in(kDirect),
                                    last_of({"metrics", kRest}))),
                    reported("control alone in double",
                             median(Select{"hig"}.in(kDirect), last_loss()))},
     .note = "In float the printed loss cancels; by a formula that does not, "
             "and in double, there is no such floor (A9). Our networks train "
             "in double.",
     .cause = fails(
         "the floor is single precision's: by the printed formula, which "
         "cancels, control alone ends at 3.3e-6 in float; in double it comes "
         "to 1e-15 and networks to 5e-8")},
    {.id = "P6",
     .where = "Sec. 3.3, Fig. 4b",
     .from = "standard",
     .says = "Adam stagnates at 0.5, most of all with 1e-4; HIG decreases "
             "faster below",
     .conditions = {above("updates in 0.4 .. 0.6, rate 1e-4",
                          median(kAdam, kOnPlateau),
                          most(medians({kAdam10, kAdam30}, kOnPlateau))),
                    below(
                        "HIG",
                        median(kHig, kOnPlateau),
                        least(medians({kAdam, kAdam10, kAdam30}, kOnPlateau))),
                    below("HIG, seconds by the paper's clock",
                          median(kHig, plateau(paper(), 0.4, 0.6)),
                          least(medians({kAdam, kAdam10, kAdam30},
                                        plateau(paper(), 0.4, 0.6))))}},
    {.id = "P7",
     .where = "Sec. 3.3, Fig. 4c",
     .from = "standard",
     .says = "Adam minimises the low-energy loss first and increases it again "
             "before it minimises the high-energy loss",
     .conditions = {above("updates to 0.1, HE over LE",
                          median(kAdam, if_ran(8000, lag)),
                          1),
                    above("then LE over its lowest, before HE < 0.1",
                          median(kAdam, if_ran(8000, rise_ratio)),
                          1.2)}},
    {.id = "P8",
     .where = "Sec. 3.3, Fig. 4c",
     .from = "standard",
     .says = "HIG minimises both losses uniformly",
     .conditions = {below("updates to 0.1, HE over LE",
                          median(kHig, lag),
                          median(kAdam, if_ran(8000, lag)))}},
    {.id = "P9",
     .where = "App. B.4, Fig. 9",
     .from = "standard",
     .says = "HIG is accurate for tau from 1e-5 to 1e-3 and worse for 1e-2",
     .conditions =
         {either(at_most("after 256 updates, highest over lowest of the three",
                         spread_ratio(kAccurate),
                         10),
                 below("highest", most(kAccurate), 1e-2)),
          above("tau 1e-2 over the highest of them",
                ratio(median_after(kTau2, 256), most(kAccurate)),
                1),
          reported("b=8, tau 1e-2 over 1e-3",
                   ratio_of_medians({"hig-b8-eta05-tau2"},
                                    {"hig-b8-eta05-tau3"},
                                    loss_after(256)))}},
    {.id = "P10",
     .where = "App. C, Fig. 9",
     .from = "standard",
     .says = "With tau far below 1e-5 the network does not learn, and a pure "
             "physics optimisation does worse",
     .conditions = {above(
                        "float, gradient as it is, tau 1e-7: lowest test loss",
                        lowest({"hig-f32-raw-tau7"}, lowest_loss()),
                        0.1),
                    above("control alone in float, tau 1e-7 over 1e-5",
                          ratio_of_medians(Select{"hig-f32-tau7"}.in(kDirect),
                                           Select{"hig-f32"}.in(kDirect),
                                           last_loss()),
                          1),
                    reported("double, tau 1e-6, test loss after 256",
                             median_after(kTau6, 256)),
                    reported("control alone in double, tau 1e-7 over 1e-5",
                             ratio_of_medians(Select{"hig-tau7"}.in(kDirect),
                                              Select{"hig"}.in(kDirect),
                                              last_loss()))},
     .note = "Controls alone are updated by projected gradients.",
     .cause = depends(
         "a tau far below 1e-5 is not printed, nor whether the control's "
         "gradient is projected: with 1e-7 the lowest test loss is 0.014, "
         "with 1e-8 it was 0.50 (one seed); control alone, not projected, "
         "stays at 0.92 to 0.99 for 128 updates")},
    {.id = "P11",
     .where = "App. B.4, Fig. 9",
     .from = "quick",
     .says =
         "HIG's plateau at the start comes from the start-up of TensorFlow, "
         "not from HIG",
     .conditions = {below("after 20 updates, over the start",
                          median(kHig, over(loss_after(20), first_loss())),
                          0.9)},
     .cause = fails(
         "HIG's first plateau stands without TensorFlow: after 20 updates the "
         "loss is 0.99 to 1.00 of the start, it falls after 46 to 128")}};

const Select kCnnTau3{"hig-b16-eta07-tau3"}, kCnnTau5{"hig-b16-eta07-tau5"};

const std::vector<Claim> kConvolutions = {
    {.id = "A7",
     .from = "standard",
     .says = "With the convolutional network, HIG after 256 updates is below "
             "Adam (b=256, 2e-4) after 600",
     .conditions = {at_most(
                        "HIG after 256, median", median_after(kHig, 256), 5e-3),
                    above("Adam b=256 after 600, median",
                          median_after(kAdam, 600),
                          1e-2)}},
    {.id = "P12",
     .where = "App. B.4, Figs. 10, 11",
     .says = "With convolutions, tau from 1e-5 to 1e-3 is stable, and the best "
             "HIG run is faster and more accurate than the best Adam run",
     .conditions = {at_most("of the seeds with tau 1e-3, 1e-4, 1e-5, diverged",
                            most({highest(kCnnTau3, diverged()),
                                  highest(kHig, diverged()),
                                  highest(kCnnTau5, diverged())}),
                            0),
                    below("time to 1e-2 by the paper's clock, HIG over Adam",
                          ratio_of_medians(kHig, kAdam, kTimeToAHundredth),
                          1),
                    below("end, HIG over Adam",
                          ratio_of_medians(kHig, kAdam, kAtEnd),
                          1)},
     .note = "Table 5 is of the dense network; its seconds are taken for both. "
             "One rate of each method."}};

}  // namespace

void add_claims(Registry& r) {
  r.add_claims(kDense, kDenseSuite);
  r.add_claims(kDense, kDensePaper);
  r.add_claims(kConvolutional, kConvolutions);
}

}  // namespace physinv::dipole
