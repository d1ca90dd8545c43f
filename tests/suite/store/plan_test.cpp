#include "suite/store/plan.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "suite/store/catalog.h"
#include "suite/store/store.h"
#include "tests/suite/store/store_testing.h"

namespace physinv {
namespace {

using nlohmann::json;

class PlanTest : public testing::Test {
 protected:
  json plan(const std::vector<CaseInfo>& cases,
            const std::string& fingerprint = "f") {
    return make_plan(cases, {{"fingerprint", fingerprint}, {"load", 0.1}}, {});
  }
  json read(std::string* warning = nullptr) {
    std::string ignored;
    return read_plan(path_, warning != nullptr ? warning : &ignored);
  }

  TemporaryDirectory out_;
  std::filesystem::path path_ = out_ / "plan.json";
  CaseInfo a_ = sample_case("a", 4, 0), b_ = sample_case("b", 4, 0),
           c_ = sample_case("c", 4, 0);
};

TEST_F(PlanTest, EveryWrongByteIsFound) {
  const std::string text = plan_text(plan({a_}));
  write_file(path_, text);
  std::string warning;
  const json whole = read(&warning);
  EXPECT_EQ(warning, "");
  std::size_t found = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    for (const char wrong : {text[i] ^ 1, text[i] ^ 2, text[i] ^ 3, 0x20}) {
      auto bytes = text;
      bytes[i] = wrong;
      write_file(path_, bytes);
      try {
        json now = read(&warning);
        ASSERT_EQ(now, whole) << "byte " << i;  // white space
        ASSERT_EQ(warning, "") << "byte " << i;
      } catch (const std::runtime_error& e) {
        ASSERT_TRUE(contains(e.what(), path_.string())) << e.what();
        ++found;
      }
    }
  }
  EXPECT_GT(found, text.size());
}

TEST_F(PlanTest, OldVersionIsReadWithAWarning) {
  json old = plan({a_, b_});
  old["schema_version"] = 1;
  old.erase("recipes"), old.erase("keys");
  write_file(path_, old.dump());
  std::string warning;
  EXPECT_EQ(read(&warning).at("cases"), json({a_.name, b_.name}));
  EXPECT_TRUE(contains(warning, "without a checksum")) << warning;
}

TEST_F(PlanTest, MissingIsSaid) {
  std::string warning;
  EXPECT_TRUE(read(&warning).is_null());
  EXPECT_TRUE(contains(warning, "plan.json is missing")) << warning;
}

TEST_F(PlanTest, NewerVersionIsRefused) {
  json newer = plan({a_});
  newer["schema_version"] = 3;
  write_file(path_, newer.dump());
  const auto message = message_of<UnreadableInput>([&] { read(); });
  EXPECT_TRUE(contains(message, "newer schema")) << message;
}

TEST_F(PlanTest, PartOfACampaignLeavesTheRestPlanned) {
  const json all = plan({a_, b_, c_});
  const auto names = [](const json& p) { return p.at("cases"); };
  EXPECT_EQ(names(extend_plan(all, plan({b_}))), names(all));
  EXPECT_EQ(names(extend_plan(plan({b_}), all)), names(all));
  EXPECT_EQ(names(extend_plan(plan({b_}), plan({a_}))),
            json({b_.name, a_.name}));
  EXPECT_EQ(names(extend_plan(all, plan({b_}, "g"))), json({b_.name}));
}

TEST_F(PlanTest, LatestKeysCount) {
  const json all = plan({a_, b_});
  b_.keys = {hex128("new fit"), hex128("new refine")};
  const json now = extend_plan(all, plan({b_}));
  EXPECT_EQ(planned_keys(now, a_.name, {}), a_.keys);
  EXPECT_EQ(planned_keys(now, b_.name, {}), b_.keys);
  EXPECT_EQ(planned_keys(now, c_.name, c_.keys), c_.keys);
}

TEST_F(PlanTest, StagesOfOtherKeysThanPlannedAreLeftOut) {
  Store store(out_.path());
  for (Index k = 0; k < 2; ++k)
    store.append(a_, sample_data(a_), sample_stage(a_, k));
  store.set_plan({a_}, json::object());
  EXPECT_EQ(Catalog::read(out_.path()).cases().at(0).stages.size(), 2U);
  a_.keys[1] = hex128("of other options");
  store.set_plan({a_}, json::object());
  EXPECT_EQ(Catalog::read(out_.path()).cases().at(0).stages.size(), 1U);
}

}  // namespace
}  // namespace physinv
