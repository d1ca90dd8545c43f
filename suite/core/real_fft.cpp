#include "suite/core/real_fft.h"

#include <fftw3.h>

#include <cstdint>
#include <map>
#include <mutex>
#include <tuple>

#include "suite/core/check.h"
#include "suite/core/workspace.h"

namespace physinv {
namespace {

template <class T>
struct Fftw;

template <>
struct Fftw<double> {
  using Plan = fftw_plan;
  using Complex = fftw_complex;
  static constexpr auto plan_forward = fftw_plan_many_dft_r2c;
  static constexpr auto plan_inverse = fftw_plan_many_dft_c2r;
  static constexpr auto forward = fftw_execute_dft_r2c;
  static constexpr auto inverse = fftw_execute_dft_c2r;
  static constexpr auto destroy = fftw_destroy_plan;
};

template <>
struct Fftw<float> {
  using Plan = fftwf_plan;
  using Complex = fftwf_complex;
  static constexpr auto plan_forward = fftwf_plan_many_dft_r2c;
  static constexpr auto plan_inverse = fftwf_plan_many_dft_c2r;
  static constexpr auto forward = fftwf_execute_dft_r2c;
  static constexpr auto inverse = fftwf_execute_dft_c2r;
  static constexpr auto destroy = fftwf_destroy_plan;
};

template <class T>
auto* complex(T* p) {
  return reinterpret_cast<typename Fftw<T>::Complex*>(p);
}

template <class T>
Index aligned(Index reals) {
  constexpr Index kStep = static_cast<Index>(kAlignment / sizeof(T));
  return (reals + kStep - 1) / kStep * kStep;
}

template <class T>
void check_aligned(const T* a, const T* b) {
  const auto bits =
      reinterpret_cast<std::uintptr_t>(a) | reinterpret_cast<std::uintptr_t>(b);
  SUITE_CHECK(bits % kAlignment == 0, "a transform needs aligned arrays");
}

}  // namespace

template <class T>
struct RealFft<T>::Plans {
  Plans(int size, int count, Codelets codelets) {
    const unsigned how =
        FFTW_ESTIMATE | (codelets == Codelets::scalar ? FFTW_NO_SIMD : 0);
    const Index modes = size / 2 + 1;
    const auto signal = static_cast<int>(aligned<T>(size));
    const auto spectrum = static_cast<int>(aligned<T>(2 * modes) / 2);
    Workspace work;
    T* u = work.take<T>(signal, count).data();
    auto* y = complex(work.take<T>(2 * spectrum, count).data());
    // clang-format off
    forward = Fftw<T>::plan_forward(1, &size, count, u, nullptr, 1, signal,
                                    y, nullptr, 1, spectrum, how);
    inverse = Fftw<T>::plan_inverse(1, &size, count, y, nullptr, 1, spectrum,
                                    u, nullptr, 1, signal, how);
    // clang-format on
    SUITE_CHECK(forward != nullptr && inverse != nullptr, "FFTW has no plan");
  }
  ~Plans() { Fftw<T>::destroy(forward), Fftw<T>::destroy(inverse); }
  Plans(const Plans&) = delete;
  Plans& operator=(const Plans&) = delete;

  typename Fftw<T>::Plan forward, inverse;
};

template <class T>
auto RealFft<T>::plans(Index size, Index count, Codelets codelets)
    -> std::shared_ptr<const Plans> {
  // FFTW's planner is not for several threads at once.
  static std::mutex mutex;
  static std::map<std::tuple<Index, Index, Codelets>,
                  std::shared_ptr<const Plans>>
      all;
  const std::scoped_lock lock(mutex);
  auto& found = all[{size, count, codelets}];
  if (!found)
    found = std::make_shared<const Plans>(
        static_cast<int>(size), static_cast<int>(count), codelets);
  return found;
}

template <class T>
RealFft<T>::RealFft(Index size, Index count, Codelets codelets)
    : signal_stride_(aligned<T>(size)),
      spectrum_stride_(aligned<T>(2 * (size / 2 + 1))) {
  SUITE_CHECK(size >= 1 && count >= 1,
              "a transform needs at least one signal of at least one sample");
  plans_ = plans(size, count, codelets);
}

template <class T>
void RealFft<T>::forward(const T* u, T* y) const {
  check_aligned(u, y);
  // FFTW's interface has no const; transforms from reals keep their input.
  Fftw<T>::forward(plans_->forward, const_cast<T*>(u), complex(y));
}

template <class T>
void RealFft<T>::inverse(T* y, T* u) const {
  check_aligned(y, u);
  Fftw<T>::inverse(plans_->inverse, complex(y), u);
}

template class RealFft<float>;
template class RealFft<double>;

}  // namespace physinv
