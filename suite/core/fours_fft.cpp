#include "suite/core/fours_fft.h"

#include <algorithm>
#include <utility>

#include "suite/core/check.h"

namespace physinv {

template <class T>
bool FoursFft<T>::takes(Index size) {
  Index half = size / 2;
  while (half > 1 && half % 4 == 0) half /= 4;
  return size >= 32 && size % 2 == 0 && half == 1;
}

/// The factors are those of LanesFft, point by point.
template <class T>
FoursFft<T>::FoursFft(Index size) : lanes_(size) {
  SUITE_CHECK(takes(size), "the size must be twice a power of 4, at least 32");
  for (const auto& from : lanes_.passes_) {
    if (from.length == 4) continue;
    Pass pass{from.length / 16, {}, {}};
    pass.there.resize(from.there.size()), pass.back.resize(from.back.size());
    for (Index j = 0; j < from.length / 4; ++j)
      for (Index k = 0; k < 6; ++k) {
        const Index at = j / 4 * 24 + 4 * k + j % 4;
        pass.there[at] = from.there[6 * j + k];
        pass.back[at] = from.back[6 * j + k];
      }
    passes_.push_back(std::move(pass));
  }
  low_ = middle_ = {};
  for (const auto& from : lanes_.split_) {
    const Index low = place(2 * from.p), high = place(2 * from.q);
    Pair* to = low / 8 == 0 ? &low_ : &middle_;
    if (low / 8 > 3) {
      const auto found =
          std::find_if(pairs_.begin(), pairs_.end(), [&](const Pair& s) {
            return s.low == low / 8;
          });
      to = found != pairs_.end()
               ? &*found
               : &pairs_.emplace_back(Pair{low / 8, high / 8, {}, {}});
    }
    for (Index k = 0; k < 2; ++k) {
      to->there[4 * k + low % 4] = from.there[k];
      to->back[4 * k + low % 4] = from.back[k];
    }
  }
}

template class FoursFft<float>;
template class FoursFft<double>;

}  // namespace physinv
