// The wave packet at and far beyond the ends of its interval, where a line
// search may well send it.
#include <vector>

#include "problems/wave_packet/wave_packet.h"
#include "suite/cases/numerics/common/accuracy.h"
#include "suite/cases/numerics/common/sweep_report.h"
#include "suite/cases/numerics/wave_packet/closed_form.h"
#include "suite/diagnostics/stability_sweep.h"
#include "suite/harness/registry.h"

namespace physinv::numerics::wave_packet {
namespace {

constexpr const char* kName = "numerics/wave-packet";

/// From well before the first sample to well after the last, and close to the
/// ends of the signal and of the prior.
std::vector<double> positions() {
  std::vector<double> t0;
  for (int t = -256; t <= 512; t += 2) t0.push_back(t);
  for (const double end : {1.0, 26.0, 230.0, 256.0})
    for (const double off : {-0.5, -1e-6, 0.0, 1e-6, 0.5})
      t0.push_back(end + off);
  return t0;
}

/// Where it cannot be seen, by powers of ten on either side.
std::vector<double> far_positions() {
  std::vector<double> t0;
  for (const double size : decades(3, 30))
    for (const double side : {-1.0, 1.0}) t0.push_back(side * size);
  return t0;
}

std::shared_ptr<const Stage> sweep(const char* name,
                                   const std::vector<double>& t0) {
  const WavePacketOptions physics;
  StabilitySweepOptions options{
      .name = name,
      .problems = {problems::wave_packet(physics)},
      .points = {},
      // Derivatives are near 100, their errors 1e-13 (float: 1e-6) of that.
      .zero = 1e-2};
  for (const double t : t0)
    options.points.push_back(
        {0, Vector<double>::Constant(1, (t - physics.centre) / physics.scale)});
  return stability_sweep(options);
}

const std::vector<NumericalParameter>& parameters() {
  static const std::vector<NumericalParameter>& all = declare_parameters(
      kName,
      {batch_parameter(
          problems::wave_packet(), 256, {}, wave_packet_closed_form())});
  return all;
}

/// Errors over the position.
Figure errors(const StageRecord* sweep) {
  Figure figure{.id = "errors",
                .title = "Errors over the position of the packet",
                .columns = 1,
                .note =
                    "Samples are at positions 1 to 256. Errors of gradients "
                    "are relative to themselves or to 1e-2."};
  if (sweep == nullptr) return figure;
  Panel panel{
      .x_label = "position t0", .y_label = "relative error", .y_log = true};
  const WavePacketOptions physics;
  const auto& error = sweep->arrays.at("error");
  const auto& point = sweep->arrays.at("point");
  for (Index c = 1; c < kSweepChecks; ++c) {
    const std::string name(kSweepCheckNames[static_cast<std::size_t>(c)]);
    Series s{.label = name, .method = name, .line = false, .markers = true};
    for (Index j = 0; j < error.cols(); ++j) {
      if (error(c, j) <= 0) continue;
      s.x.push_back(physics.centre + physics.scale * point(0, j));
      s.y.push_back(error(c, j));
    }
    panel.series.push_back(std::move(s));
  }
  figure.panels.push_back(std::move(panel));
  return figure;
}

Section report(const Evidence& e) {
  const auto* near = find_sweep(e, "positions");
  const auto* far = find_sweep(e, "far");
  Section section{
      .tables = {sweep_table("positions", "Packets inside and near", near),
                 sweep_table("far", "Packets out of sight", far)},
      .figures = {errors(near)}};
  add_accuracy(section, e);
  return section;
}

std::vector<Row> rows() {
  std::vector<Row> all = accuracy_rows(4);
  all.push_back({.methods = {kStability}, .n = {1}, .seeds = {0}});
  return all;
}

}  // namespace

void add_experiments(Registry& r) {
  r.add(Experiment{
      .name = kName,
      .title = "Numerics of the wave packet",
      .citation = {.paper = "jpo", .where = "App. D.1"},
      .problem = problems::wave_packet(),
      .setting = {},  // nothing is learned here
      .profiles = {{.name = "smoke", .rows = rows()},
                   {.name = "quick", .rows = rows()},
                   {.name = "paper", .rows = rows()}},
      .methods = {{kStability,
                   {sweep("positions", positions()),
                    sweep("far", far_positions())}},
                  accuracy_method(parameters())},
      .claims = {adjoint_claim("N1", {"positions", "far"})},
      .report = report,
  });
}

}  // namespace physinv::numerics::wave_packet
