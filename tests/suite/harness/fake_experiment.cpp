#include "tests/suite/harness/fake_experiment.h"

#include <cfenv>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <limits>
#include <new>
#include <random>
#include <stdexcept>
#include <string_view>
#include <thread>

#include "suite/core/clock.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"
#include "suite/core/threads.h"
#include "tests/support/float_control.h"

namespace physinv::fake {
namespace {

/// Is this defect asked for?
bool planted(std::string_view defect) {
  const char* text = std::getenv("PHYSINV_FAKE_PLANT");
  return text != nullptr && defect == text;
}

/// One ulp more, if that is the defect.
double or_next(double value, std::string_view defect) {
  return planted(defect) ? std::nextafter(value, 2 * value) : value;
}

}  // namespace

struct CubicOptions {
  double slope = 1.0;
  auto fields() const { return std::tuple{field("slope", slope)}; }
};

/// y_j = x_j^3 + slope x_j + given, two unknowns.
template <class T>
class Cubic final : public Problem<T>, public Vjp<T> {
 public:
  using Options = CubicOptions;
  explicit Cubic(const Options& options = {}) : options_(options) {}

  Shape shape() const override { return {2, 2, 1}; }
  Vector<double> start() const override { return Vector<double>::Ones(2); }
  void draw(Stream& stream, SampleOut& sample) const override {
    sample.given(0) = stream.uniform(-1, 1);
    for (Index j = 0; j < 2; ++j) {
      const double x = sample.x(j) = stream.uniform(-1, 1);
      sample.y(j) = or_next(x * x * x + options_.slope * x + sample.given(0),
                            "ulp in the data");
    }
  }
  Drawn drawn() const override { return Drawn::both; }
  void forward(Point<T> at, BatchOut<T> y, Workspace&) const override {
    const auto &x = at.x, &given = at.given;
    const T slope = static_cast<T>(options_.slope);
    for (Index i = 0; i < x.cols(); ++i)
      for (Index j = 0; j < 2; ++j)
        y(j, i) = x(j, i) * x(j, i) * x(j, i) + slope * x(j, i) + given(0, i);
    if (other_) y *= 2;
  }
  void linearize(Point<T> at, BatchOut<T> y, Tape& tape) const override {
    const auto& x = at.x;
    Workspace none;
    forward(at, y, none);
    auto kept = tape.slot<T>(0, 2, x.cols());
    kept =
        (T(3) * x.array().square() + static_cast<T>(options_.slope)).matrix();
  }
  void pullback(const Tape& tape,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace&) const override {
    scale(tape, y_bar, x_bar);
    if (slow_ && ++calls_ % 10 == 0) scale(tape, y_bar, x_bar);
  }
  double operations() const override { return 8; }

 private:
  [[gnu::noinline]] void scale(const Tape& tape,
                               BatchIn<T> y_bar,
                               BatchOut<T> x_bar) const {
    x_bar = tape.view<T>(0).cwiseProduct(y_bar);
  }

  Options options_;
  bool slow_ = planted("a kernel slower by 10 %");
  bool other_ = planted("another forward");
  mutable int calls_ = 0;
};

namespace {

void nap(double seconds) {
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

void crash() {
  std::signal(SIGSEGV, SIG_DFL);
  std::raise(SIGSEGV);
}

/// Milliseconds per iteration, so that tests can stop a campaign midway.
double pace() {
  const char* text = std::getenv("PHYSINV_FAKE_PACE_MS");
  return text == nullptr ? 0.0 : 1e-3 * std::atof(text);
}

class Base : public Stage {
 public:
  // A test is not a source of numbers; an interface stands for it.
  Base(std::string name, Needs needs)
      : Stage("suite/core/method.h"), name_(std::move(name)), needs_(needs) {}
  std::string name() const override { return name_; }
  Needs needs() const override { return needs_; }
  Options options() const override { return {{"rate", "0.1"}}; }
  Index default_iterations() const override { return 20; }
  double operations(const CaseSize& size) const override {
    return static_cast<double>(size.n * size.iterations) *
           size.problem_operations;
  }

 private:
  std::string name_;
  Needs needs_;
};

/// On a core for so long.
void burn(double seconds) {
  const double end = physinv::now().cpu + seconds;
  while (physinv::now().cpu < end) {
  }
}

/// Estimates that the defect asked for makes others.
void spoil(Batch<double>& x) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  if (planted("NaN in a loss")) x(0, 0) = kNaN;
  if (planted("no finite loss")) x.setConstant(kNaN);
  if (planted("larger losses")) x.array() += 3;
  if (planted("an ulp in x")) x.array() *= 1 + 2e-16;
}

/// Gradient descent in double from the start, or from the stage before, or from
/// where it was.
class Descend final : public Base {
 public:
  Descend(std::string name, double rate)
      : Base(std::move(name), Needs::vjp),
        rate_(or_next(rate, "ulp in a constant")) {}
  Options options() const override { return {{"rate", std::to_string(rate_)}}; }
  Outcome run(StageRun& run) const override {
    Batch<double> x =
        run.previous != nullptr ? run.previous->x : run.oracle.start();
    Batch<double> gradient(x.rows(), x.cols());
    Vector<double> loss(x.cols());
    const auto serialize = [&](Archive& archive) {
      archive(x, gradient, run.probe, run.oracle);
    };
    if (run.checkpoint != nullptr) {
      if (auto last = run.checkpoint->last()) {
        if (planted("a crash when going on")) crash();
        serialize(*last);
      }
    }
    if (planted("an exception")) throw std::runtime_error("planted");
    run.probe.begin_warmup();
    if (planted("more work"))
      run.oracle.evaluate<double>(run.oracle.all(), x, loss, gradient);
    while (run.probe.proceed([&](BatchOut<double> out) { out = x; })) {
      run.oracle.evaluate<double>(run.oracle.all(), x, loss, gradient);
      for_blocks(run.threads, x.cols(), [&](Index i, int) {
        x.col(i) -= rate_ * gradient.col(i);
      });
      run.probe.trace(x.data(), static_cast<std::size_t>(x.size()) * 8);
      if (run.checkpoint != nullptr && run.checkpoint->due()) {
        Archive archive;
        serialize(archive);
        run.checkpoint->save(run.probe.iteration(), archive);
      }
      nap(pace());
      if (planted("slower")) burn(0.001);
    }
    spoil(x);
    return {
        .x = x,
        .status =
            std::vector(planted("gtol") ? run.oracle.count() : 0, Status::gtol),
        .iterations = {},
        .evaluations = {},
        .stop = planted("it converges") ? Stop::converged : Stop::iterations,
        .message = {},
        .arrays = {{"gradient", gradient}}};
  }

 private:
  double rate_;
};

/// A random walk that keeps what is better, in the case's precision.
class Walk final : public Base {
 public:
  Walk() : Base("fit", Needs::vjp) {}
  bool has_precision() const override { return true; }
  Outcome run(StageRun& run) const override {
    return run.precision == Precision::f32 ? go<float>(run) : go<double>(run);
  }

 private:
  template <class T>
  Outcome go(StageRun& run) const {
    if (planted("a fit that throws")) throw std::runtime_error("no fit today");
    Stream noise = run.method.stream(), order = run.batches.stream();
    Batch<T> x = run.oracle.start().template cast<T>();
    x.array() += static_cast<T>(0.1 * run.network_init.stream().normal());
    Vector<double> best(x.cols()), loss(x.cols());
    run.oracle.evaluate<T>(run.oracle.all(), x, best);
    while (run.probe.proceed(
        [&](BatchOut<double> out) { out = x.template cast<double>(); })) {
      Batch<T> tried = x;
      const double scale = order.uniform(0.0, 0.3);
      for (Index i = 0; i < x.size(); ++i)
        tried(i) += static_cast<T>(scale * noise.normal());
      run.oracle.evaluate<T>(run.oracle.all(), tried, loss);
      for_blocks(run.threads, x.cols(), [&](Index i, int) {
        if (loss(i) < best(i)) best(i) = loss(i), x.col(i) = tried.col(i);
      });
      run.probe.trace(x.data(), static_cast<std::size_t>(x.size()) * sizeof(T));
      nap(pace());
    }
    Outcome out;
    out.x = x.template cast<double>();
    if (planted("a fit that diverges"))
      out.x.setConstant(std::numeric_limits<double>::quiet_NaN());
    return out;
  }
};

/// Solves for a while, and throws.
[[noreturn]] void give_up(StageRun& run, bool alone) {
  const Batch<double> x = run.oracle.start();
  Vector<double> loss(x.cols());
  run.probe.begin();
  if (alone) {
    auto problem = run.oracle.problem<double>();
    Batch<double> y(x.rows(), x.cols());
    problem.forward(x, run.oracle.given(), y);
  }
  for (int k = 0; k < 4; ++k)
    run.oracle.evaluate<double>(run.oracle.all(), x, loss);
  burn(0.02);
  throw std::runtime_error("it gives up");
}

/// Ends as its options say.
class Ends final : public Base {
 public:
  explicit Ends(std::string how)
      : Base("solve", Needs::forward), how_(std::move(how)) {}
  Options options() const override { return {{"how", how_}}; }
  Outcome run(StageRun& run) const override {
    if (how_ == "throws") throw std::runtime_error("no solution today");
    if (how_ == "exhaust") throw std::bad_alloc();
    SUITE_CHECK(how_ != "breach", "a planted breach");
    if (how_ == "die") crash();
    if (how_ == "sleep") nap(60);
    if (how_ == "floats") {
      flush_subnormals();
      std::fesetround(FE_UPWARD);
      while (run.probe.proceed(
          [&](BatchOut<double> x) { x = run.oracle.start(); })) {
      }
    }
    if (how_.starts_with("give-up")) give_up(run, how_ == "give-up-alone");
    Outcome out;
    out.x = run.oracle.start();
    if (how_ == "diverge")
      out.x.setConstant(std::numeric_limits<double>::quiet_NaN());
    return out;
  }

 private:
  std::string how_;
};

/// Ends in one of very many ways, chosen by the number in PHYSINV_FAKE_RETURN:
/// what a stage may leave, and what none should.
class Hostile final : public Base {
 public:
  Hostile() : Base("solve", Needs::forward) {}
  Options options() const override { return {{"way", way()}}; }
  Outcome run(StageRun& run) const override {
    std::mt19937_64 random(std::strtoull(way().c_str(), nullptr, 10));
    const auto pick = [&](std::size_t count) { return random() % count; };
    // Every other way can be stored.
    const bool breaks = pick(2) == 0;
    const auto odd = [&](std::size_t rarely) {
      return pick(rarely) == 0 && breaks;
    };
    const Index n = run.oracle.count();
    Batch<double> x = run.oracle.start();
    for (std::size_t k = pick(5); k-- > 0;) {
      const double value = number(pick(kNumbers));
      const auto column = static_cast<Index>(pick(4));
      x(static_cast<Index>(pick(2)), column) = value;
    }
    if (pick(3) == 0) run.oracle.add(Counter::forward, -7);
    if (pick(3) == 0)
      run.probe.accept(Index{1}, static_cast<Index>(pick(1000)), x.data(), 0);
    else if (pick(3) > 0)
      while (run.probe.proceed([&](BatchOut<double> out) { out = x; })) {
      }
    if (odd(8)) throw std::runtime_error(text(pick(kTexts)));
    if (odd(12)) throw 7;
    Outcome out;
    const Index others[][2] = {{2, n + 1}, {2, n - 1}, {3, n}, {0, 0}, {n, 2}};
    const std::size_t shape = odd(4) ? pick(5) : 5;
    out.x = shape < 5 ? Batch<double>(Batch<double>::Zero(others[shape][0],
                                                          others[shape][1]))
                      : x;
    const auto length = [&] { return pick(10) == 0 ? 0 : odd(8) ? n + 1 : n; };
    for (Index i = length(); i-- > 0;)
      out.status.push_back(
          static_cast<Status>(odd(20) ? 4 + pick(250) : pick(4)));
    for (Vector<double>* counts : {&out.iterations, &out.evaluations}) {
      counts->setZero(length());
      for (double& count : *counts)
        if (odd(4)) count = number(pick(kNumbers));
    }
    out.stop = static_cast<Stop>(odd(8) ? pick(256) : pick(3));
    out.message = text(pick(kTexts));
    for (std::size_t k = pick(3); k-- > 0;) {
      auto& array =
          out.arrays[ArrayKey::own(name(odd(4) ? pick(kNames) : pick(6)))];
      const double value = number(pick(kNumbers));
      const auto columns = static_cast<Index>(pick(3));
      array.setConstant(static_cast<Index>(pick(3)), columns, value);
    }
    if (pick(2) == 0) out.bytes = ~std::size_t{0};
    return out;
  }

 private:
  static std::string way() {
    const char* text = std::getenv("PHYSINV_FAKE_RETURN");
    return text == nullptr ? "0" : text;
  }
  static constexpr std::size_t kNumbers = 9, kTexts = 6, kNames = 12;
  static double number(std::size_t which) {
    using Limits = std::numeric_limits<double>;
    const double all[kNumbers] = {Limits::quiet_NaN(),
                                  Limits::infinity(),
                                  -Limits::infinity(),
                                  Limits::max(),
                                  Limits::denorm_min(),
                                  -1,
                                  -0.0,
                                  0.5,
                                  1e18};
    return all[which];
  }
  static std::string text(std::size_t which) {
    const std::string all[kTexts] = {
        "",
        "a word",
        std::string(3 << 20, 'm'),
        std::string("nul \0 and \xff\xfe", 12),
        "two\nlines, \033[31mred \"quoted\" <b>| `x`",
        "/nowhere/file.cpp:3: \xed\xa0\x80"};
    return all[which];
  }
  static std::string name(std::size_t which) {
    const std::string all[kNames] = {"mine",
                                     "metrics",
                                     "status",
                                     "with blanks",
                                     "..",
                                     std::string(900, 'n'),
                                     "",
                                     "a/b",
                                     ".",
                                     std::string("n\0l", 3),
                                     "\xff",
                                     std::string(2000, 'n')};
    return all[which];
  }
};

Method chain(std::string id, std::vector<std::shared_ptr<const Stage>> stages) {
  return {.id = std::move(id), .chain = std::move(stages)};
}

Section report(const Evidence& e) {
  const auto* found = e.results.find("fake/cubic", "descend", 4, 0, "solve");
  ClaimResult claim;
  claim.id = "R1";
  claim.says = "descend lowers the loss";
  claim.from = "smoke";
  claim.gates = true;
  if (found != nullptr)
    claim.verdict = found->loss.maxCoeff() < 1.0 ? Verdict::reproduced
                                                 : Verdict::not_reproduced;
  if (std::getenv("PHYSINV_FAKE_DOUBT") != nullptr)
    claim.verdict = Verdict::not_reproduced;
  if (const char* cause = std::getenv("PHYSINV_FAKE_CAUSE"))
    claim.cause = cause;
  return {.experiment = "fake/cubic",
          .title = "Cubic",
          .paper = "fake",
          .tables = {},
          .figures = {},
          .claims = {claim}};
}

}  // namespace

Experiment experiment() {
  const auto descend = std::make_shared<Descend>("solve", 0.05);
  const auto fit = std::make_shared<Walk>();
  const auto ends = [&](const char* how) {
    return chain(how, {std::make_shared<Ends>(how)});
  };
  Experiment e;
  e.name = "fake/cubic";
  e.title = "Cubic";
  e.citation = {"fake", "nowhere"};
  e.problem = problem<Cubic>("cubic");
  e.problem.source = "suite/core/problem.h";
  e.methods = {chain("descend", {descend}),
               chain("walk", {fit, std::make_shared<Descend>("refine", 0.05)}),
               chain("stroll", {fit, std::make_shared<Descend>("refine", 0.1)}),
               ends("diverge"),
               ends("throws"),
               ends("exhaust"),
               ends("die"),
               ends("sleep"),
               ends("floats"),
               ends("give-up"),
               ends("give-up-alone"),
               ends("breach"),
               chain("hostile", {std::make_shared<Hostile>()}),
               chain("broken",
                     {std::make_shared<Ends>("throws"),
                      std::make_shared<Descend>("refine", 0.1)})};
  std::vector<std::string> good = {"descend", "walk", "stroll"};
  if (planted("a case removed")) good.pop_back();
  e.profiles = {
      {"smoke", {{good, {4}, {0}, 10}, {{"diverge"}, {4}, {0}, 10}}},
      {"quick", {{good, {4, 9}, {0, 1, 2}, 40}}},
      {"bad",
       {{{"throws", "descend", "exhaust", "die", "broken"}, {4}, {0}, 10}}},
      {"hostile", {{{"hostile", "descend"}, {4}, {0}, 10}}},
      {"slow", {{{"descend", "sleep"}, {4}, {0, 1}, 10}}},
      {"kernel", {{{"descend"}, {512}, {0}, 200}}}};
  e.report = report;
  return e;
}

}  // namespace physinv::fake
