/// What claims about Fig. 2 of the JPO paper are made of: shares of aligned
/// gradients next to what theory says, over numbers of examples N.
#pragma once

#include <functional>
#include <optional>

#include "suite/cases/jpo/gradient_alignment/shares.h"
#include "suite/core/arrays.h"
#include "suite/evidence/condition.h"
#include "suite/evidence/statistics.h"

namespace physinv::alignment {

/// One of the kinds of shares that were measured, and the method that did.
struct Shares {
  const char* method;
  std::optional<Aligned> Fig2::*kind;

  const Aligned& of(const Fig2& f) const { return *(f.*kind); }
};
/// A share at N examples.
using Theory = std::function<double(const Fig2&, Index n)>;
/// What another kind of shares is there.
Theory measured(const Shares& shares);

/// A number of Fig. 2 by one method, repeated often enough.
Quantity fig2(const char* method,
              std::function<std::optional<double>(const Fig2&)> number,
              Index repetitions = kJudged);

/// Over N in [first, last] the largest share - theory, and its size.
Quantity largest_excess(const Shares& shares,
                        const Theory& theory,
                        Index first);
Quantity largest_distance(const Shares& shares,
                          const Theory& theory,
                          Index first = 1,
                          Index last = kEvery);
/// The same in units of four standard errors and `more`.
Quantity off_by(const Shares& shares,
                const Theory& theory,
                Index repetitions,
                Index first,
                double more);
/// From N to 2 N.
Quantity largest_rise_of_doubling(const Shares& shares, Index last);
/// Above the highest or below the lowest.
Quantity largest_outside(const Shares& shares, double lowest, double highest);
Quantity highest_share(const Shares& shares, Index first);
Quantity lowest_share(const Shares& shares, Index first);

Quantity share_at(const Shares& shares, Index n);
/// The share at one N less that at another.
Quantity fall(const Shares& shares, Index from, Index to);
/// At the largest N.
Quantity last_share(const Shares& shares);
/// At the largest N, |a - b|, a - b over its standard error, and its size.
Quantity end_distance(const Shares& a, const Shares& b);
Quantity end_in_errors(const Shares& a, const Shares& b, Index repetitions);
Quantity end_distance_in_errors(const Shares& a, const Shares& b);
/// a - b, mean over N.
Quantity mean_excess(const Shares& a, const Shares& b, Index repetitions);

/// Of log(share - 1/2) over log N.
Quantity slope(const Shares& shares, Index first, Index last);
/// |slope - that of theory|.
Quantity slope_off(const Shares& shares,
                   const Theory& theory,
                   Index first,
                   Index last,
                   Index repetitions);
/// The size of the difference from another slope over twice its standard error,
/// N in [1, last].
Quantity slope_in_errors(const Shares& shares, double other, Index last);
Quantity slope_in_errors(const Shares& shares, const Theory& law, Index last);
Quantity slope_in_errors(const Shares& shares, const Shares& other, Index last);

/// Repetitions of all N in which one way to take the gradients together points
/// elsewhere than the vote of the same gradients.
RunValue apart_from_vote(ArrayKey way);

}  // namespace physinv::alignment
