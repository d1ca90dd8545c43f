#include "suite/nn/convolution.h"

#include <algorithm>

namespace physinv::nn {
namespace {

constexpr double kThreadFlops = 0.5e6, kPartFlops = 4e6;
constexpr Index kMostParts = 8;

}  // namespace

template <class T>
void channel_sums(Workspace& work, Rows<const T> x, Index channels, T* sums) {
  const Workspace::Scope scope(work);
  auto per_row = work.take<T>(x.rows, 1);
  row_sums<T>(x, per_row.data());
  auto totals = work.take<double>(channels, 1);
  totals.setZero();
  for (Index i = 0; i < x.rows; i += channels)
    for (Index c = 0; c < channels; ++c) totals(c) += double(per_row(i + c));
  for (Index c = 0; c < channels; ++c) sums[c] = static_cast<T>(totals(c));
}

template <class T>
Convolution<T>::Convolution(
    Grid grid, Index in, Index out, const Taps& taps, Padding padding)
    : shape_{.grid = window_output(grid, taps, padding),
             .in = in,
             .out = out,
             .taps = taps},
      input_positions_(grid.positions()),
      runs_(window_runs(grid, taps, padding)),
      flipped_runs_(flipped_runs(grid, taps, padding)) {
  const Index positions = shape_.positions();
  // Circular: the outer rows of a plane see the far side.
  if (padding == Padding::circular && !grid.flat())
    edge_ = std::min(taps.y / 2 * grid.columns, positions);
  for (const WindowRun& run : runs_) {
    const Index end = run.first + run.count;
    if (end <= edge_ || run.first >= positions - edge_) continue;
    for (const Segment& s : run.segments)
      reach_ = std::max({reach_, -s.shift, s.shift + s.taps - 1});
  }
}

template <class T>
std::vector<TensorInfo> Convolution<T>::tensors() const {
  const Index fan_in = shape_.depth(), fan_out = shape_.flipped().depth();
  return {
      {.kind = 'k',
       .size = shape_.weights(),
       .fan_in = fan_in,
       .fan_out = fan_out},
      {.kind = 'b', .size = shape_.out, .fan_in = fan_in, .fan_out = fan_out}};
}

template <class T>
double Convolution<T>::operations() const {
  return 2.0 * static_cast<double>(shape_.weights() * shape_.positions());
}

template <class T>
Threads* Convolution<T>::threads(const Replay<T>& at, Index samples) const {
  const bool worth = operations() * static_cast<double>(samples) > kThreadFlops;
  return worth ? at.work->threads() : nullptr;
}

template <class T>
Index Convolution<T>::parts(Index samples) const {
  const double flops = operations() * static_cast<double>(samples);
  return std::clamp(static_cast<Index>(flops / kPartFlops),
                    Index{1},
                    std::min(kMostParts, shape_.positions()));
}

template void channel_sums(Workspace&, Rows<const float>, Index, float*);
template void channel_sums(Workspace&, Rows<const double>, Index, double*);
template class Convolution<float>;
template class Convolution<double>;

}  // namespace physinv::nn
