/// What claims about Fig. 2 of the JPO paper are made of: shares of aligned
/// gradients beside what theory says, over numbers of examples N.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "suite/cases/jpo/gradient_alignment/shares.h"
#include "suite/core/arrays.h"
#include "suite/evidence/condition.h"
#include "suite/evidence/statistics.h"

namespace physinv::alignment {

using Theory = double (*)(Index);
/// One of the kinds of shares that were measured.
using AlignedOf = std::optional<Aligned> Fig2::*;

/// A number of Fig. 2 by one method, repeated often enough.
Quantity fig2(const char* method,
              std::function<std::optional<double>(const Fig2&)> number,
              Index repetitions = kJudged);

/// The largest of value(Fig. 2, N, share) over N in [first, last].
using OfShare = std::function<double(const Fig2&, Index n, double share)>;
Quantity largest(const char* method,
                 AlignedOf shares,
                 OfShare value,
                 Index first = 1,
                 Index last = kEvery);
/// The largest |measured - theory|.
using TheoryOfFig2 = std::function<double(const Fig2&, Index n)>;
Quantity distance(const char* method,
                  AlignedOf shares,
                  TheoryOfFig2 theory,
                  Index first = 1,
                  Index last = kEvery);
/// The same in units of what sampling explains: four standard errors, and
/// something for the many terms that are not infinitely many.
Quantity off_by(const char* method,
                AlignedOf shares,
                Theory theory,
                Index repetitions = kJudged,
                Index first = 1,
                double more = 0.004);
/// At the largest N.
Quantity at_largest(const char* method, AlignedOf shares);
/// Difference of two of them there, over its standard error.
Quantity errors_apart(const char* method,
                      AlignedOf a,
                      AlignedOf b,
                      Index repetitions = kJudged);

/// Of log(share - 1/2) over log N, measured or by a theory.
std::optional<Line> excess(const Aligned& m,
                           Index first,
                           Index last,
                           Theory theory = nullptr);
Quantity slope(const char* method, AlignedOf shares, Index first, Index last);

/// Repetitions of all N in which one way to take the gradients together points
/// elsewhere than the vote of the same gradients.
Quantity apart_from_vote(const char* method, ArrayKey array);

/// AlignedOf of updates along noisy gradients, of the sum or the vote.
struct Noisy {
  const char* label;
  AlignedOf measured;
  Theory noise_only;
};
/// The combined model describes them.
std::vector<Condition> follows_the_model(const Noisy& noisy);
std::vector<Condition> fits_well(const Noisy& noisy);
/// Noise does not move the limit.
std::vector<Condition> keeps_the_limit(const Noisy& noisy);
/// Of the sum and of the vote.
std::vector<Condition> both(std::vector<Condition> (*of)(const Noisy&));

}  // namespace physinv::alignment
