#include "suite/cases/matrix/cells/cells.h"

#include "optimizers/training/label_loss.h"
#include "optimizers/training/newton.h"
#include "optimizers/training/proxy.h"
#include "problems/billiards/billiards.h"
#include "problems/exponential/exponential.h"
#include "problems/grid_poisson/grid_poisson.h"
#include "problems/heat/heat.h"
#include "problems/kuramoto_sivashinsky/kuramoto_sivashinsky.h"
#include "problems/marker_flow/marker_flow.h"
#include "problems/navier_stokes/navier_stokes.h"
#include "problems/oscillators/oscillators.h"
#include "problems/poisson/poisson.h"
#include "problems/quantum_dipole/quantum_dipole.h"
#include "problems/robotic_arm/robotic_arm.h"
#include "problems/scaled_output/scaled_output.h"
#include "problems/sine_plane/sine_plane.h"
#include "problems/wave_packet/wave_packet.h"
#include "suite/nn/mlp.h"
#include "suite/nn/unet.h"
#include "suite/nn/vgg.h"

namespace physinv::matrix {
namespace {

MatrixMethod first_order(std::string id,
                         std::string title,
                         StepOptions rule,
                         std::vector<double> rates,
                         SignalRecipe signal = solver_loss()) {
  return {.id = std::move(id),
          .title = std::move(title),
          .options = {.rule = std::move(rule),
                      .fresh = true,
                      .signal = std::move(signal)},
          .rates = std::move(rates)};
}

MatrixMethod curved(std::string id,
                    std::string title,
                    decltype(TrainingOptions::rule) rule,
                    std::vector<double> rates) {
  return {.id = std::move(id),
          .title = std::move(title),
          .options = {.rule = std::move(rule), .fresh = true},
          .rates = std::move(rates)};
}

MatrixMethod power(std::string id, std::string title, double kappa) {
  return {.id = std::move(id),
          .title = std::move(title),
          .half_inverse = true,
          .options = {.rule = HalfInverseStepOptions{.power = {.kappa = kappa,
                                                               .tau = 1e-5}},
                      .fresh = true},
          .rates = {0.01, 0.03, 0.1, 0.3, 1}};
}

NetworkRole asks(std::vector<Field> fields, NetworkRecipe recipe) {
  return {std::move(fields), std::move(recipe)};
}

/// Of the SIP paper's planes, on a grid that leaves time for every method.
constexpr Index kSide = 32;
NetworkRecipe plane_unet(Index channels = 1, Index outputs = 1) {
  return nn::unet({.grid = {kSide, kSide},
                   .channels = channels,
                   .outputs = outputs,
                   .padding = nn::Padding::circular,
                   .batch_statistics = true,
                   .init = nn::Init::uniform});
}

constexpr Field kGiven = Field::given, kObserved = Field::observations;

NetworkRecipe tanh_layers(std::vector<Index> hidden) {
  return nn::mlp({.hidden = std::move(hidden),
                  .activation = nn::Activation::tanh,
                  .init = nn::Init::glorot});
}

/// Their networks are dense layers.
std::vector<MatrixProblem> dense() {
  return {
      {.id = "exponential",
       .title = "Exponential",
       .problem = problems::exponential(),
       .setting = {.predictor = asks({kObserved}, tanh_layers({16, 64, 16}))},
       .batch = 64,
       .updates = 4000},
      {.id = "scaled-output",
       .title = "Scaled output",
       .problem = problems::scaled_output(),
       .setting = {.predictor = asks({kGiven}, tanh_layers({7}))},
       .batch = 64,
       .updates = 4000},
      {.id = "robotic-arm",
       .title = "Robotic arm",
       .problem = problems::robotic_arm(),
       .setting = {.predictor =
                       asks({kObserved}, nn::mlp({.hidden = {128, 128, 128}}))},
       .batch = 64,
       .updates = 1000},
      {.id = "billiards",
       .title = "Billiards",
       .problem = problems::billiards(),
       .setting = {.predictor = asks(
                       {kGiven, kObserved},
                       nn::mlp({.hidden = {128, 128, 128}, .frequencies = 4}))},
       .batch = 64,
       .updates = 800},
      {.id = "oscillators",
       .title = "Oscillators",
       .problem = problems::oscillators(),
       .setting = {.predictor = asks({kObserved}, tanh_layers({20, 20, 20}))},
       .batch = 64,
       .updates = 2000},
      {.id = "poisson-8",
       .title = "Poisson, 8 x 8",
       .problem = problems::grid_poisson(),
       .setting = {.predictor = asks({kObserved}, tanh_layers({64, 256, 64}))},
       .batch = 16,
       .updates = 400},
      {.id = "quantum-dipole",
       .title = "Quantum dipole",
       .problem = problems::quantum_dipole({.zero_start = true}),
       .setting = {.predictor = asks({kObserved}, tanh_layers({20, 20, 20}))},
       .batch = 8,
       .updates = 1000},
      {.id = "sine",
       .title = "Sine, xi = 32, 45 degrees",
       .problem = problems::sine_plane({.xi = 32, .degrees = 45}),
       .setting = {.predictor = asks({kObserved},
                                     nn::mlp({.hidden = {32, 64, 32},
                                              .init = nn::Init::uniform}))},
       .batch = 64,
       .updates = 4000}};
}

/// Their networks have convolutions, and give no rows.
std::vector<MatrixProblem> convolutional() {
  std::vector<MatrixProblem> all = {
      {.id = "poisson",
       .title = "Poisson, 32 x 32",
       .problem = problems::poisson({.rows = kSide, .columns = kSide}),
       .setting = {.predictor = asks({kObserved}, plane_unet())},
       .batch = 8,
       .updates = 200},
      {.id = "heat",
       .title = "Heat, 32 x 32",
       .problem = problems::heat({.resolution = kSide}),
       .setting = {.predictor = asks({kObserved}, plane_unet()),
                   .output_form = OutputForm::mean_of_observations},
       .batch = 8,
       .updates = 200},
      {.id = "wave-packet",
       .title = "Wave packet",
       .problem = problems::wave_packet(),
       .setting = {.predictor = asks({kObserved},
                                     nn::vgg({.channels = 1,
                                              .grid = {.columns = 256},
                                              .features = {16, 16, 16, 16, 16},
                                              .hidden = {64, 32}}))},
       .batch = 64,
       .updates = 1000},
      {.id = "kuramoto-sivashinsky",
       .title = "Kuramoto-Sivashinsky",
       .problem = problems::kuramoto_sivashinsky(),
       .setting = {.predictor = asks({kGiven, kObserved},
                                     nn::vgg({.channels = 2,
                                              .grid = {.columns = 128},
                                              .features = {32, 32, 64, 64},
                                              .hidden = {64, 64}})),
                   .output_scale = 0.25},
       .batch = 32,
       .updates = 300},
      {.id = "navier-stokes",
       .title = "Navier-Stokes",
       .problem = problems::navier_stokes(),
       .setting = {.predictor =
                       asks({kObserved},
                            nn::vgg({.channels = 2,
                                     .grid = {.columns = 32, .rows = 64},
                                     .features = {16, 32, 32, 32},
                                     .hidden = {64, 64}}))},
       .batch = 8,
       .updates = 100},
      {.id = "fluid",
       .title = "Marker flow, 32 x 32",
       .problem = problems::marker_flow({.cells = kSide}),
       .setting = {.predictor = asks({kGiven, kObserved}, plane_unet(2, 2))},
       .batch = 8,
       .updates = 200}};
  for (MatrixProblem& problem : all) problem.rows = false;
  return all;
}

std::vector<MatrixProblem>& known() {
  static std::vector<MatrixProblem> all = [] {
    auto both = dense();
    for (auto& problem : convolutional()) both.push_back(std::move(problem));
    return both;
  }();
  return all;
}

}  // namespace

const std::vector<MatrixMethod>& methods() {
  const std::vector<double> small = {1e-4, 3e-4, 1e-3, 3e-3, 1e-2};
  const std::vector<double> large = {1e-3, 3e-3, 1e-2, 3e-2, 1e-1};
  static const std::vector<MatrixMethod> all = {
      first_order("sgd", "SGD", SgdOptions{}, {1e-4, 1e-3, 1e-2, 1e-1, 1}),
      first_order("momentum",
                  "SGD, momentum 0.9",
                  SgdOptions{.momentum = 0.9},
                  {1e-5, 1e-4, 1e-3, 1e-2, 1e-1}),
      first_order("adagrad", "Adagrad", AdagradOptions{}, large),
      first_order(
          "adadelta", "Adadelta", AdadeltaOptions{}, {1e-2, 3e-2, 0.1, 0.3, 1}),
      first_order("rmsprop", "RMSprop", RmspropOptions{}, small),
      first_order("adam", "Adam", AdamOptions{}, small),
      first_order("labels", "Labels, Adam", AdamOptions{}, small, label_loss()),
      first_order("sip",
                  "SIP, Adam",
                  AdamOptions{},
                  small,
                  inverse_proxy(ProxyNorm::square)),
      first_order("sip-sign",
                  "SIP, signs, Adam",
                  AdamOptions{},
                  small,
                  inverse_proxy(ProxyNorm::absolute)),
      first_order("newton",
                  "Newton, saddle-free, Adam",
                  AdamOptions{},
                  small,
                  newton_proxy()),
      curved("adahessian",
             "AdaHessian",
             AdaHessianOptions{},
             {1e-5, 1e-4, 1e-3, 1e-2, 1e-1}),
      curved("hf",
             "Hessian-free, 10 products",
             HessianFreeOptions{.solver = {.iterations = 10}},
             {0.03, 0.1, 0.3, 1, 1.5}),
      power("hig", "Half-inverse gradients", -0.5),
      power("gn", "Gauss-Newton", -1)};
  return all;
}

const std::vector<MatrixProblem>& problems() { return known(); }

void add_problem(MatrixProblem problem) {
  std::erase_if(known(),
                [&](const MatrixProblem& p) { return p.id == problem.id; });
  known().push_back(std::move(problem));
}

std::string refusal(const MatrixProblem& problem, const MatrixMethod& method) {
  const Needs needs = train(method.options)->needs();
  const auto lacks = [&](Needs what) {
    return contains(needs, what) && !contains(problem.problem.provided, what);
  };
  if (lacks(Needs::inverse)) return "no inverse";
  if (lacks(Needs::jacobian)) return "no Jacobian";
  if (lacks(Needs::hessian)) return "no Hessian";
  if (lacks(Needs::jvp)) return "no forward mode";
  if (lacks(Needs::pullback_tangent)) return "no second derivative";
  if (lacks(Needs::vjp)) return "no gradient";
  if (method.half_inverse && !problem.rows) return "network without rows";
  return {};
}

}  // namespace physinv::matrix
