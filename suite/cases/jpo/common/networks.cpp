#include "suite/cases/jpo/common/networks.h"

#include "suite/harness/registry.h"

namespace physinv {

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

std::vector<std::string> tensor_names(const std::string& experiment) {
  const auto network = network_of(experiment, &Setting::predictor);
  std::vector<std::string> names;
  for (const TensorInfo& t : network->tensors()) names.push_back(t.name);
  return names;
}

}  // namespace physinv
