// Fig. 3 of the JPO paper, in addition to what all its experiments show.
#include <fmt/format.h>

#include <string>
#include <vector>

#include "problems/wave_packet/wave_packet.h"
#include "suite/cases/jpo/common/report.h"
#include "suite/core/any_problem.h"
#include "suite/evidence/landscape.h"
#include "suite/evidence/picture.h"
#include "suite/harness/registry.h"

namespace physinv::jpo::wave_packet {
namespace {

/// One signal of the problem.
struct Example {
  Example() {
    const auto s = problem.sample(0, 1, Rng::root("jpo/wave-packet/figure", 0));
    truth = s.x;
    signal = s.y;
    packet.resize(signal.rows(), 1);
    Workspace work;
    problem.forward(truth, Batch<double>::Zero(signal.rows(), 1), packet, work);
  }
  double centre() const {
    const WavePacketOptions o;
    return o.centre + o.scale * truth(0, 0);
  }

  AnyProblem<double> problem{problems::wave_packet()};
  Batch<double> truth, signal, packet;
};

Figure waveform(const Example& e) {
  std::vector<double> t;
  for (Index i = 0; i < e.signal.rows(); ++i)
    t.push_back(static_cast<double>(i + 1));
  return {.id = "fig3a",
          .title = "Task: where is the packet?",
          .where = "Fig. 3a",
          .panels = {{.x_label = "t",
                      .y_label = "signal",
                      .series = {{.label = "observed",
                                  .method = "gd",
                                  .x = t,
                                  .y = {e.signal.col(0).begin(),
                                        e.signal.col(0).end()}},
                                 {.label = "without noise",
                                  .method = "truth",
                                  .x = t,
                                  .y = {e.packet.col(0).begin(),
                                        e.packet.col(0).end()}}}}},
          .columns = 1,
          .note = fmt::format("t0 = {:.1f}.", e.centre())};
}

Figure landscape(const Example& e) {
  const WavePacketOptions o;
  const Vector<double> t0 = Vector<double>::LinSpaced(1021, 1, 256);
  return {.id = "fig3b",
          .title = "Loss and gradient over the packet's centre",
          .where = "Fig. 3b",
          .panels = loss_and_derivative(
              e.problem.problem(),
              {e.signal.col(0), Vector<double>::Zero(o.samples)},
              (t0.array() - o.centre).matrix().transpose() / o.scale,
              {.label = "t0", .at = t0, .scale = o.scale},
              "bfgs"),
          .note = fmt::format("The signal above: t0 = {:.1f}.", e.centre())};
}

/// The signal, and the packet where it is said to be.
Panel packet_found(const FoundBy& found, const Pictured& problem) {
  const WavePacketOptions o;
  const AnyProblem<double> physics(problems::wave_packet(o));
  const Index samples = problem.y.size();
  Batch<double> y(samples, 1);
  Workspace work;
  physics.forward(found.x, Vector<double>::Zero(samples), y, work);
  Series signal{.label = "observed",
                .method = "signal",
                .style = PlotStyle{Hue::grey, Marker::circle}},
      packet{.label = "packet at t0",
             .method = "packet",
             .style = PlotStyle{Hue::blue, Marker::circle}};
  for (Index i = 0; i < samples; ++i) {
    const double t = static_cast<double>(i + 1);
    signal.x.push_back(t), packet.x.push_back(t);
    signal.y.push_back(few_digits(problem.y(i)));
    packet.y.push_back(few_digits(y(i, 0)));
  }
  return {.title = fmt::format(
              "{}: t0 = {:.1f}", found.who, o.centre + o.scale * found.x(0)),
          .x_label = "t",
          .series = {std::move(signal), std::move(packet)},
          .y_min = -1.5,
          .y_max = 1.5,
          .x_min = 1,
          .x_max = static_cast<double>(samples)};
}

PictureOptions packets() {
  return {.title =
              "One signal: the packet where it is, at the first guess, "
              "and where each method finds it",
          .note = "Grey: the signal that methods are given, with its noise.",
          .draw = packet_found};
}

JpoReportOptions report_options() {
  return {.solved = within_of_truth(1 / WavePacketOptions{}.scale),
          .curve_sizes = {},
          .trajectory_size = 128,
          .unknowns = {"xi"},
          .fraction = {"fig3d", "Fig. 3d"},
          .improvement = {"fig7", "Fig. 7"},
          .curves = {"fig8", "Fig. 8"},
          .trajectories = {"fig9", "Fig. 9"},
          .weight_change = {"fig10", "Fig. 10"},
          .picture = packets()};
}

/// Fig. 3c: gradient descent next to BFGS and JPO, at the largest n.
Figure three_curves(JpoReportOptions options, const Evidence& e) {
  options.methods = {"gd", "jpo"};
  options.curves = {"fig3c", "Fig. 3c"};
  const JpoReport report(options, e);
  const Index n = report.largest_size();
  options.curve_sizes = {n};
  Figure figure = report.curves();
  figure.columns = 1;
  return figure;
}

Section report(const Evidence& e) {
  const JpoReportOptions options = report_options();
  Section section = jpo_section(options, e);
  const Example example;
  const std::vector<Figure> first = {
      waveform(example), landscape(example), three_curves(options, e)};
  section.figures.insert(section.figures.begin(), first.begin(), first.end());
  return section;
}

Section report_head(const Evidence& e) {
  JpoReportOptions options = report_options();
  options.methods = {"jpo"};
  Section section = jpo_section(options, e);
  // The paper's numbers are with the other network.
  for (Table& table : section.tables) table.where.clear();
  for (Figure& figure : section.figures) figure.where.clear();
  return section;
}

}  // namespace

void add_reports(Registry& r) {
  r.add_report("jpo/wave-packet", report);
  r.add_report("jpo/wave-packet-head", report_head);
}

}  // namespace physinv::jpo::wave_packet
