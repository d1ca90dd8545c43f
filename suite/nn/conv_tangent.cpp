#include "suite/nn/conv_tangent.h"

#include <algorithm>

#include "suite/nn/channel_norm_tangent.h"
#include "suite/nn/convolution_tangent.h"

namespace physinv::nn {
namespace {

/// f(begin, end) on blocks of `some` of `count` positions.
template <class F>
void for_positions(Threads* threads, Index count, Index some, F&& f) {
  for_blocks(threads, (count + some - 1) / some, [&](Index block, int) {
    f(block * some, std::min((block + 1) * some, count));
  });
}

/// What the passes of a block's tangents share: the tapes' views and sums over
/// all samples and positions.
template <class T>
struct Moving {
  /// Of a `Tangent` or a `BackwardTangent`.
  template <class Step>
  Moving(const BlockParts<T>& owner, const Replay<T>& args, const Step& step)
      : block(owner),
        at(args),
        threads(block.conv.threads(at, step.x.samples)),
        z(kept_rows<T>(
            *at.tape, at.slot, block.conv.outputs(), step.x.samples)),
        z_dot(kept_rows<T>(*step.dots, at.slot, z.rows, z.samples)),
        some(block.conv.per_block(z)),
        of{{.shape = block.norm,
            .at = {at.tape->template view<T>(at.slot + 1).data(),
                   block.norm.channels},
            .parameters = at.parameters + block.conv.parameter_count(),
            .x = z,
            .y = step.y},
           {step.dots->template view<T>(at.slot + 1).data(),
            block.norm.channels},
           step.parameters_dot + block.conv.parameter_count(),
           z_dot} {}

  Index sums_size() const { return 2 * of.shape.channels; }
  Index blocks() const { return block.conv.blocks(z); }
  /// Of bar, then of bar (x - mean) inverse: channels each, at positions
  /// [begin, end).
  void add_up(const NormColumns<T>& columns,
              Rows<const T> x,
              Rows<const T> bar,
              Index begin,
              Index end,
              T* sums) const {
    const NormShape plain{.grid = of.shape.grid, .channels = of.shape.channels};
    block_sums<T>({plain, columns, of.parameters, x, x}, bar, begin, end, sums);
  }
  /// Room for the sums of all blocks.
  T* parts() const {
    return at.work->template take<T>(sums_size(), blocks()).data();
  }
  /// Those of the blocks, put together in `work`.
  T* total(const T* parts) const {
    T* sums = at.work->template take<T>(sums_size(), 1).data();
    combine_sums(parts, blocks(), of.shape.channels, sums);
    return sums;
  }
  /// What a sum is divided by; zero outside training, where the statistics are
  /// constants.
  T share() const {
    if (!block.by_batch) return T(0);
    return T(1) / static_cast<T>(of.shape.positions() * z.samples);
  }

  /// Bias, scale and offset's part of a gradient, from the sums; or of its
  /// derivative, then with the sums of the gradient as `base`.
  void put(const T* sums, const T* base, T* parameters_bar) const {
    if (parameters_bar == nullptr) return;
    const Index channels = of.shape.channels;
    T* bias_bar = parameters_bar + block.conv.shape().weights();
    T *scale_bar = bias_bar + channels, *offset_bar = scale_bar + channels;
    for (Index c = 0; c < channels; ++c) {
      offset_bar[c] = sums[c], scale_bar[c] = sums[channels + c];
      bias_bar[c] = T(0);
      if (block.by_batch) continue;
      bias_bar[c] = of.parameters[c] * sums[c];
      if (base != nullptr) bias_bar[c] += of.parameters_dot[c] * base[c];
      bias_bar[c] *= of.at.inverse[c];
    }
  }

  const BlockParts<T>& block;
  const Replay<T>& at;
  Threads* threads;
  Rows<T> z, z_dot;
  Index some;
  NormTangent<T> of;
};

}  // namespace

template <class T>
void push_block(const BlockParts<T>& block,
                const Replay<T>& at,
                const Tangent<T>& t) {
  const Index channels = block.norm.channels;
  open_rows<T>(*t.dots, at.slot, block.conv.outputs(), t.x.samples);
  t.dots->template slot<T>(at.slot + 1, channels, NormDots<T>::kCount);
  const Workspace::Scope scope(*at.work);
  const Moving<T> m(block, at, t);
  T* parts = m.parts();
  push_convolution(
      block.conv, at, t, m.z_dot, [&](Index i, Index begin, Index end) {
        T* part = parts + i * m.sums_size();
        m.add_up(m.of.at, m.z, m.z_dot, begin, end, part);
      });
  const T* const sums = m.total(parts);
  for (Index c = 0; c < channels; ++c) {
    m.of.dots.mean[c] = m.share() * sums[c];
    m.of.dots.slope[c] = m.share() * sums[channels + c];
  }
  for_positions(m.threads,
                block.norm.pooled().positions(),
                m.some,
                [&](Index begin, Index end) {
                  normalise_tangent<T>(m.of, t.y_dot, begin, end);
                });
}

template <class T>
void pull_block(const BlockParts<T>& block,
                const Replay<T>& at,
                const BackwardTangent<T>& b) {
  const Index channels = block.norm.channels;
  const Workspace::Scope scope(*at.work);
  const Moving<T> m(block, at, b);
  // First the cotangents of the normalised, then, in place, of z.
  const auto bar = take_rows<T>(*at.work, m.z.rows, m.z.samples);
  const auto bar_dot = take_rows<T>(*at.work, m.z.rows, m.z.samples);
  const auto open = [&](Index begin, Index end) {
    open_cells<T>(
        m.of, b.y_dot, b.y_bar, b.y_bar_dot, bar, bar_dot, begin, end);
  };
  // Cells of several positions are opened first; else each block is added up
  // while it is in the cache.
  const bool pooled = block.norm.pool;
  if (pooled)
    for_positions(m.threads, block.norm.pooled().positions(), m.some, open);

  // (sum of bar n)' = sum of bar' n + bar n', n' = inverse (x' - mean' - n
  // slope).
  T* ones = at.work->template take<T>(channels, 1).data();
  std::fill_n(ones, channels, T(1));
  NormColumns<T> moved = m.of.at;
  moved.mean = m.of.dots.mean, moved.inverse = ones;
  T *base_parts = m.parts(), *dot_parts = m.parts(), *more_parts = m.parts();
  for_positions(
      m.threads, block.norm.positions(), m.some, [&](Index begin, Index end) {
        if (!pooled) open(begin, end);
        const Index i = begin / m.some * m.sums_size();
        m.add_up(m.of.at, m.z, bar, begin, end, base_parts + i);
        m.add_up(m.of.at, m.z, bar_dot, begin, end, dot_parts + i);
        m.add_up(moved, m.z_dot, bar, begin, end, more_parts + i);
      });
  T *const base = m.total(base_parts), *const dot = m.total(dot_parts);
  const T* const more = m.total(more_parts);
  for (Index c = 0; c < channels; ++c)
    dot[channels + c] +=
        m.of.at.inverse[c] *
        (more[channels + c] - m.of.dots.slope[c] * base[channels + c]);
  m.put(base, nullptr, b.parameters_bar);
  m.put(dot, base, b.parameters_bar_dot);
  for (T* sum : {base, dot})
    for (Index c = 0; c < 2 * channels; ++c) sum[c] *= m.share();
  for_positions(
      m.threads, block.norm.positions(), m.some, [&](Index begin, Index end) {
        pull_norm_tangent<T>(m.of,
                             {.sum = base,
                              .product = base + channels,
                              .sum_dot = dot,
                              .product_dot = dot + channels},
                             bar,
                             bar_dot,
                             begin,
                             end);
      });
  pull_convolution<T>(block.conv, at, b, bar, bar_dot);
}

#define PHYSINV_INSTANTIATE(T)                    \
  template decltype(push_block<T>) push_block<T>; \
  template decltype(pull_block<T>) pull_block<T>;
PHYSINV_INSTANTIATE(float)
PHYSINV_INSTANTIATE(double)
#undef PHYSINV_INSTANTIATE

}  // namespace physinv::nn
