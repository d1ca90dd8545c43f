#include "suite/nn/skip.h"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "suite/core/check.h"
#include "suite/nn/activation.h"
#include "suite/nn/chain.h"

namespace physinv::nn {
namespace {

template <class T>
Rows<T> from_row(Rows<T> x, Index row) {
  x.data += row * x.stride;
  return x;
}

template <class T>
class Skip final : public Layer<T> {
 public:
  Skip(Index positions, Chain<T> inner)
      : Layer<T>(inner.inputs(), inner.inputs() + inner.outputs()),
        positions_(positions),
        own_(inner.inputs() / positions),
        more_(inner.outputs() / positions),
        inner_(std::move(inner)),
        keeps_last_(inner_[inner_.size() - 1].reads_output()) {
    SUITE_CHECK(inner_.inputs() == own_ * positions &&
                    inner_.outputs() == more_ * positions,
                "a skip connection needs fields on one grid");
  }

  std::vector<TensorInfo> tensors() const override { return inner_.tensors(); }
  Index state_count() const override { return inner_.state_count(); }
  void initialize_state(T* state) const override {
    inner_.initialize_state(state);
  }
  std::size_t slots() const override { return inner_.slots(); }
  void forward(const Run<T>& at, Rows<const T> x, Rows<T> y) const override {
    const std::size_t end = inner_.size() - 1;
    const auto outputs = inner_.opened(*at.tape, at.slot, x.samples);
    const Workspace::Scope scope(*at.work);
    const Rows<T> last =
        keeps_last_ ? outputs(end)
                    : take_rows<T>(*at.work, inner_.outputs(), x.samples);
    copy(at, x, own_, y, all(), own_);
    inner_.forward(at, x, 0, end + 1, [&](std::size_t i) {
      return i < end ? outputs(i) : last;
    });
    copy(at, last, more_, from_row(y, own_), all(), more_);
  }

  void backward(const Replay<T>& at, const Backward<T>& b) const override {
    using V = NarrowPack<T>;
    const Workspace::Scope scope(*at.work);
    const Bars<T> bars(inner_, b.x.samples, *at.work);
    const Rows<T> y_bar = bars(inner_.size());
    copy(at, from_row(b.y_bar, own_), all(), y_bar, more_, more_);
    inner_.backward(at,
                    {.x = b.x,
                     .y_bar = y_bar,
                     .parameters_bar = b.parameters_bar,
                     .x_bar = b.x_bar},
                    0,
                    kept(*at.tape, at, b.x.samples),
                    bars);
    if (!b.x_bar) return;
    for_rows(
        at, positions_, own_ * b.x_bar.stride, [&](Index begin, Index end) {
          for (Index p = begin; p < end; ++p)
            for (Index c = 0; c < own_; ++c) {
              T* const to = b.x_bar.row(p * own_ + c);
              for (Index j = 0; j < b.x_bar.width; j += kNarrowLanes<T>)
                store(
                    to + j,
                    load<V>(b.y_bar.row(p * all() + c) + j) + load<V>(to + j));
            }
        });
    apply_gate(b.gate, b.x_bar);
  }

  void tangent(const Replay<T>& at, const Tangent<T>& t) const override {
    const Index n = t.x.samples;
    copy(at, t.x_dot, own_, t.y_dot, all(), own_);
    inner_.tangent(at,
                   {.x = t.x,
                    .x_dot = t.x_dot,
                    .parameters_dot = t.parameters_dot,
                    .dots = t.dots},
                   0,
                   inner_.size(),
                   kept(*at.tape, at, n),
                   inner_.opened(*t.dots, at.slot, n));
    const Rows<T> last = inner_.kept(*t.dots, at.slot, n)(inner_.size() - 1);
    copy(at, last, more_, from_row(t.y_dot, own_), all(), more_);
  }

  void backward_tangent(const Replay<T>& at,
                        const BackwardTangent<T>& b) const override {
    const Index n = b.x.samples;
    const Workspace::Scope scope(*at.work);
    const Bars<T> bars(inner_, n, *at.work), bars_dot(inner_, n, *at.work);
    BackwardTangent<T> inner = b;
    const auto take_in = [&](Rows<const T>& bar, Rows<T> to) {
      copy(at, from_row(bar, own_), all(), to, more_, more_);
      bar = to;
    };
    take_in(inner.y_bar, bars(inner_.size()));
    take_in(inner.y_bar_dot, bars_dot(inner_.size()));
    if (b.x_bar) inner.x_bar = bars(0), inner.x_bar_dot = bars_dot(0);
    inner_.backward_tangent(at,
                            inner,
                            0,
                            kept(*at.tape, at, n),
                            kept(*b.dots, at, n),
                            bars,
                            bars_dot);
    if (!b.x_bar) return;
    const auto join = [&](Rows<const T> whole, Rows<T> part, Rows<T> to) {
      copy(at, whole, all(), to, own_, own_);
      add_to_rows<T>(part, to);
    };
    join(b.y_bar, bars(0), b.x_bar);
    join(b.y_bar_dot, bars_dot(0), b.x_bar_dot);
  }

  void update_state(const Tape& tape,
                    std::size_t slot,
                    T* state) const override {
    inner_.update_state(tape, slot, state);
  }
  double operations() const override { return inner_.operations(); }

 private:
  Index all() const { return own_ + more_; }
  /// y on a tape. What the last layer does not read again was never there.
  auto kept(const Tape& tape, const Replay<T>& at, Index samples) const {
    return [this, y = inner_.kept(tape, at.slot, samples)](std::size_t i) {
      return i + 1 < inner_.size() || keeps_last_ ? y(i) : Rows<T>{};
    };
  }
  /// `count` rows of every position, from and to fields of different width.
  void copy(const Replay<T>& at,
            Rows<const T> from,
            Index from_step,
            Rows<T> to,
            Index to_step,
            Index count) const {
    const Index numbers = count * from.stride;
    for_rows(at, positions_, numbers, [&](Index begin, Index end) {
      for (Index p = begin; p < end; ++p)
        std::copy_n(from.row(p * from_step), numbers, to.row(p * to_step));
    });
  }

  Index positions_;
  Index own_, more_;  ///< channels of x, and of what `inner` makes of it
  Chain<T> inner_;
  bool keeps_last_;
};

}  // namespace

template <class T>
LayerPointer<T> skip(Index positions, Layers<T> inner) {
  return std::make_unique<Skip<T>>(positions, Chain<T>(std::move(inner)));
}

template decltype(skip<float>) skip<float>;
template decltype(skip<double>) skip<double>;

}  // namespace physinv::nn
