#include "suite/nn/batch_norm.h"

#include <cmath>

#include "suite/core/check.h"
#include "suite/nn/activation.h"

namespace physinv::nn {
namespace {

constexpr double kEps = 1e-5, kMomentum = 0.1;

/// Columns of the tape slot, one number per feature each.
enum Column { kMean, kInverse, kUnbiased, kColumns };

}  // namespace

template <class T>
std::vector<TensorInfo> BatchNorm<T>::tensors() const {
  const Index n = this->inputs();
  return {{.name = {}, .kind = 's', .offset = 0, .size = n, .fan_in = n},
          {.name = {}, .kind = 'o', .offset = 0, .size = n, .fan_in = n}};
}

template <class T>
void BatchNorm<T>::initialize_state(T* state) const {
  const Index n = this->inputs();
  for (Index i = 0; i < n; ++i) state[i] = T(0), state[n + i] = T(1);
}

template <class T>
void BatchNorm<T>::forward(const LayerArgs<T>& at,
                           Lanes<const T> x,
                           Lanes<T> y) const {
  SUITE_CHECK(!at.training || x.samples >= 2,
              "batch statistics need two samples");
  const Index features = this->inputs();
  auto kept = at.tape->template slot<T>(at.slot, features, kColumns);
  const T* scale = at.parameters;
  const T* offset = at.parameters + features;
  for (Index i = 0; i < features; ++i) {
    const T* row = x.row(i);
    double mean = 0, variance = 0;
    if (at.training) {
      const auto n = static_cast<double>(x.samples);
      for (Index j = 0; j < x.samples; ++j) mean += double(row[j]);
      mean /= n;
      for (Index j = 0; j < x.samples; ++j)
        variance += (double(row[j]) - mean) * (double(row[j]) - mean);
      kept(i, kUnbiased) = static_cast<T>(variance / (n - 1));
      variance /= n;
    } else {
      mean = double(at.state[i]), variance = double(at.state[features + i]);
    }
    const T m = static_cast<T>(mean);
    const T inverse = static_cast<T>(1.0 / std::sqrt(variance + kEps));
    kept(i, kMean) = m, kept(i, kInverse) = inverse;
    using V = Simd<T, kNarrow>;
    const V s = broadcast<V>(scale[i]), o = broadcast<V>(offset[i]);
    for (Index j = 0; j < x.width; j += kLanes<T>) {
      const V normal = (load<V>(row + j) - m) * inverse;
      store(y.row(i) + j, multiply_add<T>(s, normal, o));
    }
  }
}

template <class T>
void BatchNorm<T>::backward(const LayerArgs<T>& at,
                            const Backward<T>& b) const {
  const Index features = this->inputs(), n = b.x.samples;
  const auto kept = at.tape->template view<T>(at.slot);
  for (Index i = 0; i < features; ++i) {
    const T m = kept(i, kMean), inverse = kept(i, kInverse);
    const T *x = b.x.row(i), *y_bar = b.y_bar.row(i);
    double sum = 0, product = 0;
    for (Index j = 0; j < n; ++j) {
      sum += double(y_bar[j]);
      product += double(y_bar[j]) * double((x[j] - m) * inverse);
    }
    if (b.parameters_bar != nullptr) {
      b.parameters_bar[i] = static_cast<T>(product);
      b.parameters_bar[features + i] = static_cast<T>(sum);
    }
    if (!b.x_bar) continue;
    T* x_bar = b.x_bar.row(i);
    const T factor = at.parameters[i] * inverse;
    // Outside training the statistics are constants.
    const T s = at.training ? static_cast<T>(sum / double(n)) : T(0);
    const T p = at.training ? static_cast<T>(product / double(n)) : T(0);
    for (Index j = 0; j < n; ++j)
      x_bar[j] = factor * (y_bar[j] - s - (x[j] - m) * inverse * p);
    for (Index j = n; j < b.x_bar.width; ++j) x_bar[j] = T(0);
  }
  if (b.x_bar) apply_gate(b.gate, b.x_bar);
}

template <class T>
void BatchNorm<T>::update_state(const Tape& tape,
                                std::size_t slot,
                                T* state) const {
  const Index features = this->inputs();
  const auto kept = tape.view<T>(slot);
  const T f = static_cast<T>(kMomentum), keep = static_cast<T>(1 - kMomentum);
  for (Index i = 0; i < features; ++i) {
    state[i] = keep * state[i] + f * kept(i, kMean);
    state[features + i] = keep * state[features + i] + f * kept(i, kUnbiased);
  }
}

template class BatchNorm<float>;
template class BatchNorm<double>;

}  // namespace physinv::nn
