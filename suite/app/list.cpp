#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>
#include <nlohmann/json.hpp>

#include "suite/app/options.h"
#include "suite/harness/columns.h"
#include "suite/harness/registry.h"
#include "suite/harness/screen.h"
#include "suite/harness/sources.h"
#include "suite/planning/kinds.h"
#include "suite/results/verdict_words.h"

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

void print_table(const std::vector<Case>& cases) {
  Operations operations;
  Columns table({"<case", "<stages", "operations"});
  double sum = 0;
  for (const Case& c : cases) {
    table.add(
        {c.info.name, stages_of(c), fmt::format("{:.2g}", operations(c))});
    sum += operations(c);
  }
  fmt::print("{}{} cases, about {:.2g} floating-point operations\n",
             table.text(Screen::of(stdout).room()),
             cases.size(),
             sum);
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
  fmt::print("an edit of {} invalidates {} of {} stages\n", path, stale, all);
}

/// All that is registered, not only what a selection takes.
void print_validity() {
  registry().validate();
  std::size_t methods = 0;
  for (const auto& e : registry().experiments()) methods += e->methods.size();
  fmt::print("{} experiments with {} methods are valid\n",
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

/// A cause names its numbers in braces; here nothing was measured.
std::string without_numbers(const std::string& cause) {
  std::string out;
  bool inside = false;
  for (const char c : cause) {
    if (c == '{') out += "...";
    inside = (inside || c == '{') && c != '}';
    if (!inside && c != '}') out += c;
  }
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
               c.origin() == Origin::paper ? "paper" : "suite",
               escaped(c.where),
               c.judged_from(),
               escaped(c.says),
               escaped(conditions_text(c)),
               c.cause.why.empty()
                   ? ""
                   : fmt::format("{}: {}",
                                 words_of(c.cause.as),
                                 escaped(without_numbers(c.cause.why))));
  }
}

nlohmann::ordered_json claims_json(const std::string& of,
                                   const std::vector<Claim>& claims) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const Claim& c : claims) {
    nlohmann::ordered_json conditions = nlohmann::ordered_json::array();
    for (const Condition& condition : c.conditions)
      conditions.push_back(
          {{"label", condition.text()}, {"bounds", condition.bounds}});
    const auto cause =
        c.cause.why.empty()
            ? nlohmann::ordered_json(nullptr)
            : nlohmann::ordered_json{{"verdict", words_of(c.cause.as)},
                                     {"why", c.cause.why}};
    all.push_back({{"of", of},
                   {"id", c.id},
                   {"origin", c.origin() == Origin::paper ? "paper" : "suite"},
                   {"where", c.where},
                   {"from", c.judged_from()},
                   {"says", c.says},
                   {"conditions", std::move(conditions)},
                   {"cause", cause},
                   {"note", c.note},
                   {"gates", c.gates}});
  }
  return all;
}

void print_claims_json() {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  const auto add = [&](const auto& of, const auto& claims) {
    for (auto& claim : claims_json(of, claims)) all.push_back(std::move(claim));
  };
  for (const Overview& o : registry().overviews()) add(o.paper, o.claims);
  for (const auto& e : registry().experiments()) add(e->name, e->claims);
  fmt::print("{}\n", all.dump(1));
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

/// What --json and --format ask for.
bool is_json(bool json, const std::string& format, bool claims) {
  const std::string usual = claims ? "markdown" : "text";
  if (!format.empty() && format != usual && format != "json")
    throw UsageError(fmt::format(
        "--format={} is unknown here; known values: {}, json", format, usual));
  if (json && format == usual)
    throw UsageError("--json and --format=" + format + " exclude each other");
  return json || format == "json";
}

}  // namespace

ExitCode list_verb(const Arguments& arguments) {
  Selection selection;
  std::string edited, format;
  bool json = false, methods = false, claims = false, validate = false;
  if (!parse(
          "list",
          "Lists the cases of a profile with estimated work.",
          selection.flags(
              {selection.arguments(),
               {"--json", "the same as --format=json", &json},
               {"--format",
                "text (default), markdown (default of --claims) or json",
                &format,
                "FORMAT"},
               {"--edit",
                "list the stages that an edit of this source invalidates",
                &edited,
                "FILE"},
               {"--methods",
                "list experiments and methods, as Markdown",
                &methods},
               {"--claims",
                "list claims with their origin and conditions",
                &claims},
               {"--validate", "check all registered experiments", &validate}}),
          arguments))
    return ExitCode::good;
  json = is_json(json, format, claims);
  if (validate) {
    print_validity();
    return ExitCode::good;
  }
  if (methods) {
    print_methods();
    return ExitCode::good;
  }
  if (claims) {
    json ? print_claims_json() : print_claims();
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
