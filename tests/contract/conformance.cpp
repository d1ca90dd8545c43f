// Contract tests over what plug-ins register, or the program itself: a line for
// each check, and the exit codes of the verb `conformance`.

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "suite/app/conformance_flags.h"
#include "suite/app/plugins.h"
#include "suite/harness/registry.h"
#include "suite/harness/registry_errors.h"
#include "suite/harness/select.h"
#include "suite/results/nearest.h"

namespace physinv {

namespace {

std::string subject(const testing::TestInfo& info) {
  return info.value_param() == nullptr ? "all" : info.value_param();
}

/// "ok  pendulum  ProblemContract.FloatAgreesWithDouble"; below it what failed.
class Lines final : public testing::EmptyTestEventListener {
  void OnTestProgramStart(const testing::UnitTest& all) override {
    for (int i = 0; i < all.total_test_suite_count(); ++i) {
      const auto& suite = *all.GetTestSuite(i);
      for (int k = 0; k < suite.total_test_count(); ++k)
        if (suite.GetTestInfo(k)->should_run())
          width_ = std::max(width_, subject(*suite.GetTestInfo(k)).size());
    }
  }

  void OnTestEnd(const testing::TestInfo& info) override {
    const testing::TestResult& result = *info.result();
    const std::string suite = info.test_suite_name(), name = info.name();
    std::string line = fmt::format("{:<8} {:<{}}  {}.{}",
                                   result.Failed()    ? "FAILED"
                                   : result.Skipped() ? "skipped"
                                                      : "ok",
                                   subject(info),
                                   width_,
                                   suite.substr(suite.find('/') + 1),
                                   name.substr(0, name.find('/')));
    for (int i = 0; i < result.total_part_count(); ++i)
      add(result.GetTestPartResult(i), line);
    fmt::print("{}\n", line);
    std::fflush(stdout);
  }

  static void add(const testing::TestPartResult& part, std::string& line) {
    if (part.skipped()) line += fmt::format("  ({})", part.message());
    if (!part.failed()) return;
    const std::filesystem::path file =
        part.file_name() == nullptr ? "" : part.file_name();
    line += fmt::format("\n  {}:{}: {}",
                        file.filename().string(),
                        part.line_number(),
                        part.message());
  }

  std::size_t width_ = 0;
};

/// Leaves in the registry what `filters` match of the experiments from `first`;
/// the others are elsewhere.
void keep(std::size_t first, const std::vector<std::string>& filters) {
  const NameFilter filter(filters, "FILTER");
  const auto& all = registry().experiments();
  Registry asked;
  std::vector<std::string> names;
  for (std::size_t i = first; i < all.size(); ++i) {
    names.push_back(all[i]->name);
    if (filter.matches(all[i]->name)) asked.add(Experiment(*all[i]));
  }
  if (asked.experiments().empty())
    throw ExitError(
        ExitCode::nothing_matched,
        names.empty()
            ? "nothing is registered whose contracts could be checked"
            : fmt::format("no experiment matches; nearest: {}",
                          fmt::join(nearest_names(names, filters.front()),  //
                                    ", ")));
  if (asked.experiments().size() == all.size()) return;
  std::vector<std::string> others;
  for (const auto& e : all)
    if (asked.find(e->name) == nullptr) others.push_back(e->name);
  name_elsewhere(std::move(others));
  registry() = std::move(asked);
}

/// Methods and cases are those of the profile smoke.
void check_profiles() {
  const auto& all = registry().experiments();
  std::vector<std::string> without;
  for (const auto& e : all)
    if (std::ranges::find(e->profiles, "smoke", &Profile::name) ==
        e->profiles.end())
      without.push_back(e->name);
  if (without.size() == all.size())
    throw UsageError(fmt::format(
        "{} has no profile smoke, whose methods the contract tests run; give "
        "it one that takes seconds",
        without.front()));
  for (const auto& name : without)
    fmt::print(
        "skipped  {}  MethodContract, CaseContract  (no profile smoke)\n",
        name);
}

ExitCode check_all(const Arguments& google) {
  std::vector<std::string> words = {std::string(program().name)};
  words.insert(words.end(), google.begin(), google.end());
  std::vector<char*> argv;
  for (auto& word : words) argv.push_back(word.data());
  int argc = static_cast<int>(argv.size());
  argv.push_back(nullptr);
  testing::InitGoogleTest(&argc, argv.data());
  const auto& tests = *testing::UnitTest::GetInstance();
  auto& listeners = testing::UnitTest::GetInstance()->listeners();
  delete listeners.Release(listeners.default_result_printer());
  listeners.Append(new Lines);
  const int status = RUN_ALL_TESTS();
  if (testing::GTEST_FLAG(list_tests)) return ExitCode::good;
  if (tests.test_to_run_count() == 0)
    throw ExitError(ExitCode::nothing_matched,
                    "no check matches; --gtest_list_tests shows what there is");
  const std::size_t count = registry().experiments().size();
  fmt::print("{} checks of {} experiment{}: {} ok, {} skipped, {} failed\n",
             tests.test_to_run_count(),
             count,
             count == 1 ? "" : "s",
             tests.successful_test_count(),
             tests.skipped_test_count(),
             tests.failed_test_count());
  return status == 0 ? ExitCode::good : ExitCode::case_failed;
}

ExitCode conform(Arguments arguments) {
  register_all(registry());
  const std::size_t own = registry().experiments().size();
  load_plugins(arguments);
  ConformanceFlags flags;
  if (!parse_conformance(arguments, flags)) return ExitCode::good;
  const bool plugged = registry().experiments().size() > own;
  keep(plugged ? own : 0, flags.filters);
  check_profiles();
  return check_all(flags.google);
}

}  // namespace
}  // namespace physinv

int main(int argc, char** argv) {
  using namespace physinv;
  ExitCode code = ExitCode::internal;
  try {
    code = conform(Arguments(argv + std::min(1, argc), argv + argc));
  } catch (const ExitError& error) {
    fmt::print(stderr, "{}: {}\n", program().name, error.what());
    code = error.code();
  } catch (const std::exception& error) {
    fmt::print(
        stderr, "{}: internal error: {}\n", program().name, error.what());
  }
  return static_cast<int>(code);
}
