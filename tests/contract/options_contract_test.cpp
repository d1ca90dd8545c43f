// Options of stages, problems and networks: two that differ in any field have
// different keys, and no field can be left out of a list.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "baselines/neural_adjoint.h"
#include "baselines/supervised.h"
#include "optimizers/classical.h"
#include "optimizers/half_inverse_direct.h"
#include "optimizers/jpo.h"
#include "optimizers/local_steps.h"
#include "optimizers/training.h"
#include "problems/billiards/billiards.h"
#include "problems/exponential/exponential.h"
#include "problems/grid_poisson/grid_poisson.h"
#include "problems/heat/heat.h"
#include "problems/kuramoto_sivashinsky/kuramoto_sivashinsky.h"
#include "problems/marker_flow/marker_flow.h"
#include "problems/navier_stokes/navier_stokes.h"
#include "problems/noisy_absolute/noise_lanes.h"
#include "problems/oscillators/oscillators.h"
#include "problems/poisson/poisson.h"
#include "problems/quantum_dipole/quantum_dipole.h"
#include "problems/robotic_arm/robotic_arm.h"
#include "problems/scaled_output/scaled_output.h"
#include "problems/scaling/scaling.h"
#include "problems/sine_plane/sine_plane.h"
#include "problems/wave_packet/wave_packet.h"
#include "suite/cases/sip/heat/direct.h"
#include "suite/diagnostics/alignment.h"
#include "suite/diagnostics/growth.h"
#include "suite/diagnostics/half_inverse_stress.h"
#include "suite/diagnostics/stability_sweep.h"
#include "suite/diagnostics/work_precision.h"
#include "suite/harness/child.h"
#include "suite/harness/registry.h"
#include "suite/nn/cnn.h"
#include "suite/nn/fno.h"
#include "suite/nn/mlp.h"
#include "suite/nn/pooled_cnn.h"
#include "suite/nn/unet.h"
#include "suite/nn/vgg.h"

namespace physinv::test {
namespace {

using NoisyAlignment = AlignmentOptions<NoiseLanes>;

/// Values that differ from `value` in one number, name or entry each.
struct Others {
  std::vector<bool> operator()(bool value) const { return {!value}; }
  template <std::floating_point T>
  std::vector<T> operator()(T value) const {
    // Decays stay below 1, exponents above -1.
    const T other = std::isfinite(value) ? value / 2 + T(0.03) : T(7);
    return {std::nextafter(value, T(1e9)), other};
  }
  template <std::integral T>
  std::vector<T> operator()(T value) const {
    return {value + 1};
  }
  template <class E>
  requires std::is_enum_v<E> std::vector<E>
  operator()(E value) const { return {value == E{0} ? E{1} : E{0}}; }
  std::vector<std::string> operator()(const std::string& value) const {
    return {value + "x"};
  }
  template <class T, std::size_t N>
  std::vector<std::array<T, N>> operator()(const std::array<T, N>& v) const {
    return by_entry(v);
  }
  template <class T>
  std::vector<std::vector<T>> operator()(const std::vector<T>& value) const {
    auto all = by_entry(value);
    all.push_back(value);
    all.back().push_back(entry<T>());
    return all;
  }
  template <class T>
  std::vector<std::optional<T>> operator()(const std::optional<T>& v) const {
    if (!v) return {T{}};
    std::vector<std::optional<T>> all = {std::nullopt};
    for (auto& other : (*this)(*v)) all.push_back(other);
    return all;
  }
  template <class... T>
  std::vector<std::variant<T...>> operator()(
      const std::variant<T...>& value) const {
    std::vector<std::variant<T...>> all;
    const auto add = [&](const std::variant<T...>& other) {
      if (other.index() != value.index()) all.push_back(other);
    };
    (add(T{}), ...);
    std::visit(
        [&](const auto& held) {
          for (auto& other : (*this)(held)) all.push_back(other);
        },
        value);
    return all;
  }
  template <Listing O>
  std::vector<O> operator()(const O& value) const {
    constexpr std::size_t kMembers = kListed<decltype(value.fields())>;
    std::vector<O> all;
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      (by_member<I>(value, all), ...);
    }
    (std::make_index_sequence<kMembers>());
    return all;
  }
  // Functions have no name of their own; what holds them names them.
  std::vector<Metrics> operator()(const Metrics& value) const {
    return {{.name = value.name + "x"}};
  }
  std::vector<LateError> operator()(const LateError& value) const {
    return {{.name = "late"}, {.name = value.name, .share = 0.5}};
  }
  std::vector<SignalRecipe> operator()(SignalRecipe value) const {
    value.algorithm += "x";
    return {value};
  }
  std::vector<ProblemRecipe> operator()(ProblemRecipe value) const {
    std::vector<ProblemRecipe> all(2, value);
    all[0].name += "x", all[1].options.emplace_back("x", "1");
    return all;
  }
  std::vector<ClosedForm> operator()(const ClosedForm&) const {
    return {{.forward = [](auto, auto, auto) {}}};
  }
  std::vector<Horizon> operator()(const Horizon& value) const {
    std::vector<Horizon> all;
    for (const double time : (*this)(value.time))
      all.push_back({time, value.problem});
    for (const auto& problem : (*this)(value.problem))
      all.push_back({value.time, problem});
    return all;
  }
  std::vector<SweepPoint> operator()(const SweepPoint& value) const {
    return {{value.problem + 1, value.x}, {value.problem, value.x() * 2}};
  }
  std::vector<std::shared_ptr<Answers>> operator()(
      const std::shared_ptr<Answers>&) const {
    return {};  // found once or again, the same
  }

 private:
  template <class T>
  static T entry() {
    if constexpr (std::is_same_v<T, SweepPoint>) {
      return {0, Vector<double>::Ones(1)};
    } else {
      return {};
    }
  }
  template <class C>
  std::vector<C> by_entry(const C& value) const {
    std::vector<C> all;
    for (std::size_t i = 0; i < value.size(); ++i)
      for (const auto& other : (*this)(value[i])) {
        all.push_back(value);
        all.back()[i] = other;
      }
    return all;
  }
  template <std::size_t I, class O>
  void by_member(const O& value, std::vector<O>& all) const {
    for (const auto& other : (*this)(std::get<I>(listed_members(value)))) {
      all.push_back(value);
      std::get<I>(listed_members(all.back())) = other;
    }
  }
};

/// What a content key has of a stage.
std::string key(const Stage& stage) {
  return fmt::format("{} {} {} {}",
                     stage.name(),
                     stage.default_iterations(),
                     stage.takes_row_iterations(),
                     in_line(stage.options()));
}

/// Structs of options that were looked at here, by their names.
std::set<std::string>& seen() {
  static std::set<std::string> names;
  return names;
}

template <class O, class Key>
void expect_distinct(const char* name, const O& options, Key key_of) {
  SCOPED_TRACE(name);
  seen().insert(name);
  const auto others = Others{}(options);
  std::set<std::string> keys = {key_of(options)};
  for (const O& other : others)
    EXPECT_TRUE(keys.insert(key_of(other)).second) << key_of(other);
}

void problems() {
  const auto distinct = [](const char* name, const auto& options) {
    expect_distinct(
        name, options, [](const auto& o) { return in_line(describe(o)); });
  };
  distinct("BilliardsOptions", BilliardsOptions{});
  distinct("ExponentialOptions", ExponentialOptions{});
  distinct("GridPoissonOptions", GridPoissonOptions{});
  distinct("HeatOptions", HeatOptions{});
  distinct("KuramotoSivashinskyOptions", KuramotoSivashinskyOptions{});
  distinct("MarkerFlowOptions", MarkerFlowOptions{});
  distinct("NavierStokesOptions", NavierStokesOptions{});
  distinct("NoisyAbsoluteOptions", NoisyAbsoluteOptions{});
  distinct("OscillatorsOptions", OscillatorsOptions{});
  distinct("PoissonOptions", PoissonOptions{});
  distinct("PoissonOptions", PoissonOptions{.relative = 1e-3});
  distinct("QuantumDipoleOptions", QuantumDipoleOptions{.angles = {0.5}});
  distinct("RoboticArmOptions", RoboticArmOptions{});
  distinct("ScaledOutputOptions", ScaledOutputOptions{});
  distinct("ScalingOptions", ScalingOptions{});
  distinct("SinePlaneOptions", SinePlaneOptions{});
  distinct("WavePacketOptions", WavePacketOptions{});
}

void networks() {
  const auto distinct = [](const char* name, const auto& options, auto make) {
    expect_distinct(
        name, options, [make](const auto& o) { return make(o).description; });
  };
  distinct("CnnOptions", nn::CnnOptions{.features = {8, 4}}, nn::cnn);
  distinct("FnoOptions", nn::FnoOptions{.grid = {64, 64}}, nn::fno);
  distinct("MlpOptions", nn::MlpOptions{.hidden = {64}}, nn::mlp);
  distinct("PooledCnnOptions",
           nn::PooledCnnOptions{.features = {4}, .hidden = {8, 8}},
           nn::pooled_cnn);
  distinct("UnetOptions", nn::UnetOptions{}, nn::unet);
  distinct("VggOptions", nn::VggOptions{.features = {4}}, nn::vgg);
}

void stages() {
  const auto distinct = [](const char* name, const auto& options, auto make) {
    expect_distinct(
        name, options, [make](const auto& o) { return key(*make(o)); });
  };
  distinct("JpoOptions", JpoOptions{}, jpo_fit);
  distinct("BfgsStageOptions", BfgsStageOptions{}, bfgs_solve);
  distinct("BfgsStageOptions", BfgsStageOptions{}, bfgs_refine);
  distinct("LbfgsbStageOptions",
           LbfgsbStageOptions{.lower = {0}, .upper = {1}},
           lbfgsb_solve);
  distinct("GradientDescentStageOptions",
           GradientDescentStageOptions{},
           gradient_descent_solve);
  distinct(
      "BoldDescentStageOptions", BoldDescentStageOptions{}, bold_descent_solve);
  distinct("LocalStepsOptions", LocalStepsOptions{}, local_steps);
  distinct("HalfInverseDirectOptions",
           HalfInverseDirectOptions{},
           half_inverse_direct);
  distinct("RegressionOptions", RegressionOptions{}, supervised_fit);
  distinct(
      "NeuralAdjointOptions", NeuralAdjointOptions{}, neural_adjoint_solve);
  distinct("DirectOptions", heat::DirectOptions{}, heat::direct);
  const std::vector<StepOptions> rules = {AdamOptions{},
                                          SgdOptions{},
                                          AdagradOptions{},
                                          AdadeltaOptions{},
                                          RmspropOptions{}};
  for (const StepOptions& rule : rules)
    distinct("TrainingOptions", TrainingOptions{.rule = rule}, train);
  distinct("TrainingOptions",
           TrainingOptions{.rule = HalfInverseStepOptions{}},
           train);
}

void rules_of_curvature() {
  // A stage of theirs takes neither a chunk nor any signal.
  const auto words = [](const auto& o) { return in_line(describe(o)); };
  expect_distinct("AdaHessianOptions", AdaHessianOptions{}, words);
  expect_distinct("HessianFreeOptions", HessianFreeOptions{}, words);
  for (const TrainingOptions& options :
       {TrainingOptions{.rule = AdaHessianOptions{}},
        TrainingOptions{.rule = HessianFreeOptions{}}})
    expect_distinct("TrainingOptions", options, [&](const auto& o) {
      return fmt::format(
          "{} {} {} {}", o.stage, o.iterations, o.own_length, words(o));
    });
}

void diagnostics() {
  const auto distinct = [](const char* name, const auto& options, auto make) {
    expect_distinct(
        name, options, [make](const auto& o) { return key(*make(o)); });
  };
  const ProblemRecipe heat = problems::heat();
  distinct("GrowthOptions", GrowthOptions{.horizons = {{1, heat}}}, growth);
  distinct("StabilitySweepOptions",
           StabilitySweepOptions{.problems = {heat},
                                 .points = {{0, Vector<double>::Ones(2)}}},
           stability_sweep);
  distinct("HalfInverseStressOptions",
           HalfInverseStressOptions{.problems = {heat},
                                    .taus = {1e-6},
                                    .kappas = {-0.5},
                                    .starts = {{.name = "drawn"}},
                                    .samples = {4}},
           half_inverse_stress);
  distinct("WorkPrecisionOptions",
           WorkPrecisionOptions{
               .name = "s", .problem = heat, .base = heat, .reference = heat},
           work_precision);
  const auto alignment = [](const NoisyAlignment& o) {
    return std::make_unique<MeasureAlignment<NoiseLanes>>(o);
  };
  distinct("AlignmentOptions", NoisyAlignment{}, alignment);
  distinct(
      "TinyNetOptions", NoisyAlignment{.network = TinyNetOptions{}}, alignment);
}

// Of options that code makes of others, and says nothing of; and of those
// inside options above.
const std::set<std::string> kOthers = {"AdadeltaOptions",
                                       "AdagradOptions",
                                       "AdamOptions",
                                       "BatchOptions",
                                       "BfgsOptions",
                                       "BoldDescentOptions",
                                       "ConjugateGradientOptions",
                                       "ConvOptions",
                                       "FieldInputOptions",
                                       "GradientDescentOptions",
                                       "HalfInverseOptions",
                                       "HalfInverseStepOptions",
                                       "JpoMethodOptions",
                                       "JpoReportOptions",
                                       "LbfgsbOptions",
                                       "LineSearchOptions",
                                       "NewtonOptions",
                                       "NoiseOptions",
                                       "NumericInverseOptions",
                                       "OwnOptions",
                                       "RmspropOptions",
                                       "SgdOptions",
                                       "SignalOptions",
                                       "SpectralOptions"};

/// Structs of options in the layers that numbers come from.
std::set<std::string> structs_of_options() {
  static const std::regex kStruct("struct (\\w+Options) \\{");
  std::set<std::string> names;
  const std::filesystem::path root = PHYSINV_SOURCE_DIR;
  for (const char* folder : {"problems",
                             "optimizers",
                             "baselines",
                             "suite/nn",
                             "suite/diagnostics",
                             "suite/cases"})
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(root / folder)) {
      // A project of its own, whose options contract tests see as a plug-in's.
      if (entry.path().parent_path().filename() == "libraries") continue;
      if (!entry.is_regular_file()) continue;
      std::ostringstream text;
      text << std::ifstream(entry.path()).rdbuf();
      const std::string all = text.str();
      EXPECT_EQ(all.find("Options describe("), std::string::npos)
          << entry.path() << ": a list of fields is what describes";
      for (std::sregex_iterator at(all.begin(), all.end(), kStruct), end;
           at != end;
           ++at)
        names.insert((*at)[1]);
    }
  return names;
}

TEST(OptionsContract, TwoThatDifferInAnyFieldHaveDifferentKeys) {
  problems();
  networks();
  stages();
  rules_of_curvature();
  diagnostics();
  for (const auto& name : structs_of_options())
    EXPECT_NE(seen().contains(name), kOthers.contains(name))
        << name << " is looked at here, or nobody is told of it";
}

TEST(OptionsContract, AListThatLeavesOutAMemberDoesNotCompile) {
  const auto compiles = [](const std::string& list) {
    const std::string source =
        "#include \"suite/core/options.h\"\n"
        "struct Two { int a = 1; double b = 2;"
        "auto fields() const { using namespace physinv; return " +
        list + "; } };\nphysinv::Options o = physinv::describe(Two{});\n";
    return run_child({"sh",
                      "-c",
                      "printf '%s' \"$1\" | \"$2\" -std=c++20 -fsyntax-only "
                      "-I \"$3\" -x c++ -",
                      "sh",
                      source,
                      PHYSINV_COMPILER,
                      PHYSINV_SOURCE_DIR})
               .status == 0;
  };
  EXPECT_TRUE(compiles("std::tuple{field(\"a\", a), field(\"b\", b)}"));
  EXPECT_TRUE(compiles("std::tuple{field(\"a\", a, b)}"));
  EXPECT_TRUE(compiles("std::tuple{field(\"a\", a), implied(b)}"));
  EXPECT_FALSE(compiles("std::tuple{field(\"a\", a)}"));
  EXPECT_FALSE(compiles("std::tuple{word(\"a\", \"b\")}"));
}

TEST(OptionsContract, OptionsOfAStageHaveNamesOfTheirOwn) {
  for (const auto& e : registry().experiments())
    for (const Method& m : e->methods)
      for (const auto& stage : m.chain) {
        std::set<std::string> names;
        for (const auto& [name, text] : stage->options())
          EXPECT_TRUE(names.insert(name).second)
              << e->name << ' ' << m.id << ' ' << stage->name() << ": " << name;
      }
}

TEST(OptionsContract, NumbersAreWrittenToTheLastBit) {
  for (const double number : {0.1, 1.0 / 3, 5e-324, -0.0, 1e308, 0.1 + 1e-17}) {
    const double read = std::strtod(text_of(number).c_str(), nullptr);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(read),
              std::bit_cast<std::uint64_t>(number))
        << text_of(number);
  }
}

}  // namespace
}  // namespace physinv::test
