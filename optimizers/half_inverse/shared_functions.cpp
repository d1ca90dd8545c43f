#include "optimizers/half_inverse/shared_functions.h"

#include <cmath>

namespace physinv::hig {

using namespace linalg;
namespace {

/// The factor s_c that each function sees its output with; false if functions
/// see other outputs too, or samples differ.
template <class T>
bool seen_alike(const LayerRows<T>& output,
                Index rows,
                std::vector<double>& seen) {
  const Index functions = output.outputs;
  seen.resize(static_cast<std::size_t>(functions));
  for (Index o = 0; o < functions; ++o) {
    const T* b = output.b + o * output.b_stride;
    for (Index c = 0; c < functions; ++c)
      if (c != o && b[c] != T(0)) return false;
    for (Index r = functions; r < rows; ++r)
      if (!(b[r] == b[r - functions])) return false;
    if (!std::isfinite(b[o])) return false;
    seen[static_cast<std::size_t>(o)] = static_cast<double>(b[o]);
  }
  return true;
}

}  // namespace

struct SharedFunctions::Sizes {
  Index functions, samples, units, inputs;

  Index shared() const { return units + 1; }
  Index own() const { return units * (inputs + 1); }
  /// Columns of the output layer, which come first.
  Index outer() const { return functions * shared(); }
  Index unit_of(Index e) const {
    return e < units * inputs ? e / inputs : e - units * inputs;
  }
  template <class T>
  bool fit(const LayerRows<T>& output, const LayerRows<T>& hidden) const {
    return output.positions == 1 && hidden.positions == 1 &&
           output.outputs == functions && output.inputs == units &&
           samples >= shared() + own() + functions;
  }
};

/// The function that sees the unit best; the others see it so much less.
template <class T>
Index SharedFunctions::best_function(const Sizes& n,
                                     const T* weights,
                                     Index unit) {
  const auto factor = [&](Index c) {
    return seen_[static_cast<std::size_t>(c)] *
           static_cast<double>(weights[c * n.units + unit]);
  };
  Index best = 0;
  for (Index c = 1; c < n.functions; ++c)
    if (std::abs(factor(c)) > std::abs(factor(best))) best = c;
  const double most = factor(best);
  for (Index c = 0; c < n.functions; ++c)
    ratio_[static_cast<std::size_t>(c * n.units + unit)] =
        most == 0 ? 0 : factor(c) / most;
  return best;
}

/// Columns d (outer) (x, 1) of a hidden unit.
template <class T>
void SharedFunctions::write_unit(const Sizes& n,
                                 const LayerRows<T>& hidden,
                                 Index unit,
                                 Index function) {
  const T* b = hidden.b + unit * hidden.b_stride + function;
  double* const d = features_.column(n.shared() + n.units * n.inputs + unit);
  for (Index i = 0; i < n.samples; ++i)
    d[i] = static_cast<double>(b[i * n.functions]);
  for (Index j = 0; j < n.inputs; ++j) {
    const T* x = hidden.a + j * hidden.a_stride;
    double* to = features_.column(n.shared() + unit * n.inputs + j);
    for (Index i = 0; i < n.samples; ++i)
      to[i] = d[i] * static_cast<double>(x[i]);
  }
}

/// [F, g_1, g_2..]
template <class T>
void SharedFunctions::write_features(const Sizes& n,
                                     const LayerRows<T>& output,
                                     const LayerRows<T>& hidden,
                                     VectorIn<T> parameters,
                                     VectorIn<double> g) {
  ratio_.resize(static_cast<std::size_t>(n.functions * n.units));
  features_.open(n.samples, n.shared() + n.own() + n.functions);
  for (Index k = 0; k < n.units; ++k) {
    const T* a = output.a + k * output.a_stride;
    double* to = features_.column(k);
    for (Index i = 0; i < n.samples; ++i) to[i] = static_cast<double>(a[i]);
  }
  std::fill_n(features_.column(n.units), n.samples, 1.0);
  const T* const weights = parameters.data() + output.offset;
  for (Index k = 0; k < n.units; ++k)
    write_unit(n, hidden, k, best_function(n, weights, k));
  for (Index c = 0; c < n.functions; ++c) {
    double* to = features_.column(n.shared() + n.own() + c);
    for (Index i = 0; i < n.samples; ++i) to[i] = g(i * n.functions + c);
  }
}

/// A function's rows of the result, and of what still has to become a triangle.
void SharedFunctions::put_function(const Sizes& n,
                                   Index function,
                                   Index offset) {
  const Index c = function, shared = n.shared(), own = n.own();
  const Index at = c * shared, outer = n.outer(), h = outer + own;
  const double s = seen_[static_cast<std::size_t>(c)];
  for (Index k = 0; k < shared; ++k) {
    place_[static_cast<std::size_t>(at + k)] =
        offset + (k < n.units ? c * n.units + k : n.functions * n.units + c);
    for (Index i = 0; i <= k; ++i) r_(at + i, at + k) = s * top_(i, k);
    r_(at + k, h) = top_(k, shared + own + c);
  }
  for (Index e = 0; e < own; ++e) {
    const double q =
        ratio_[static_cast<std::size_t>(c * n.units + n.unit_of(e))];
    for (Index i = 0; i < shared; ++i)
      r_(at + i, outer + e) = q * top_(i, shared + e);
    double* to = rest_.column(e) + c * own;
    for (Index i = 0; i < own; ++i) to[i] = q * top_(shared + i, shared + e);
  }
  double* to = rest_.column(own) + c * own;
  for (Index i = 0; i < own; ++i) to[i] = top_(shared + i, shared + own + c);
}

template <class T>
bool SharedFunctions::triangle(std::span<const LayerRows<T>> layers,
                               VectorIn<T> parameters,
                               VectorIn<double> g,
                               Index per_sample) {
  if (layers.size() != 2) return false;
  const LayerRows<T>&output = layers[0], &hidden = layers[1];
  const Sizes n{.functions = per_sample,
                .samples = g.size() / per_sample,
                .units = hidden.outputs,
                .inputs = hidden.inputs};
  if (!n.fit(output, hidden)) return false;
  if (!seen_alike(output, g.size(), seen_)) return false;

  const Index shared = n.shared(), own = n.own(), outer = n.outer();
  write_features(n, output, hidden, parameters, g);
  top_.resize(shared + own, shared + own + n.functions);
  triangularize(features_, shared + own, top_);

  // Column order: the output layer's, function by function, then the hidden
  // layer's as its parameters lie.
  const Index p = outer + own;
  r_.setZero(p, p + 1);
  rest_.open(n.functions * own, own + 1);
  place_.resize(static_cast<std::size_t>(p));
  for (Index c = 0; c < n.functions; ++c) put_function(n, c, output.offset);
  for (Index e = 0; e < own; ++e)
    place_[static_cast<std::size_t>(outer + e)] = hidden.offset + e;
  corner_.resize(own, own + 1);
  triangularize(rest_, own, corner_);
  r_.bottomRightCorner(own, own + 1) = corner_;
  return true;
}

template bool SharedFunctions::triangle<float>(
    std::span<const LayerRows<float>>,
    VectorIn<float>,
    VectorIn<double>,
    Index);
template bool SharedFunctions::triangle<double>(
    std::span<const LayerRows<double>>,
    VectorIn<double>,
    VectorIn<double>,
    Index);

}  // namespace physinv::hig
