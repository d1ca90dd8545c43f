#include "tests/fuzz/inputs.h"

#include <fmt/format.h>

#include <cstdlib>
#include <fstream>

#include "suite/store/checksum.h"

namespace physinv::fuzz {
namespace {

namespace fs = std::filesystem;

class Scratch {
 public:
  Scratch() {
    const fs::path memory = "/dev/shm";
    const fs::path root =
        fs::is_directory(memory) ? memory : fs::temp_directory_path();
    std::string name = (root / "physinv-fuzz-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr)
      throw std::runtime_error("cannot make " + name);
    path_ = name;
  }
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

}  // namespace

const fs::path& folder() {
  static const Scratch own;
  return own.path();
}

fs::path put(const std::string& name, std::string_view bytes) {
  fs::path path = folder() / name;
  if (!fs::is_directory(path.parent_path()))
    fs::create_directories(path.parent_path());
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!file.flush()) throw std::runtime_error("cannot write " + path.string());
  return path;
}

std::string checksum(std::string_view bytes) {
  return fmt::format("{:08x}", crc32c(bytes));
}

Halves halves(std::string_view text, std::string_view mark) {
  const auto at = text.find(mark);
  if (at == std::string_view::npos) return {text, {}};
  return {text.substr(0, at), text.substr(at + mark.size())};
}

}  // namespace physinv::fuzz
