#include "suite/evidence/method_titles.h"

#include <map>

namespace physinv {

std::string method_title(const std::string& id) {
  static const std::map<std::string, std::string> titles = {
      {"adadelta", "Adadelta"},
      {"adagrad", "Adagrad"},
      {"adahessian", "AdaHessian"},
      {"adam", "Adam"},
      {"bfgs", "BFGS"},
      {"gd", "Gradient descent"},
      {"gn", "Gauss-Newton"},
      {"hf", "Hessian-free"},
      {"hig", "HIG"},
      {"jpo", "JPO"},
      {"jpo-long", "JPO, twice as long"},
      {"lbfgsb", "L-BFGS-B"},
      {"na", "Neural adjoint"},
      {"newton", "Newton"},
      {"rmsprop", "RMSprop"},
      {"sgd", "SGD"},
      {"sip", "SIP"},
      {"supervised", "Supervised"}};
  const auto at = titles.find(id);
  return at == titles.end() ? id : at->second;
}

}  // namespace physinv
