// physinv-sources FILE...: a line of C++ for each source (SourceFile of
// suite/harness/build_info.h), its path, the hash of its tokens and the headers
// of its project that it includes.
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>

#include "cmake/tokens.h"
#include "suite/core/hash.h"

int main(int argc, char** argv) {
  namespace source = physinv::source;
  for (int i = 1; i < argc; ++i) {
    std::ifstream in(argv[i], std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    if (!in.is_open() || in.bad()) {
      std::fprintf(stderr, "physinv-sources: %s cannot be read\n", argv[i]);
      return 1;
    }
    const auto tokens = source::tokens_of(text);
    std::printf("    {\"%s\", \"%s\",\n     \"%s\"},\n",
                argv[i],
                physinv::hex128(source::substance(tokens)).c_str(),
                source::includes(tokens).c_str());
  }
  return std::fflush(stdout) == 0 ? 0 : 1;
}
