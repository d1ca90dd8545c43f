#include "suite/harness/networks.h"

#include "suite/harness/registry.h"

namespace physinv {
namespace {

template <class F>
Quantity of_network(const std::string& experiment,
                    NetworkRole Setting::*role,
                    F count) {
  return {[=](const Evidence&) {
            return Measured{.value = static_cast<double>(
                                count(*network_of(experiment, role)))};
          },
          {}};
}

}  // namespace

std::unique_ptr<Network<float>> network_of(const std::string& experiment,
                                           NetworkRole Setting::*role) {
  const auto e = registry().find(experiment);
  const Shape shape = e->problem.make<float>()->shape();
  const NetworkRole& network = e->setting.*role;
  Index inputs = 0;
  for (const Field field : network.inputs)
    inputs += field == Field::unknowns ? shape.unknowns
              : field == Field::given  ? shape.given
                                       : shape.observations;
  return network.recipe.make<float>(
      inputs,
      role == &Setting::predictor ? shape.unknowns : shape.observations);
}

Quantity parameters(const std::string& experiment, NetworkRole Setting::*role) {
  return of_network(experiment, role, [](const Network<float>& network) {
    return network.parameter_count();
  });
}

Quantity parameters_complex_once(const std::string& experiment) {
  return of_network(
      experiment, &Setting::predictor, [](const Network<float>& network) {
        Index modes = 0;
        for (const TensorInfo& t : network.tensors())
          if (t.kind == 'f') modes += t.size;
        return network.parameter_count() - modes / 2;
      });
}

std::vector<std::string> tensor_names(const std::string& experiment) {
  const auto network = network_of(experiment, &Setting::predictor);
  std::vector<std::string> names;
  for (const TensorInfo& t : network->tensors()) names.push_back(t.name);
  return names;
}

}  // namespace physinv
