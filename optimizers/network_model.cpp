#include "optimizers/network_model.h"

#include "suite/core/math.h"

namespace physinv {
namespace {

const Batch<double>& rows_of(Field field,
                             const Batch<double>& x,
                             const Batch<double>& given,
                             const Batch<double>& y) {
  switch (field) {
    case Field::unknowns:
      return x;
    case Field::given:
      return given;
    case Field::observations:
      break;
  }
  return y;
}

}  // namespace

template <class T>
Batch<T> assemble(const std::vector<Field>& fields,
                  const Batch<double>& x,
                  const Batch<double>& given,
                  const Batch<double>& y) {
  Index rows = 0, cols = 0;
  for (const Field f : fields) {
    rows += rows_of(f, x, given, y).rows();
    cols = rows_of(f, x, given, y).cols();
  }
  Batch<T> input(rows, cols);
  Index at = 0;
  for (const Field f : fields) {
    const Batch<double>& block = rows_of(f, x, given, y);
    input.middleRows(at, block.rows()) = block.template cast<T>();
    at += block.rows();
  }
  return input;
}

template decltype(assemble<float>) assemble<float>;
template decltype(assemble<double>) assemble<double>;

Batch<double> bounded(Batch<double> x, const Labelling& labels) {
  auto rows = x.topRows(labels.bounded);
  rows = rows.unaryExpr([](double v) { return math::tanh(v); }).eval();
  return x;
}

Index input_rows(const std::vector<Field>& fields, const Shape& shape) {
  Index rows = 0;
  for (const Field f : fields) {
    rows += f == Field::unknowns ? shape.unknowns
            : f == Field::given  ? shape.given
                                 : shape.observations;
  }
  return rows;
}

template <class T>
NetworkModel<T>::NetworkModel(const NetworkRole& role,
                              const Shape& shape,
                              Index outputs,
                              Threads* threads)
    : network_(role.recipe.make<T>(input_rows(role.inputs, shape), outputs)),
      parameters_(network_->parameter_count()),
      state_(network_->state_count()),
      gradient_(network_->parameter_count()),
      work_(threads),
      prediction_work_(threads) {}

template <class T>
void NetworkModel<T>::initialize(const Rng& rng) {
  network_->initialize(rng, parameters_, state_);
}

template <class T>
void NetworkModel<T>::load(const Arrays& arrays) {
  const auto& parameters = arrays.at("parameters");
  SUITE_CHECK(parameters.rows() == parameters_.size(),
              "stored parameters belong to another network");
  parameters_ = parameters.template cast<T>();
  if (state_.size() > 0) state_ = arrays.at("state").template cast<T>();
}

template <class T>
void NetworkModel<T>::save(Arrays& arrays) const {
  arrays["parameters"] = parameters_.template cast<double>();
  if (state_.size() > 0) arrays["state"] = state_.template cast<double>();
}

template <class T>
void NetworkModel<T>::bind(Batch<T> input) {
  input_ = std::move(input);
  output_.resize(network_->outputs(), input_.cols());
  fresh_ = true;
}

template <class T>
const Batch<T>& NetworkModel<T>::forward() {
  // The input never changes: encode it once, fold what is constant over it.
  const Pass pass{.training = true, .same_input = !fresh_, .fixed_input = true};
  network_->forward(parameters_, state_, input_, output_, tape_, work_, pass);
  fresh_ = false;
  return output_;
}

template <class T>
const Batch<T>& NetworkModel<T>::forward(BatchIn<T> input) {
  output_.resize(network_->outputs(), input.cols());
  network_->forward(
      parameters_, state_, input, output_, tape_, work_, {.training = true});
  fresh_ = true;
  return output_;
}

template <class T>
Vector<T>& NetworkModel<T>::backward(BatchIn<T> out_bar) {
  VectorOut<T> gradient(gradient_);
  network_->backward(parameters_, tape_, out_bar, &gradient, nullptr, work_);
  return gradient_;
}

template <class T>
const Batch<T>& NetworkModel<T>::tangent(const Vector<T>& direction) {
  output_dot_.resizeLike(output_);
  network_->tangent(parameters_,
                    tape_,
                    direction,
                    Batch<T>(network_->inputs(), 0),
                    output_dot_,
                    dots_,
                    work_);
  return output_dot_;
}

template <class T>
void NetworkModel<T>::backward_tangent(const Vector<T>& direction,
                                       BatchIn<T> out_bar,
                                       BatchIn<T> out_bar_dot,
                                       Vector<T>& product) {
  product.resize(parameters_.size());
  network_->backward_tangent(parameters_,
                             tape_,
                             direction,
                             dots_,
                             out_bar,
                             out_bar_dot,
                             nullptr,
                             product,
                             work_);
}

template <class T>
void NetworkModel<T>::update_state() {
  if (state_.size() > 0) network_->update_state(tape_, state_);
}

template <class T>
void NetworkModel<T>::settle(BatchIn<T> input) {
  // A move leaves nine tenths of what was there.
  constexpr int kMoves = 360;
  forward(input);
  for (int k = 0; k < kMoves; ++k) update_state();
}

template <class T>
void NetworkModel<T>::warm_up() {
  forward();
  backward(Batch<T>::Zero(output_.rows(), output_.cols()));
  work_.counts = {};
  fresh_ = true;
}

template <class T>
void NetworkModel<T>::predict(BatchIn<T> input, BatchOut<T> output) {
  // Between updates the tape of a minibatch is not read. A bound input stays
  // there, and larger batches would make the tape grow.
  const bool bound = input_.size() > 0;
  const bool shared = !bound && input.cols() <= output_.cols();
  const Counts counts = work_.counts;
  network_->forward(parameters_,
                    state_,
                    input,
                    output,
                    shared ? tape_ : prediction_tape_,
                    shared ? work_ : prediction_work_);
  work_.counts = counts;
  // Before the first update, perhaps the only pass that needs memory of its
  // own.
  if (!bound && output_.cols() == 0) {
    prediction_tape_ = Tape();
    prediction_work_ = Workspace(work_.threads());
  }
}

template <class T>
Batch<double> NetworkModel<T>::change_per_tensor(const Rng& start) const {
  // Drawn again rather than kept for the whole training.
  Vector<T> initial(parameters_.size()), state(state_.size());
  network_->initialize(start, initial, state);
  const auto& tensors = network_->tensors();
  Batch<double> change(static_cast<Index>(tensors.size()), 1);
  for (Index t = 0; t < change.rows(); ++t) {
    const TensorInfo& info = tensors[static_cast<std::size_t>(t)];
    change(t, 0) = (parameters_.segment(info.offset, info.size) -
                    initial.segment(info.offset, info.size))
                       .template cast<double>()
                       .cwiseAbs()
                       .mean();
  }
  return change;
}

template <class T>
std::size_t NetworkModel<T>::bytes() const {
  const Index numbers = 2 * parameters_.size() + state_.size() + input_.size() +
                        output_.size() + output_dot_.size();
  return static_cast<std::size_t>(numbers) * sizeof(T) + tape_.bytes() +
         dots_.bytes() + work_.bytes();
}

template class NetworkModel<float>;
template class NetworkModel<double>;

}  // namespace physinv
