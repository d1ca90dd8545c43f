#include "suite/harness/processor.h"

#include <gtest/gtest.h>

namespace physinv {
namespace {

constexpr std::string_view kX86 =
    "processor\t: 0\nvendor_id\t: AuthenticAMD\nmodel\t\t: 17\n"
    "model name\t: AMD EPYC\ncpu MHz\t\t: 2445.4\n";
constexpr std::string_view kNeoverse =
    "processor\t: 0\nBogoMIPS\t: 243.75\nCPU implementer\t: 0x41\n"
    "CPU architecture: 8\nCPU variant\t: 0x3\nCPU part\t: 0xd0c\n";
constexpr std::string_view kUnknown =
    "CPU implementer\t: 0x61\nCPU part\t: 0x022\n";

TEST(Processor, IsNamedAsItCallsItself) {
  EXPECT_EQ(processor_name(kX86, ""), "AMD EPYC");
  EXPECT_EQ(processor_name(kNeoverse, ""), "ARM Neoverse-N1");
  EXPECT_EQ(processor_name(kNeoverse, "a board"), "ARM Neoverse-N1");
  EXPECT_EQ(processor_name(kUnknown, ""), "0x61 part 0x022");
  EXPECT_EQ(processor_name(kUnknown, std::string_view("a board\0", 8)),
            "a board");
  EXPECT_EQ(processor_name("", ""), "");
  EXPECT_EQ(processor_name("CPU part", ""), "");
}

TEST(Processor, ValuesAreOfTheFirstLineOfAKey) {
  EXPECT_EQ(cpuinfo_value(kX86, "cpu MHz"), "2445.4");
  EXPECT_EQ(cpuinfo_value("a : 1\na : 2", "a"), "1");
  EXPECT_EQ(cpuinfo_value("a :\nb", "a"), "");
  EXPECT_EQ(cpuinfo_value("a : 1", "b"), "");
}

TEST(Processor, KindIsWithoutTheWidthOfRegisters) {
  EXPECT_EQ(processor_kind("x86-64-v3"), processor_kind("x86-64-v4"));
  EXPECT_EQ(processor_kind("aarch64"), "aarch64");
}

}  // namespace
}  // namespace physinv
