/// How far apart two losses are, and which of their digits are stable.
#pragma once

namespace physinv {

/// From `a` to `b` in decades, positive if b is larger; where one of them is
/// not positive, relative to the larger. 0 for two numbers that are not finite,
/// infinite for one.
double log_distance(double a, double b);

/// A result moves by up to 10^-digits decades when rounding does. Below zero
/// for what is noise by orders of magnitude.
inline constexpr int kFewestDigits = -3;
double tolerance(int digits);

/// From a distance seen when the data were one ulp off. One digit is left for
/// roundings within the run, and `most` are promised at most.
int stable_digits(double distance, int most);

}  // namespace physinv
