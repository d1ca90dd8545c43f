#include "suite/harness/workers.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "suite/harness/campaign.h"
#include "suite/harness/errors.h"
#include "suite/harness/registry.h"
#include "tests/suite/harness/fake_experiment.h"

namespace physinv {
namespace {

TEST(Wire, MessagesSurviveAnyCut) {
  BodyWriter writer;
  writer.put(3.5).put(Index{7}).bytes(std::vector<std::uint8_t>{1, 2, 3});
  const auto body = writer.take();
  BodyReader reader(body);
  EXPECT_EQ(reader.get<double>(), 3.5);
  EXPECT_EQ(reader.get<Index>(), 7);
  EXPECT_EQ(reader.bytes().size(), 3u);
  EXPECT_THROW(reader.get<char>(), std::runtime_error);
}

TEST(Workers, ADeadWorkerIsNamedAndReplaced) {
  Registry registry;
  registry.add(fake::experiment());
  const auto prepared = prepare(registry.expand("bad"));
  Workers workers(prepared.cases, 1, 1, {});
  std::string death;
  std::size_t done = 0;
  for (std::size_t i = 0; i < prepared.cases.size(); ++i) {
    workers.submit(0, i, {}, 1);
    for (bool over = false; !over;) {
      for (const auto& event : workers.wait(5)) {
        if (event.kind == WorkerEvent::Kind::died) death = event.message;
        if (event.kind == WorkerEvent::Kind::case_done) ++done;
      }
      over = workers.idle(0);
    }
  }
  EXPECT_EQ(death, "the worker was killed by SIGSEGV");
  EXPECT_EQ(done, prepared.cases.size() - 1);
}

TEST(Workers, IfNotAllCanStartNoneIsLeft) {
  Registry registry;
  registry.add(fake::experiment());
  const auto prepared = prepare(registry.expand("smoke"));
  rlimit before{};
  getrlimit(RLIMIT_NOFILE, &before);
  const int next = dup(STDIN_FILENO);
  close(next);
  rlimit few = before;
  few.rlim_cur = static_cast<rlim_t>(next) + 4;  // sockets of three workers
  setrlimit(RLIMIT_NOFILE, &few);
  EXPECT_THROW(Workers(prepared.cases, 8, 1, {}), EnvironmentError);
  setrlimit(RLIMIT_NOFILE, &before);
  EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1);
}

}  // namespace
}  // namespace physinv
