/// What this build is made of, for records and content keys.
#pragma once

#include <string_view>

namespace physinv {

/// Texts, as the compiler or the library states them. `fingerprint` is 16
/// hexadecimal digits over everything that can change the bits of a result:
/// the sources of core, nn, problems, optimizers and baselines, the compiler
/// and its flags, the instruction set, and the libraries that compute. It does
/// not change with reports, cases or the command line.
struct BuildInfo {
  std::string_view compiler, compiler_version, flags, build_type;
  std::string_view instruction_set;  ///< "x86-64-v3" or "native:<processor>"
  std::string_view fingerprint;
  std::string_view version;  ///< of this suite
  std::string_view eigen, fftw, hdf5, json, fmt, cli11;
};

const BuildInfo& build_info();

}  // namespace physinv
