#include "suite/harness/workers.h"

#include <gtest/gtest.h>

#include "suite/harness/campaign.h"
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
    workers.submit(0, i, {});
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

}  // namespace
}  // namespace physinv
