// The entries of jpo-wave-packet about the physics, the classical solvers and
// JPO; those about networks alone have their test with the networks.

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "problems/wave_packet/wave_packet.h"
#include "suite/core/any_problem.h"
#include "suite/nn/vgg.h"
#include "tests/support/jpo_entries.h"
#include "tests/support/jpo_reference.h"
#include "tests/support/physics.h"
#include "tests/support/run_reference.h"

namespace physinv::test {
namespace {

const std::string kId = "jpo-wave-packet";

/// The signals that all other entries are about.
Batch<double> signals() {
  return columns(spoken_of(kId, "observations").at("y"));
}

/// As many samples as the signals have; everything else is the specification's.
WavePacketOptions options_of(Index samples) { return {.samples = samples}; }

double xi_of(double t0) {
  const WavePacketOptions o;
  return (t0 - o.centre) / o.scale;
}

/// Of every column of x against the same column of targets.
template <class T>
auto evaluated(const Batch<double>& xi, const Batch<double>& targets) {
  Physics at{AnyProblem<T>(problems::wave_packet(options_of(targets.rows())))};
  const Batch<T> x = xi.cast<T>();
  const Batch<T> given = Batch<T>::Zero(targets.rows(), xi.cols());
  auto found = at.losses(x, given, targets.cast<T>());
  EXPECT_EQ(at.forward(x, given), found.y);
  return found;
}

/// The truth leaves noise, whose deviation the file may state: nothing in it is
/// larger than such noise gets, and nothing looks like the packet.
void check_observations(const Json& entry) {
  const Batch<double> y = columns(entry.at("y"));
  const Vector<double> t0 = vector(entry.at("t0_true"), y.cols());
  const Batch<double> xi = t0.unaryExpr(&xi_of).transpose();
  const Batch<double> packet = evaluated<double>(xi, y).y;
  const double stated = setting(entry, "noise", "noise", 0);
  constexpr double kRounded = 1e-6;  // the file's decimals
  for (Index i = 0; i < y.cols(); ++i) {
    const Vector<double> noise = y.col(i) - packet.col(i);
    const double root = std::sqrt(double(y.rows()));
    const double deviation = noise.norm() / root + kRounded;
    if (stated > 0) {
      EXPECT_NEAR(deviation, stated, 5 / root * stated) << "signal " << i;
    }
    EXPECT_LE(noise.cwiseAbs().maxCoeff(), 5.5 * deviation) << "signal " << i;
    EXPECT_LE(std::abs(noise.dot(packet.col(i))),
              5 * deviation * packet.col(i).norm())
        << "signal " << i;
  }
}

template <class T>
void check_case(const Json& c, const Batch<double>& y, const Comparator& same) {
  const auto e =
      evaluated<T>(Batch<double>::Constant(1, y.cols(), number(c.at("xi"))), y);
  EXPECT_TRUE(same(e.loss, vector(c.at("loss"))));
  EXPECT_TRUE(same(e.x_bar.row(0).transpose(), vector(c.at("grad_xi"))));
}

void check_loss(const Json& entry) {
  const Batch<double> y = signals();
  ASSERT_FALSE(entry.at("points").empty());
  for (const Json& c : entry.at("points")) {
    SCOPED_TRACE(c.at("xi").dump());
    EXPECT_NEAR(xi_of(number(c.at("t0"))), number(c.at("xi")), 1e-14);
    check_case<double>(c, y, EntryTolerance(entry).array());
    check_case<float>(c, y, {1e-4, 0});
  }
}

void check_packet(const Json& entry) {
  const Batch<double> xi =
      Batch<double>::Constant(1, 1, xi_of(number(entry.at("t0"))));
  const Vector<double> u = vector(entry.at("u"));
  EXPECT_TRUE(
      EntryTolerance(entry).array()(evaluated<double>(xi, u).y.col(0), u));
  EXPECT_TRUE(Comparator(1e-4, 0)(evaluated<float>(xi, u).y.col(0), u));
}

void check_landscape(const Json& entry) {
  const Vector<double> stored = vector(entry.at("loss"));
  Batch<double> xi(1, stored.size());
  for (Index k = 0; k < stored.size(); ++k)
    xi(0, k) = xi_of(static_cast<double>(k + 1));
  const Batch<double> y = signals().col(0).replicate(1, stored.size());
  EXPECT_TRUE(
      EntryTolerance(entry).array()(evaluated<double>(xi, y).loss, stored));
  EXPECT_TRUE(Comparator(1e-4, 0)(evaluated<float>(xi, y).loss, stored));
}

void check_bfgs(const Json& entry) {
  const Batch<double> y = signals();
  const Json runs = entry.at("runs");
  ASSERT_EQ(static_cast<Index>(runs.size()), y.cols());
  for (Index i = 0; i < y.cols(); ++i) {
    SCOPED_TRACE(i);
    const Json stored = runs.at(static_cast<std::size_t>(i));
    const auto run = record_bfgs(
        Matching{y.col(i), problems::wave_packet(options_of(y.rows()))},
        vector(stored.at("x0"), 1),
        stored.at("gtol"));
    expect_run(entry, stored, run, 1);
  }
}

void check_packet_descent(const Json& entry) {
  const Batch<double> y = signals();
  const Matching at{y, problems::wave_packet(options_of(y.rows()))};
  check_descent(entry, at, 1, y.cols(), 1e-5);  // section 3: gtol
}

void check_jpo(const Json& entry) {
  const Batch<double> y = signals();
  const Samples<double> s{{}, y, Batch<double>::Zero(y.rows(), y.cols())};
  for (const Precision precision : {Precision::f64, Precision::f32}) {
    SCOPED_TRACE(to_string(precision));
    expect_jpo(kId,
               entry,
               {.inputs = {Field::observations},
                .network = nn::vgg({.grid = {.columns = y.rows()},
                                    .features = {16, 16, 16, 16, 16},
                                    .hidden = {64, 32}}),
                .rate = 1e-3,
                // Fifteen times M9's: the signal is 128 times as long as a unit
                // of xi, so what rounding does to the network's output, 1e-6,
                // moves the gradient by up to 1.02e-3 of its largest entry.
                .single = {.gradient = 1.5e-3}},
               problems::wave_packet(options_of(y.rows())),
               s,
               precision);
  }
}

TEST(WavePacketReference, EveryEntry) {
  const std::map<std::string, EntryCheck> checks = {
      {"clip_percentile_*", check_clip},
      {"boundary_loss", check_boundary},
      {"bfgs_test_functions", check_test_functions},
      {"observations", check_observations},
      {"loss_and_gradient", check_loss},
      {"packet", check_packet},
      {"landscape", check_landscape},
      {"bfgs", check_bfgs},
      {"gd_adaptive", check_packet_descent},
      {"jpo_g2s", check_jpo}};
  const std::set<std::string> of_networks = {"g2s_eval", "surrogate_unet"};
  check_entries(kId, checks, of_networks);
}

}  // namespace
}  // namespace physinv::test
