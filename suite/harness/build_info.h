/// What this build is made of, for records and content keys.
#pragma once

#include <span>
#include <string_view>

namespace physinv {

/// A source that numbers can come from. Paths are relative to the project's
/// root; `includes` are the project's headers that it names, a space behind
/// each.
struct SourceFile {
  std::string_view path, hash, includes;
};

/// Texts, as the compiler or the library states them. `fingerprint` is 16
/// hexadecimal digits over everything that can change the bits of a result:
/// `foundation`, and the sources of core, nn, problems, optimizers and
/// baselines. It does not change with reports, cases or the command line. What
/// decides whether a stage is stale is its own part of it (sources.h).
struct BuildInfo {
  std::string_view compiler, compiler_version, flags;
  std::string_view bit_flags;  ///< those that may change a bit of a result
  std::string_view build_type;
  std::string_view instruction_set;  ///< "x86-64-v3", "x86-64-v4", "aarch64"
  std::string_view fingerprint;
  std::string_view interfaces;  ///< hash of compiler, flags and headers: what
                                ///< plug-ins must be built with
  std::string_view foundation;  ///< hash of what every stage depends on:
                                ///< bit_flags, libraries that
                                ///< compute, and run_stage.{h,cpp}
  std::string_view version;     ///< of this suite
  std::string_view eigen, sleef, hdf5, json, fmt, cli11;
  std::span<const SourceFile> sources;  ///< and those of the cases
};

const BuildInfo& build_info();

}  // namespace physinv
