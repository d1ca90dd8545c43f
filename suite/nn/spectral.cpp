#include "suite/nn/spectral.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

#include "suite/core/blocks.h"
#include "suite/nn/activation.h"
#include "suite/nn/convolution.h"
#include "suite/nn/gemm.h"

namespace physinv::nn {
namespace {

constexpr Index kMostParts = 8;  ///< partial sums of W's gradient

template <class T>
Rows<T> rows_from(Rows<T> x, Index first, Index count) {
  return {x.data + first * x.stride, count, x.samples};
}

/// The rows one behind the other, without gaps, through f.
template <class T>
void pack_rows(Activation f, Rows<const T> x, T* to) {
  using V = NarrowPack<T>;
  for (Index i = 0; i < x.rows; ++i, to += x.width)
    for (Index j = 0; j < x.width; j += kNarrowLanes<T>)
      store(to + j, activate_lanes<T>(f, load<V>(x.row(i) + j)));
}

/// W's gradient of one row, by the kernel of a convolution along the shared
/// columns.
template <class T>
void pull_local(const ConvShape& shape,
                const std::vector<WindowRun>& runs,
                Activation f,
                Rows<const T> x,
                Rows<const T> y_bar,
                T* sums,
                Workspace& work) {
  const auto active = take_rows<T>(work, y_bar.rows, x.samples);
  for (Index i = 0; i < active.rows; ++i)
    pack_rows<T>(f, rows_from(x, i, 1), active.row(i));
  accumulate_weights<T>(shape, runs, active, y_bar, 0, shape.positions(), sums);
}

/// f'(x) x_dot in `to`.
template <class T>
void push_activation(Activation f,
                     Rows<const T> x,
                     Rows<const T> x_dot,
                     Rows<T> to) {
  std::copy_n(x_dot.data, x_dot.rows * x_dot.stride, to.data);
  apply_gate<T>({f, x}, to);
}

template <class T>
class SpectralBlock final : public Layer<T> {
 public:
  explicit SpectralBlock(const SpectralOptions& o)
      : Layer<T>(o.from.positions() * o.channels,
                 o.to.positions() * o.channels),
        o_(o),
        shared_{std::min(o.from.columns, o.to.columns),
                std::min(o.from.rows, o.to.rows)},
        product_(o.from, o.period, o.channels, o.modes),
        out_(o.to, o.period, product_.row_count(), o.modes) {}

  std::vector<TensorInfo> tensors() const override {
    const Index c = o_.channels;
    const TensorInfo modes{.kind = 'f',
                           .size = product_.parameter_count() / 4,
                           .fan_in = c,
                           .fan_out = c,
                           .up_to = 1 / static_cast<double>(c * c)};
    return {modes,
            modes,
            modes,
            modes,
            {.kind = 'k', .size = c * c, .fan_in = c, .fan_out = c},
            {.kind = 'b', .size = c, .fan_in = c, .fan_out = c}};
  }
  std::size_t slots() const override { return 1; }
  void forward(const Run<T>& at, Rows<const T> x, Rows<T> y) const override {
    apply({.parameters = at.parameters,
           .bias = bias(at.parameters),
           .f = o_.before,
           .modes = open_modes(x, *at.tape, at.slot)},
          x,
          y,
          *at.work);
  }

  void backward(const Replay<T>& at, const Backward<T>& b) const override {
    pull({.parameters = at.parameters,
          .f = o_.before,
          .gate = o_.before,
          .modes = at.tape->template view<T>(at.slot).data()},
         b,
         *at.work);
    if (b.x_bar) apply_gate(b.gate, b.x_bar);
  }

  /// (S + W) f'(x) x_dot, whose modes stay, + (S + W)_dot f(x) + b_dot.
  void tangent(const Replay<T>& at, const Tangent<T>& t) const override {
    Workspace& work = *at.work;
    const Workspace::Scope scope(work);
    const Rows<T> f_dot = take_rows<T>(work, t.x.rows, t.x.samples);
    push_activation<T>(o_.before, t.x, t.x_dot, f_dot);
    apply({.parameters = at.parameters,
           .modes = open_modes(t.x, *t.dots, at.slot)},
          f_dot,
          t.y_dot,
          work);
    const Rows<T> more = take_rows<T>(work, t.y_dot.rows, t.x.samples);
    apply({.parameters = t.parameters_dot,
           .bias = bias(t.parameters_dot),
           .f = o_.before,
           .modes =
               work.take<T>(2 * o_.channels * t.x.width, product_.mode_count())
                   .data()},
          t.x,
          more,
          work);
    add_to_rows<T>(more, t.y_dot);
  }

  /// `pull` is bilinear in (weights, f(x)) and y_bar; b's part in y_bar alone.
  void backward_tangent(const Replay<T>& at,
                        const BackwardTangent<T>& b) const override {
    Workspace& work = *at.work;
    const Workspace::Scope scope(work);
    const Product here{.parameters = at.parameters,
                       .f = o_.before,
                       .modes = at.tape->template view<T>(at.slot).data()};
    pull(here, b.base(), work);
    pull(here, b.base_dot(), work);
    const Rows<T> f_dot = take_rows<T>(work, b.x.rows, b.x.samples);
    push_activation<T>(o_.before, b.x, b.x_dot, f_dot);
    const Index weights =
        product_.parameter_count() + o_.channels * o_.channels;
    T* const sum = work.take<T>(weights + o_.channels, 1).data();
    Rows<T> more;
    if (b.x_bar) more = take_rows<T>(work, b.x.rows, b.x.samples);
    pull({.parameters = b.parameters_dot,
          .modes = b.dots->template view<T>(at.slot).data()},
         {.x = f_dot,
          .y = b.y,
          .y_bar = b.y_bar,
          .parameters_bar = sum,
          .x_bar = more},
         work);
    for (Index i = 0; i < weights; ++i) b.parameters_bar_dot[i] += sum[i];
    if (!b.x_bar) return;
    add_to_rows<T>(more, b.x_bar_dot);
    apply_gate_tangent<T>({o_.before, b.x}, b.x_dot, b.x_bar, b.x_bar_dot);
  }

  double operations() const override {
    const auto sums = [&](const PlaneModes<T>& m) {
      return double(m.grid().rows * m.column_sums()) *
             double(m.grid().columns + m.row_sums());
    };
    const double c = double(o_.channels);
    return 2 * c * (sums(in()) + sums(out_)) +
           8 * c * c * double(product_.mode_count()) +
           2 * c * c * double(shared_.positions());
  }

 private:
  /// One product (S + W) f(x), bilinear in weights and f(x).
  struct Product {
    const T* parameters;  ///< S and W
    const T* bias = nullptr;
    Activation f = Activation::identity;
    /// Its derivative multiplies x_bar, which else is f(x)'s cotangent.
    Activation gate = Activation::identity;
    T* modes;  ///< Z, written on the way up, read on the way down
  };

  T* open_modes(const Rows<const T>& x, Tape& tape, std::size_t slot) const {
    return tape.slot<T>(slot, 2 * o_.channels * x.width, product_.mode_count())
        .data();
  }

  void apply(const Product& at,
             Rows<const T> x,
             Rows<T> y,
             Workspace& all) const {
    using V = NarrowPack<T>;
    const Index c = o_.channels, block = c * x.width;
    const Index pitch = in().pitch(block), sums = in().column_sums();
    const T* const w = local(at.parameters);
    const Workspace::Scope scope(all);
    T* const t =
        all.take<T>(pitch, sums * std::max(o_.from.rows, o_.to.rows)).data();
    T* const u = all.take<T>(pitch, sums * in().row_sums()).data();

    for_blocks(all, o_.from.rows, [&](Index r, Workspace& work) {
      T* const row = work.take<T>(pitch, o_.from.columns).data();
      for (Index q = 0; q < o_.from.columns; ++q) {
        T* const f = row + q * pitch;
        pack_rows<T>(at.f, rows_from(x, (r * o_.from.columns + q) * c, c), f);
        if (!meets(r) || q >= shared_.columns) continue;
        gemm<T>({.m = c,
                 .n = x.width,
                 .k = c,
                 .a = w,
                 .a_row = c,
                 .a_k = 1,
                 .b = f,
                 .b_stride = x.width,
                 .c = y.row((r * o_.to.columns + q) * c),
                 .c_stride = y.stride,
                 .bias = at.bias});
      }
      in().analyse_row(row, r, block, t);
    });
    for_blocks(all, sums, [&](Index g, Workspace&) {
      in().analyse_rows(t, g, block, u);
    });
    product_.apply(at.parameters, x.samples, u, at.modes, all);
    for_blocks(all, sums, [&](Index g, Workspace&) {
      out_.synthesise_rows(u, g, block, t);
    });
    for_blocks(all, o_.to.rows, [&](Index r, Workspace& work) {
      T* const row = work.take<T>(pitch, o_.to.columns).data();
      out_.synthesise_row(t, r, block, row);
      for (Index q = 0; q < o_.to.columns; ++q) {
        const bool added = meets(r) && q < shared_.columns;
        for (Index o = 0; o < c; ++o) {
          const V alone = broadcast<V>(at.bias != nullptr ? at.bias[o] : T(0));
          T* const to = y.row((r * o_.to.columns + q) * c + o);
          const T* const from = row + q * pitch + o * x.width;
          for (Index j = 0; j < x.width; j += kNarrowLanes<T>)
            store(to + j,
                  load<V>(from + j) + (added ? load<V>(to + j) : alone));
        }
      }
    });
  }

  /// Leaves x_bar without b.gate.
  void pull(const Product& at, const Backward<T>& b, Workspace& all) const {
    const Index c = o_.channels, block = c * b.x.width;
    const Index pitch = in().pitch(block), sums = in().column_sums();
    const Workspace::Scope scope(all);
    T* const t =
        all.take<T>(pitch, sums * std::max(o_.from.rows, o_.to.rows)).data();
    T* const u = all.take<T>(pitch, sums * in().row_sums()).data();
    for_blocks(all, o_.to.rows, [&](Index r, Workspace& work) {
      T* const row = work.take<T>(pitch, o_.to.columns).data();
      for (Index q = 0; q < o_.to.columns; ++q)
        pack_rows<T>(Activation::identity,
                     rows_from(b.y_bar, (r * o_.to.columns + q) * c, c),
                     row + q * pitch);
      out_.analyse_row(row, r, block, t);
    });
    for_blocks(all, sums, [&](Index g, Workspace&) {
      out_.analyse_rows(t, g, block, u);
    });
    if (b.parameters_bar != nullptr) {
      std::fill_n(b.parameters_bar, product_.parameter_count(), T(0));
      channel_sums<T>(all,
                      b.y_bar,
                      c,
                      b.parameters_bar + product_.parameter_count() + c * c);
    }
    product_.pull(at.parameters,
                  at.modes,
                  b.x.samples,
                  u,
                  b.parameters_bar,
                  bool(b.x_bar),
                  all);
    if (b.x_bar)
      for_blocks(all, sums, [&](Index g, Workspace&) {
        in().synthesise_rows(u, g, block, t);
      });
    pull_rows(at, b, t, all);
  }

  const PlaneModes<T>& in() const { return product_.sums(); }
  const T* local(const T* parameters) const {
    return parameters + product_.parameter_count();
  }
  const T* bias(const T* parameters) const {
    return local(parameters) + o_.channels * o_.channels;
  }
  bool meets(Index r) const { return r < shared_.rows; }

  /// Cotangents of a row's inputs: W's part, if the rows meet, and the modes'.
  void pull_inputs(const Product& at,
                   bool meets,
                   const T* row,
                   Rows<const T> x,
                   Rows<const T> y_bar,
                   Rows<T> x_bar) const {
    using V = NarrowPack<T>;
    const Index c = o_.channels, pitch = in().pitch(c * x.width);
    for (Index q = 0; q < o_.from.columns; ++q) {
      const bool added = meets && q < shared_.columns;
      if (added)
        gemm<T>({.m = c,
                 .n = x.width,
                 .k = c,
                 .a = local(at.parameters),
                 .a_row = 1,
                 .a_k = c,
                 .b = y_bar.row(q * c),
                 .b_stride = y_bar.stride,
                 .c = x_bar.row(q * c),
                 .c_stride = x_bar.stride});
      for (Index i = q * c; i < (q + 1) * c; ++i)
        for (Index j = 0; j < x.width; j += kNarrowLanes<T>) {
          V sum = load<V>(row + q * pitch + (i - q * c) * x.width + j);
          if (added) sum += load<V>(x_bar.row(i) + j);
          store(x_bar.row(i) + j,
                pull_lanes<T>(at.gate, load<V>(x.row(i) + j), sum));
        }
    }
  }

  /// x_bar and W_bar row by row; t: the sums of x's cotangent, or null.
  void pull_rows(const Product& at,
                 const Backward<T>& b,
                 const T* t,
                 Workspace& all) const {
    const Index c = o_.channels, block = c * b.x.width,
                pitch = in().pitch(block);
    const Index columns = o_.from.columns;
    const ConvShape shape{{shared_.columns, 1}, c, c, {1, 1}};
    const auto runs = window_runs(shape.grid, shape.taps, Padding::zero);
    const Index parts = std::min(kMostParts, o_.from.rows);
    std::optional<WeightSums<T>> sums;
    if (b.parameters_bar != nullptr) sums.emplace(shape, parts, false, all);
    const auto pull_row = [&](Index r, T* part, Workspace& work) {
      const Workspace::Scope scope(work);
      const Rows<const T> y_bar =
          meets(r)
              ? rows_from(b.y_bar, r * o_.to.columns * c, shared_.columns * c)
              : Rows<const T>();
      const Rows<const T> x = rows_from(b.x, r * columns * c, columns * c);
      if (sums && meets(r)) pull_local(shape, runs, at.f, x, y_bar, part, work);
      if (!b.x_bar) return;
      T* const row = work.take<T>(pitch, columns).data();
      in().synthesise_row(t, r, block, row);
      pull_inputs(at,
                  meets(r),
                  row,
                  x,
                  y_bar,
                  rows_from(b.x_bar, r * columns * c, columns * c));
    };
    for_blocks(all, parts, [&](Index part, Workspace& work) {
      const Index end = o_.from.rows * (part + 1) / parts;
      T* const part_sums = sums ? sums->begin(part) : nullptr;
      for (Index r = o_.from.rows * part / parts; r < end; ++r)
        pull_row(r, part_sums, work);
    });
    if (sums) sums->finish(b.parameters_bar + product_.parameter_count());
  }

  SpectralOptions o_;
  Grid shared_;             ///< positions that both x and y have
  ModeProduct<T> product_;  ///< S between the transforms
  PlaneModes<T> out_;
};

}  // namespace

template <class T>
LayerPointer<T> spectral_block(const SpectralOptions& options) {
  return std::make_unique<SpectralBlock<T>>(options);
}

template decltype(spectral_block<float>) spectral_block<float>;
template decltype(spectral_block<double>) spectral_block<double>;

}  // namespace physinv::nn
