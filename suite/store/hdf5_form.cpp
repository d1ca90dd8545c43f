#include "suite/store/hdf5_form.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "suite/core/stop.h"
#include "suite/store/errors.h"

namespace physinv::hdf5 {
namespace {

using namespace std::string_view_literals;

using Address = std::uint64_t;
constexpr Address kUndefined = ~Address{0};
constexpr int kDeepest = 8;  // group in group; four are there

// Sizes that the superblock's ranks of trees, 4 and 16, give their nodes.
constexpr std::size_t kEntries = 8, kChildren = 32;
constexpr std::size_t kEntryBytes = 40;
constexpr std::size_t kNodeBytes = 8 + kEntries * kEntryBytes;
constexpr std::size_t kTreeBytes = 24 + kChildren * 16 + 8;

constexpr auto kSuperblock =
    "\x89HDF\r\n\x1a\n\0\0\0\0\0\x8\x8\0\x4\0\x10\0\0\0\0\0"
    "\0\0\0\0\0\0\0\0\xff\xff\xff\xff\xff\xff\xff\xff"sv;
constexpr auto kDouble =
    "\x11\x20\x3f\0\x8\0\0\0\0\0\x40\0\x34\x0b\0\x34\xff\x3\0\0\0\0\0\0"sv;
constexpr auto kCode = "\x10\x8\0\0\x4\0\0\0\0\0\x20\0\0\0\0\0"sv;
constexpr auto kByte = "\x10\0\0\0\x1\0\0\0\0\0\x8\0\0\0\0\0"sv;
constexpr auto kWhole = "\x10\0\0\0\x8\0\0\0\0\0\x40\0\0\0\0\0"sv;
/// The enumeration of Status in version 2: its names, then their values.
constexpr auto kStatus =
    "\x18\x4\0\0\x1\0\0\0\x10\0\0\0\x1\0\0\0\0\0\x8\0gtol\0\0\0\0"
    "maxiter\0linesearch\0\0\0\0\0\0nonfinite\0\0\0\0\0\0\0\0\x1\x2\x3"sv;
constexpr auto kFillValue = "\x2\x2\x2\x1\0\0\0\0"sv;
constexpr auto kScalar = "\x1\0\0\0\0\0\0\0"sv;
constexpr auto kList = "\x1\x1\x1\0\0\0\0\0"sv;
/// Texts: of version 2, which end in a zero, ASCII, UTF-8.
constexpr std::uint64_t kTexts[] = {0x13, 0x113, 0x1113};

/// A structure of another form than this suite writes.
struct Refused {
  std::string what;
  std::string path = {};  ///< of the group or array, from the root
};

[[noreturn]] void refuse(std::string_view what) {
  throw Refused{std::string(what)};
}

void require(bool good, std::string_view what) {
  if (!good) refuse(what);
}

std::uint64_t number(std::string_view bytes,
                     std::size_t at,
                     std::size_t size = 8) {
  require(at <= bytes.size() && size <= bytes.size() - at, "a structure");
  std::uint64_t value = 0;
  std::memcpy(&value, bytes.data() + at, size);
  return value;
}

std::size_t padded(std::size_t size) { return (size + 7) / 8 * 8; }

enum Message : std::uint64_t {
  kNone = 0,
  kShape = 1,
  kType = 3,
  kFill = 5,
  kLayout = 8,
  kAttribute = 12,
  kContinued = 16,
  kTable = 17
};

/// What the messages of one object say.
struct Object {
  std::vector<std::uint64_t> shape;
  std::optional<std::size_t> element;
  std::optional<std::uint64_t> bytes;
  std::optional<std::pair<Address, Address>> table;  // tree and heap
  int shapes = 0;
};

class Walk {
 public:
  explicit Walk(std::string_view image) : image_(image) {}

  void file() {
    const auto head = piece(0, 56);
    require(head.starts_with(kSuperblock) &&
                number(head, 40) == image_.size() &&
                number(head, 48) == kUndefined,
            "the superblock");
    entry(piece(56, kEntryBytes), std::nullopt, kDeepest);
  }

 private:
  std::string_view piece(Address address, std::uint64_t size) const {
    require(address <= image_.size() && size <= image_.size() - address,
            "an address");
    return image_.substr(address, size);
  }

  /// A structure belongs to one other.
  std::string_view own(Address address,
                       std::uint64_t size,
                       std::string_view signature) {
    const auto bytes = piece(address, size);
    require(bytes.starts_with(signature) && seen_.insert(address).second,
            "a structure");
    return bytes;
  }

  void entry(std::string_view bytes,
             std::optional<std::string_view> heap,
             int depth) {
    if (!heap) return object(bytes, depth);
    const std::string_view own = name(*heap, number(bytes, 0));
    try {
      object(bytes, depth);
    } catch (Refused& refused) {
      refused.path = fmt::format(
          "{}{}{}", own, refused.path.empty() ? "" : "/", refused.path);
      throw;
    }
  }

  void object(std::string_view bytes, int depth) {
    const Object object = header(number(bytes, 8));
    const auto cached = number(bytes, 16, 4);
    require(cached == 0 || (cached == 1 && object.table &&
                            object.table->first == number(bytes, 24) &&
                            object.table->second == number(bytes, 32)),
            "a link");
    if (object.table) {
      require(
          depth > 0 && object.shapes == 0 && !object.element && !object.bytes,
          "a group");
      group(*object.table, depth - 1);
    } else {
      array(object);
    }
  }

  static std::string_view name(std::string_view heap, std::uint64_t at) {
    const auto end = at < heap.size() ? heap.find('\0', at) : heap.npos;
    require(end != heap.npos, "a name");
    return heap.substr(at, end - at);
  }

  static void array(const Object& object) {
    require(object.shapes == 1 && object.element && object.bytes, "an array");
    std::uint64_t bytes = *object.element;
    for (const auto count : object.shape)
      require(!__builtin_mul_overflow(bytes, count, &bytes), "a shape");
    require(bytes == *object.bytes, "an array");
  }

  Object header(Address address) {
    const auto head = own(address, 16, "\x1\0"sv);
    require(number(head, 4, 4) == 1, "an object");
    auto left = number(head, 2, 2);
    Object object;
    std::vector<std::string_view> blocks = {
        piece(address + 16, number(head, 8, 4))};
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      for (auto rest = blocks[i]; !rest.empty(); --left) {
        const auto size = number(rest, 2, 2);
        require(left > 0 && rest.size() >= 8 && size <= rest.size() - 8 &&
                    size % 8 == 0 && number(rest, 4, 1) <= 1,
                "an object");
        const auto body = rest.substr(8, size);
        const auto type = number(rest, 0, 2);
        if (type == kContinued) {
          blocks.push_back(own(number(body, 0), number(body, 8), ""));
        } else {
          message(type, body, object);
        }
        rest.remove_prefix(8 + size);
      }
    }
    require(left == 0, "an object");
    return object;
  }

  void message(std::uint64_t type, std::string_view body, Object& object) {
    switch (type) {
      case kNone:
        return;
      case kShape:
        return shape(body, object);
      case kType:
        require(!object.element && (body == kDouble || body == kCode ||
                                    body == kByte || body == kStatus),
                "a type of numbers");
        object.element = body == kDouble ? 8 : body == kCode ? 4 : 1;
        return;
      case kFill:
        return require(body == kFillValue, "a fill value");
      case kLayout:
        return layout(body, object);
      case kAttribute:
        return attribute(body);
      case kTable:
        require(!object.table, "a group");
        object.table = {number(body, 0), number(body, 8)};
        return;
      default:
        refuse(fmt::format("a message of type {}", type));
    }
  }

  static void shape(std::string_view body, Object& object) {
    const auto rank = number(body, 1, 1);
    // Sizes and, the same, largest sizes.
    require(number(body, 0, 1) == 1 && rank >= 1 && rank <= 3 &&
                number(body, 2, 6) == 1 && body.size() == 8 + 16 * rank &&
                body.substr(8, 8 * rank) == body.substr(8 + 8 * rank),
            "a shape");
    for (std::size_t k = 0; k < rank; ++k)
      object.shape.push_back(number(body, 8 + 8 * k));
    ++object.shapes;
  }

  void layout(std::string_view body, Object& object) const {
    const auto address = number(body, 2), bytes = number(body, 10);
    require(!object.bytes && number(body, 0, 2) == 0x103, "a layout");
    if (address != kUndefined || bytes != 0) piece(address, bytes);
    object.bytes = bytes;
  }

  static void attribute(std::string_view body) {
    const auto called = number(body, 2, 2), sizes = number(body, 4, 4);
    require(number(body, 0, 2) == 1 && called > 0 &&
                body.size() >= 8 + padded(called) + 16,
            "an attribute");
    name(body.substr(8, called), 0);
    const auto rest = body.substr(8 + padded(called));
    switch (sizes) {  // of its type and of its shape
      case 0x80008:
        return text(rest);
      case 0x8000c:
        return whole(rest);
      case 0x18000c:
        return codes(rest);
      default:
        refuse("an attribute");
    }
  }

  static void text(std::string_view rest) {
    require(
        std::find(std::begin(kTexts), std::end(kTexts), number(rest, 0, 4)) !=
                std::end(kTexts) &&
            rest.substr(8, 8) == kScalar && number(rest, 4, 4) > 0 &&
            number(rest, 4, 4) <= rest.size() - 16,
        "an attribute");
  }

  static void whole(std::string_view rest) {
    require(rest.size() == 32 && rest.starts_with(kWhole) &&
                rest.substr(16, 8) == kScalar,
            "an attribute");
  }

  /// Numbers of statuses, as many as the program knew that wrote them.
  static void codes(std::string_view rest) {
    require(rest.size() >= 40 && rest.starts_with(kCode) &&
                rest.substr(16, 8) == kList,
            "an attribute");
    const auto count = number(rest, 24);
    require(count > 0 && count <= kStatuses.size() &&
                number(rest, 32) == count &&
                rest.size() == padded(40 + count * 4),
            "an attribute");
  }

  void group(std::pair<Address, Address> table, int depth) {
    const auto head = own(table.second, 32, "HEAP\0\0\0\0"sv);
    const auto heap = own(number(head, 24), number(head, 8), "");
    free_list(heap, number(head, 16));
    tree(table.first, heap, std::nullopt, depth);
  }

  /// Offset 1 ends it; it has no more parts than fit.
  static void free_list(std::string_view heap, std::uint64_t at) {
    for (auto left = heap.size() / 16; at != 1; at = number(heap, at)) {
      require(left-- > 0 && at % 8 == 0 && at <= heap.size(), "a heap");
      const auto size = number(heap, at + 8);
      require(size >= 16 && size <= heap.size() - at, "a heap");
    }
  }

  void tree(Address address,
            std::string_view heap,
            std::optional<std::uint64_t> level,
            int depth) {
    const auto bytes = own(address, kTreeBytes, "TREE\0"sv);
    const auto above = number(bytes, 5, 1), count = number(bytes, 6, 2);
    // Only nodes below the first have neighbours.
    require(count <= kChildren && above < 4 &&
                (level ? above == *level
                       : number(bytes, 8) == kUndefined &&
                             number(bytes, 16) == kUndefined),
            "a tree");
    for (std::size_t i = 0; i <= count; ++i)
      if (count > 0) name(heap, number(bytes, 24 + 16 * i));
    for (std::size_t i = 0; i < count; ++i) {
      const Address child = number(bytes, 32 + 16 * i);
      above > 0 ? tree(child, heap, above - 1, depth)
                : node(child, heap, depth);
    }
  }

  void node(Address address, std::string_view heap, int depth) {
    const auto bytes = own(address, kNodeBytes, "SNOD\x1\0"sv);
    const auto count = number(bytes, 6, 2);
    require(count <= kEntries, "a node");
    for (std::size_t i = 0; i < count; ++i)
      entry(bytes.substr(8 + kEntryBytes * i, kEntryBytes), heap, depth);
  }

  std::string_view image_;
  std::set<Address> seen_;
};

}  // namespace

void check_form(std::string_view image) {
  try {
    Walk(image).file();
  } catch (const Refused& refused) {
    throw StoreError(
        fmt::format("{}{} has a format that this program does not read "
                    "(restore it, or use the program that wrote it)",
                    refused.path.empty() ? "" : refused.path + ": ",
                    refused.what));
  }
}

}  // namespace physinv::hdf5
