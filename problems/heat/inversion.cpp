#include "problems/heat/inversion.h"

#include <atomic>

#include "problems/heat/likelihood.h"
#include "problems/heat/registers.h"
#include "suite/core/check.h"

namespace physinv {

using namespace heat_lanes;

HeatInversion::HeatInversion(const HeatModes& heat,
                             BatchIn<double> y,
                             Workspace& work)
    : heat_(heat),
      fft_(heat.options().resolution),
      samples_(y.cols()),
      places_(places()),
      y_(kept_.take<double>(4 * kWidth * Index(places_.size()),
                            registers(samples_, kWidth))),
      x_(kept_.take<double>(y_.rows(), y_.cols())) {
  check_size(y, fft_.field(), samples_);
  x_.setZero();
  for_spectra(work, [&](const Block& block, Fields f, P* of_y, P*) {
    block.load<double>(y, f.u);
    fft_.forward(f.u, f.z, f.scratch);
    for (const Place& place : places_)
      for (const Index i : place.at) *of_y++ = f.z[i];
  });
}

std::vector<HeatInversion::Place> HeatInversion::places() const {
  std::vector<Place> all;
  fft_.for_positions([&](Index p, Index q, const auto& at) {
    if (heat_.table().damping(p, q) >= 1e-30) all.push_back({p, q, at});
  });
  return all;
}

template <class F>
void HeatInversion::for_spectra(Workspace& work, F&& f) {
  const Workspace::Scope scope(work);
  const auto memory =
      work.take<double>(Fields::numbers(fft_), count_of(work.threads()));
  const auto packs = [](Scratch<double>& of, const Block& block) {
    return reinterpret_cast<P*>(of.col(block.first / kWidth).data());
  };
  for_fields(
      fft_, memory, work.threads(), samples_, [&](const Block& b, Fields s) {
        f(b, s, packs(y_, b), packs(x_, b));
      });
}

/// value(place, i) for the numbers of all places, zero elsewhere; i counts the
/// numbers that are kept.
template <class Fields, class F>
void HeatInversion::to_cells(Fields f, F&& value) const {
  std::fill_n(f.z, fft_.spectrum(), P{});
  Index i = 0;
  for (const Place& place : places_)
    for (const Index at : place.at) f.z[at] = value(place, i++);
  fft_.inverse(f.z, f.u, f.scratch);
}

void HeatInversion::step(Workspace& work) {
  const HeatTable& table = heat_.table();
  const double scale = 1 / static_cast<double>(fft_.field());
  std::atomic<std::uint64_t> skipped = 0;
  for_spectra(work, [&](const Block& block, Fields f, P* y, P* x) {
    const auto dy = [&](const Place& at, Index i) {
      return fma_lanes(-table.damping(at.p, at.q) - P{}, x[i], y[i]);
    };
    to_cells(f, dy);
    const Uncertainty uncertainty(
        uncertainty_of(f.u, fft_.field(), scale, heat_.options().noise_floor));
    Mask<double> known{};
    Index i = 0;
    for (const Place& at : places_) {
      std::array z{dy(at, i), dy(at, i + 1), dy(at, i + 2), dy(at, i + 3)};
      fft_.scale_modes_at(z, [&](P re, P im) {
        return gain_of(re, im, table, at.p, at.q, uncertainty, known);
      });
      for (const P& dx : z) x[i++] += dx;
    }
    for (Index k = 0; k < block.count; ++k)
      skipped += static_cast<std::uint64_t>(known[k]);
  });
  const auto left = fft_.positions() * fft_.positions() - Index(places_.size());
  skipped += static_cast<std::uint64_t>(2 * left * samples_);
  work.counts[Counter::skipped_zeros] += skipped;
}

void HeatInversion::estimate(BatchOut<double> x, Workspace& work) {
  check_size(x, fft_.field(), samples_);
  const double scale = 1 / static_cast<double>(fft_.field());
  for_spectra(work, [&](const Block& block, Fields f, const P*, const P* of) {
    to_cells(f, [&](const Place&, Index i) { return scale * of[i]; });
    block.store<double>(f.u, x);
  });
}

}  // namespace physinv
