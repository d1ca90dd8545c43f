#include "problems/heat/eigenspaces.h"

#include <cmath>
#include <map>

#include "suite/core/math.h"

namespace physinv {

HeatEigenspaces::HeatEigenspaces(const HeatModes& heat, double most)
    : fft_(heat.options().resolution) {
  const Batch<double>& s = heat.exponents();
  std::map<Index, Index> found;  // |k|^2 -> space
  number_ = s.unaryExpr([&](double e) -> Index {
    if (e > most) return -1;
    const auto square = static_cast<Index>(std::llround(e / s(1, 0)));
    const auto [space, added] = found.try_emplace(square, count());
    if (added) damping_.push_back(math::exp(-e));
    return space->second;
  });
}

Vector<double> HeatEigenspaces::lengths(VectorIn<double> y) const {
  using Lane = Pack<double, 2>;
  const Index n = fft_.size();
  Workspace work;
  auto u = work.take<double>(2, fft_.field()),
       z = work.take<double>(2, fft_.spectrum()),
       scratch = work.take<double>(2, fft_.scratch());
  u.rowwise() = y.transpose();
  const auto packs = [](auto& of) {
    return reinterpret_cast<Lane*>(of.data());
  };
  fft_.forward(packs(u), packs(z), packs(scratch));
  Vector<double> squares = Vector<double>::Zero(count());
  // Of a pair (k, l), (-k, l); those at -l have as much. What is its own
  // negative comes twice.
  const auto once = [&](Index m) { return m == 0 || 2 * m == n ? 0.5 : 1.0; };
  fft_.scale_modes(packs(z), [&](Index p, Index q, Lane re, Lane im) {
    const Index l = fft_.mode(p), k = fft_.mode(q);
    const Index r = number_(k, l);
    const double square = std::fma(re[0], re[0], im[0] * im[0]);
    if (r >= 0) squares(r) += 2 * once(k) * once(l) * square;
    return Lane{};
  });
  return squares.cwiseSqrt() / double(n);
}

Batch<double> HeatEigenspaces::spread(const Vector<double>& gain) const {
  return number_.unaryExpr([&](Index r) { return r < 0 ? 0.0 : gain(r); });
}

}  // namespace physinv
