/// How far apart two losses are, and which of their digits are stable.
#pragma once

namespace physinv {

/// From `a` to `b` in decades, positive if b is larger; where one of them is
/// not positive, relative to the larger. 0 for two numbers that are not finite,
/// infinite for one.
double log_distance(double a, double b);

/// Of a loss that rounding moves by a tenth of a decade and more.
inline constexpr int kNoDigits = -1;
/// A result moves by up to 10^-digits decades when rounding does; without a
/// stable digit no distance says anything.
double tolerance(int digits);

/// From a distance seen when the data were one ulp off. One digit is left for
/// roundings within the run, and `most` are promised at most.
int stable_digits(double distance, int most);

}  // namespace physinv
