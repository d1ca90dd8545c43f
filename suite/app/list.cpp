#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

#include "suite/app/options.h"
#include "suite/harness/sources.h"

namespace physinv {
namespace {

void print_json(const std::vector<Case>& cases) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const Case& c : cases) {
    nlohmann::ordered_json stages = nlohmann::ordered_json::array();
    for (std::size_t k = 0; k < c.info.stages.size(); ++k) {
      stages.push_back({{"name", c.info.stages[k]},
                        {"iterations", c.stage_iterations[k]},
                        {"operations", c.operations(k)}});
    }
    all.push_back({{"name", c.info.name},
                   {"experiment", c.info.experiment},
                   {"method", c.info.method},
                   {"profile", c.info.profile},
                   {"n", c.info.n},
                   {"seed", c.info.seed},
                   {"precision", to_string(c.info.precision)},
                   {"stages", std::move(stages)}});
  }
  fmt::print("{}\n", all.dump(2));
}

/// A long chain by its ends.
std::string stages_of(const Case& c) {
  const auto& all = c.info.stages;
  if (all.size() <= 6) return fmt::format("{}", fmt::join(all, " "));
  return fmt::format("{} .. {} ({})", all.front(), all.back(), all.size());
}

/// Declared work of a whole chain: the same for every seed, and its problems
/// and networks are made for it.
class Operations {
 public:
  double of(const Case& c) {
    const auto [at, is_new] =
        known_.try_emplace({c.method, c.info.n, c.stage_iterations});
    if (is_new) at->second = c.operations();
    return at->second;
  }

 private:
  std::map<std::tuple<const Method*, Index, std::vector<Index>>, double> known_;
};

void print_table(const std::vector<Case>& cases) {
  Operations operations;
  std::size_t width = 4, stages_width = 6;
  for (const Case& c : cases) {
    width = std::max(width, c.info.name.size());
    stages_width = std::max(stages_width, stages_of(c).size());
  }
  fmt::print("{:<{}}  {:<{}}  {:>10}\n",
             "case",
             width,
             "stages",
             stages_width,
             "operations");
  double sum = 0;
  for (const Case& c : cases) {
    fmt::print("{:<{}}  {:<{}}  {:>10.2g}\n",
               c.info.name,
               width,
               stages_of(c),
               stages_width,
               operations.of(c));
    sum += operations.of(c);
  }
  fmt::print(
      "{} cases, about {:.2g} floating-point operations\n", cases.size(), sum);
}

/// The stages whose numbers an edit of a source can change.
void print_stale(const std::vector<Case>& cases, const std::string& path) {
  const std::string file = project_sources().find(path);
  std::map<std::pair<const Method*, std::size_t>, bool> known;
  std::size_t stale = 0, all = 0;
  for (const Case& c : cases) {
    for (std::size_t k = 0; k < c.info.stages.size(); ++k, ++all) {
      const auto [at, first] = known.try_emplace({c.method, k});
      if (first)
        at->second = project_sources()
                         .closure(chain_sources(*c.experiment, *c.method, k))
                         .contains(file);
      if (!at->second) continue;
      ++stale;
      fmt::print("{} {}\n", c.info.name, c.info.stages[k]);
    }
  }
  fmt::print("an edit of {} makes {} of {} stages stale\n", path, stale, all);
}

/// All that is registered, not only what a selection takes.
void print_validity() {
  registry().validate();
  std::size_t methods = 0;
  for (const auto& e : registry().experiments()) methods += e->methods.size();
  fmt::print(
      "{} experiments with {} methods are registered as they should be\n",
      registry().experiments().size(),
      methods);
}

/// '|' would end a cell of a Markdown table.
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text)
    out += c == '|' ? std::string(", ") : std::string(1, c);
  return out;
}

std::string chain_text(const Method& method) {
  std::string text;
  for (const auto& stage : method.chain)
    text += (text.empty() ? "" : " → ") + stage->name();
  return text;
}

/// Problem x method as a Markdown table: what is provided, needed, missing.
void print_methods() {
  fmt::print(
      "| experiment | problem provides | method | stages | needs | runs |\n"
      "| --- | --- | --- | --- | --- | --- |\n");
  for (const auto& e : registry().experiments()) {
    for (const Method& m : e->methods) {
      const bool works = contains(e->problem.provided, m.needs());
      fmt::print("| {} | {} | {} | {} | {} | {} |\n",
                 e->name,
                 escaped(to_text(e->problem.provided)),
                 m.id,
                 chain_text(m),
                 escaped(to_text(m.needs())),
                 works ? "yes" : "no: the problem does not provide it");
    }
  }
}

/// Every claim as Markdown, what decides it in the words of its bounds.
void print_claims(const std::string& of, const std::vector<Claim>& claims) {
  for (const Claim& c : claims) {
    fmt::print("| {} | {} | {} | {} | {} | {} | {} | {} |\n",
               of,
               c.id,
               c.origin == Origin::paper ? "paper" : "suite",
               escaped(c.where),
               c.from,
               escaped(c.says),
               escaped(conditions_text(c)),
               c.cause.why.empty() ? ""
                                   : fmt::format("{}: {}",
                                                 words_of(c.cause.as, c.origin),
                                                 escaped(c.cause.why)));
  }
}

void print_claims() {
  fmt::print(
      "| of | id | whose | where | judged from | says | conditions | cause |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- |\n");
  for (const Overview& o : registry().overviews())
    print_claims(o.paper, o.claims);
  for (const auto& e : registry().experiments())
    print_claims(e->name, e->claims);
}

}  // namespace

ExitCode list_verb(const Arguments& arguments) {
  Selection selection;
  std::string edited;
  bool json = false, methods = false, claims = false, validate = false;
  if (!parse(
          "list",
          "The cases of a profile, with estimated work.",
          selection.flags(
              {{"--json", "as JSON", &json},
               {"--edit",
                "the stages that an edit of this source makes stale",
                &edited,
                "FILE"},
               {"--methods", "experiments and methods, as Markdown", &methods},
               {"--claims",
                "what is claimed, whose it is and what decides "
                "it, as Markdown",
                &claims},
               {"--validate",
                "is everything registered as it should be?",
                &validate}}),
          arguments))
    return ExitCode::good;
  if (validate) {
    print_validity();
    return ExitCode::good;
  }
  if (methods) {
    print_methods();
    return ExitCode::good;
  }
  if (claims) {
    print_claims();
    return ExitCode::good;
  }
  const auto cases = selection.cases();
  if (!edited.empty()) {
    print_stale(cases, edited);
  } else {
    json ? print_json(cases) : print_table(cases);
  }
  return ExitCode::good;
}

}  // namespace physinv
