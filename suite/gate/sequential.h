/// Decisions that stay valid however often one looks.
///
/// Of independent numbers with median m, each lies above m with probability
/// 1/2. Mixed over all other probabilities, the evidence against m after n of
/// them, S above it, is the martingale
///
///   E = int_0^1 p^S (1-p)^(n-S) dp / 2^-n = 2^n / ((n + 1) binomial(n, S)),
///
/// which exceeds 1/alpha at any time with probability alpha at most (Ville).
/// No assumption about the numbers' distribution is made but that of
/// independence, and none about when one stops.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace physinv {

struct Interval {
  double low = 0, high = 0;
};

class MedianWatch {
 public:
  void add(double number);
  std::size_t count() const { return sorted_.size(); }
  double median() const;
  /// Of the median being 0, valid at any time: 1 / (the largest E so far).
  double p_value() const;
  /// Of all numbers that are not excluded at this level; infinite at first.
  Interval interval(double alpha) const;

 private:
  std::vector<double> sorted_;
  double most_ = 0;  ///< logarithm of the largest evidence against 0
};

enum class Speed { slower, faster, equal, inconclusive };
std::string_view to_string(Speed speed);

struct Decision {
  Speed speed = Speed::inconclusive;
  Interval interval;
  double median = 0, alpha = 0;
};

/// Of several cases with numbers log(time now / time before). The probability
/// that any case as fast as before is called slower or faster is alpha at most
/// (Holm). Slower and faster are by more than `margin`; equal says that all of
/// the interval lies within it.
std::vector<Decision> decide(const std::vector<MedianWatch>& cases,
                             double alpha,
                             double margin);

}  // namespace physinv
