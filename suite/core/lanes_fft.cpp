#include "suite/core/lanes_fft.h"

#include <numbers>
#include <utility>

#include "suite/core/check.h"
#include "suite/core/math.h"

namespace physinv {

template <class T>
LanesFft<T>::LanesFft(Index size) : half_(size / 2), mode_(half_) {
  SUITE_CHECK(size >= 4 && (size & (size - 1)) == 0,
              "the size must be a power of two, at least 4");
  const auto turn = [](T* w, double part, double scale, int sign) {
    const double angle = 2 * std::numbers::pi * part;
    w[0] = static_cast<T>(scale * math::cos(angle));
    w[1] = static_cast<T>(-sign * scale * math::sin(angle));
  };
  Index length = half_;
  for (; length >= 4; length /= 4) {
    Pass pass{length, {}, {}};
    pass.there.resize(6 * (length / 4)), pass.back.resize(6 * (length / 4));
    for (Index j = 0; j < length / 4; ++j) {
      for (Index k = 0; k < 3; ++k) {
        const double part = double(j * (k + 1)) / double(length);
        turn(&pass.there[6 * j + 2 * k], part, 1, 1);
        turn(&pass.back[6 * j + 2 * k], part, 1, -1);
      }
    }
    passes_.push_back(std::move(pass));
  }
  pairs_last_ = length == 2;
  place(0, half_, 0, 1);
  std::vector<Index> position(half_);
  for (Index p = 0; p < half_; ++p) position[mode_[p]] = p;
  middle_ = position[half_ / 2];
  for (Index m = 1; m < half_ - m; ++m) {
    Pair pair{position[m], position[half_ - m], {}, {}};
    turn(pair.there, double(m) / double(size), 0.5, 1);
    turn(pair.back, double(m) / double(size), 1, -1);
    split_.push_back(pair);
  }
}

template <class T>
void LanesFft<T>::place(Index first, Index length, Index offset, Index step) {
  if (length == 1) {
    mode_[first] = offset;
    return;
  }
  const Index parts = length == 2 ? 2 : 4;
  for (Index r = 0; r < parts; ++r)
    place(first + r * (length / parts),
          length / parts,
          offset + r * step,
          parts * step);
}

template LanesFft<float>::LanesFft(Index);
template LanesFft<double>::LanesFft(Index);

}  // namespace physinv
