#include "suite/core/problem.h"

#include "suite/core/check.h"

namespace physinv {

template <>
Samples<double> Problem<float>::draw_set(Index, Index, const Rng&, bool) const {
  SUITE_CHECK(false, "samples can only be drawn in double");
}

template <>
Samples<double> Problem<double>::draw_set(Index first,
                                          Index count,
                                          const Rng& rng,
                                          bool labelled) const {
  const Shape rows = shape();
  const Drawn what = labelled ? Drawn::unknowns : drawn();
  Samples<double> all{Batch<double>::Zero(rows.unknowns, count),
                      Batch<double>::Zero(rows.observations, count),
                      Batch<double>::Zero(rows.given, count)};
  for (Index i = 0; i < count; ++i) {
    const Rng own = rng.child(static_cast<std::uint64_t>(first + i));
    Stream stream = own.stream();
    SampleOut sample{
        first + i, own, labelled, all.x.col(i), all.y.col(i), all.given.col(i)};
    draw(stream, sample);
  }
  if (what == Drawn::observations) all.x.resize(0, count);
  if (what != Drawn::unknowns) return all;
  Workspace work;
  forward({all.x, all.given}, all.y, work);
  if (!labelled) hide(all.given);
  return all;
}

}  // namespace physinv
