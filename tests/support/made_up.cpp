#include "tests/support/made_up.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "suite/core/math.h"
#include "suite/harness/registry.h"
#include "suite/harness/study.h"

namespace physinv::test {

Dice::Dice(std::uint64_t seed) : engine_(seed), normals_(4096) {
  for (double& z : normals_) {
    z = std::sqrt(-2 * math::log(1 - uniform()));
    z *= math::cos(2 * std::numbers::pi * uniform());
  }
}

double Dice::decades(double width) {
  if (width == 0) return 1;
  std::vector<double>& known = decades_[width];
  if (known.empty())
    for (const double z : normals_)
      known.push_back(math::exp(width * std::numbers::ln10 * z));
  return known[engine_() % known.size()];
}

bool is_axis(const std::string& name) {
  static const std::set<std::string> kAxes{
      "cell", "cells", "point", "step", "time"};
  return kAxes.contains(name);
}

namespace {

/// How far numbers are thrown, in decades: a draw of its own.
struct Throw {
  double method = 0, example = 0;
  /// How far estimates are thrown from the truth, and those on the way; no
  /// decades.
  double estimate = 1, path = 1;

  static Throw of(Dice& dice) {
    constexpr double kWidths[] = {0, 0.02, 0.1, 0.5, 2, 6};
    return {kWidths[dice.below(6)],
            kWidths[dice.below(5)],
            math::pow(10, dice.uniform(-6, 1)),
            math::pow(10, dice.uniform(-3, 1))};
  }
};

/// Values of an array that is not drawn entry by entry.
constexpr Index kLarge = 4'000;

/// As many columns, again from the first one; of large fields as many as there
/// are, of the largest, which nothing asks about, the first.
Batch<double> columns(const Batch<double>& of, Index count) {
  if (of.rows() > kLarge && of.cols() > 1) return of.leftCols(1);
  if (of.rows() * count > kLarge) return of;
  Batch<double> out(of.rows(), of.cols() == 0 ? 0 : count);
  for (Index i = 0; i < out.cols(); ++i) out.col(i) = of.col(i % of.cols());
  return out;
}
Vector<double> entries(const Vector<double>& of, Index count) {
  return columns(of.transpose(), count).transpose();
}

/// Rows apart, and of what is not large its entries.
template <class M>
void scatter(M& values, Dice& dice, const Throw& t) {
  const double width = values.size() > kLarge ? 0 : t.example;
  for (Index r = 0; r < values.rows(); ++r) {
    const double row = dice.decades(t.method);
    const double sign = t.method > 0.2 && dice.chance(0.3) ? -1 : 1;
    values.row(r) *= sign * row;
    if (width == 0) continue;
    for (Index c = 0; c < values.cols(); ++c)
      values(r, c) *= dice.decades(width);
  }
}

/// Estimates near the truth or far from it.
void scatter_around(const Batch<double>& truth,
                    double far,
                    Batch<double>& x,
                    Dice& dice) {
  if (x.rows() != truth.rows() || x.cols() > truth.cols()) return;
  for (Index i = 0; i < x.cols(); ++i)
    for (Index j = 0; j < x.rows(); ++j)
      x(j, i) = truth(j, i) + far * dice.normal();
}

StageRecord made_up(const StageRecord& model,
                    const Case& c,
                    std::size_t position,
                    const CaseData& data,
                    Dice& dice,
                    const Throw& t) {
  StageRecord s = model;
  s.options = c.method->chain[position]->options();
  const Index n = c.info.n, was = model.loss.size();
  const double level = dice.decades(2 * t.method);
  s.case_name = c.info.name, s.crowded = false;
  s.loss = entries(model.loss, n);
  for (double& loss : s.loss) loss *= level * dice.decades(t.example);
  s.x = columns(model.x, model.x.cols() == was ? n : model.x.cols());
  scatter_around(data.x, t.estimate, s.x, dice);
  s.example_iterations = entries(model.example_iterations, n);
  s.example_evaluations = entries(model.example_evaluations, n);
  scatter(s.example_iterations, dice, t);
  s.example_iterations = s.example_iterations.cwiseAbs();
  if (!model.status.empty()) s.status.resize(static_cast<std::size_t>(n));

  s.iterations = c.stage_iterations[position];
  Curve& curve = s.curve;
  if (curve.points() > 0) {
    const double last = std::max(1.0, curve.iteration.back());
    const double stretch = static_cast<double>(s.iterations) / last;
    for (double& k : curve.iteration) k = std::round(k * stretch);
    const double slower = stretch * dice.decades(t.method);
    for (double& seconds : curve.seconds) seconds *= slower;
    if (curve.loss.rows() == was)
      curve.loss = columns(curve.loss.transpose(), n).transpose();
    curve.loss *= level;
    const Index unknowns = s.x.rows();
    for (Index r = 0; r < curve.x.rows() && unknowns > 0; ++r)
      for (Index k = 0; k < curve.x.cols(); ++k)
        curve.x(r, k) += t.path * dice.normal();
  }
  for (auto& [name, array] : s.arrays) {
    if (is_axis(name)) continue;
    if (array.cols() == was && array.cols() != curve.points())
      array = columns(array, n);
    else if (array.cols() == 1 && array.rows() == model.iterations)
      array = columns(array.transpose(), s.iterations).transpose();
    scatter(array, dice, t);
    if (name == "mean_loss") array = array.cwiseAbs();
  }
  if (dice.chance(0.02)) s.stop = Stop::diverged;
  s.clocks.solve.cpu *= dice.decades(t.method);
  s.clocks.solve.wall = s.clocks.solve.cpu;
  return s;
}

/// The model of a stage of a chain: at its place if it has the name, else the
/// first that has; null.
const StageRecord* stage_of(const CaseRecord& model,
                            const std::vector<std::string>& stages,
                            std::size_t position) {
  if (position < model.stages.size() &&
      model.stages[position].stage == stages[position])
    return &model.stages[position];
  for (const StageRecord& s : model.stages)
    if (s.stage == stages[position]) return &s;
  return nullptr;
}

bool has_stages_of(const CaseRecord& model, const CaseInfo& info) {
  for (std::size_t k = 0; k < info.stages.size(); ++k)
    if (stage_of(model, info.stages, k) == nullptr) return false;
  return true;
}
bool begins_like(const CaseRecord& model, const CaseInfo& info) {
  const auto& stages = model.info.stages;
  return stages.size() >= info.stages.size() &&
         std::equal(info.stages.begin(), info.stages.end(), stages.begin());
}
/// sip/poisson-80x60 -> sip/poisson
std::string stem(const std::string& experiment) {
  return experiment.substr(0, experiment.find('-', experiment.find('/')));
}

CaseRecord made_up(const CaseRecord& model,
                   const Case& c,
                   Dice& dice,
                   const Throw& t) {
  CaseRecord out{.info = c.info, .data = model.data, .stages = {}};
  for (Batch<double>* part : {&out.data.x, &out.data.y, &out.data.given})
    *part = columns(*part, c.info.n);
  out.data.y *= dice.decades(t.example);
  for (std::size_t k = 0; k < c.info.stages.size(); ++k)
    out.stages.push_back(
        made_up(*stage_of(model, c.info.stages, k), c, k, out.data, dice, t));
  return out;
}

}  // namespace

Models::Models(const Results& smoke) {
  for (const CaseRecord& c : smoke.cases()) {
    const auto [model, first] =
        models_.try_emplace({c.info.experiment, c.info.method}, c);
    if (c.info.n > model->second.info.n) model->second = c;
  }
}

const CaseRecord* Models::of(const CaseInfo& info) const {
  const auto own = models_.find({info.experiment, info.method});
  if (own != models_.end() && has_stages_of(own->second, info))
    return &own->second;
  const CaseRecord* found = nullptr;
  int best = 0;
  for (const auto& [key, model] : models_) {
    if (stem(key.first) != stem(streams_of(info.experiment)) ||
        !has_stages_of(model, info))
      continue;
    const int likeness = 1 + 4 * begins_like(model, info) +
                         2 * (key.first == info.experiment) +
                         (key.second == info.method);
    if (likeness > best) best = likeness, found = &model;
  }
  return found;
}

std::map<std::string, std::vector<Variants>> all_cases() {
  std::map<std::string, Variants> all;
  for (const std::string& profile : registry().profiles())
    if (profile != "smoke")
      for (Case& c : registry().expand(profile)) {
        Variants& known = all[c.info.name];
        if (std::none_of(known.begin(), known.end(), [&](const Case& k) {
              return k.stage_iterations == c.stage_iterations;
            }))
          known.push_back(std::move(c));
      }
  std::map<std::string, std::vector<Variants>> out;
  for (auto& [name, variants] : all) {
    std::sort(
        variants.begin(), variants.end(), [](const auto& a, const auto& b) {
          return a.stage_iterations < b.stage_iterations;
        });
    out[variants.front().info.experiment].push_back(std::move(variants));
  }
  return out;
}

Cases draw(const std::vector<const Variants*>& of,
           std::size_t number,
           const Models& models,
           Dice& dice) {
  std::map<std::pair<std::string, std::string>, Throw> throws;
  Cases all;
  for (const Variants* variants : of) {
    // The longest in every second draw, the others in turn.
    const Case* c = number % 2 == 0
                        ? &variants->back()
                        : &(*variants)[number / 2 % variants->size()];
    const CaseRecord* model = models.of(c->info);
    if (model == nullptr) continue;
    const auto [t, first] = throws.try_emplace(
        {c->info.experiment, c->info.method}, Throw::of(dice));
    all.push_back(made_up(*model, *c, dice, t->second));
  }
  return all;
}

}  // namespace physinv::test
