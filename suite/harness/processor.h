/// Which processor this is, for records and pages. No number and no key depends
/// on it.
#pragma once

#include <string>
#include <string_view>

namespace physinv {

/// Name of the processor from the text of /proc/cpuinfo: its "model name"; on
/// aarch64, where Linux writes none, the designer and the model of the core
/// ("ARM Neoverse-N1", "0x61 part 0x022" if not known here). `board` is the
/// machine's name in the device tree ("Raspberry Pi 4 Model B"), may be empty,
/// and stands for what the text does not say. Empty if it is not known. Numbers
/// of parts: Arm, Main ID Register, MIDR_EL1.
std::string processor_name(std::string_view cpuinfo, std::string_view board);

/// As the processor that runs this calls itself; empty if unknown.
std::string processor_name();

/// Value of the first "key : value" line of such a text.
std::string cpuinfo_value(std::string_view cpuinfo, std::string_view key);

/// What programs of an instruction set run on: "x86-64" for "x86-64-v3" and
/// "x86-64-v4", else the name itself. Times and instructions compare on one
/// alone.
std::string_view processor_kind(std::string_view instruction_set);

}  // namespace physinv
