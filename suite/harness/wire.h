/// Messages between the parent and its workers: a kind, a length, bytes.
#pragma once

#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <stdexcept>
#include <vector>

namespace physinv {

struct Message {
  std::uint32_t kind = 0;
  std::vector<std::uint8_t> body;
};

/// Writes plain values and byte strings into a body.
class BodyWriter {
 public:
  template <class T>
  BodyWriter& put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto* p = reinterpret_cast<const std::uint8_t*>(&value);
    body_.insert(body_.end(), p, p + sizeof(T));
    return *this;
  }
  BodyWriter& bytes(std::span<const std::uint8_t> data) {
    put(static_cast<std::uint64_t>(data.size()));
    body_.insert(body_.end(), data.begin(), data.end());
    return *this;
  }
  std::vector<std::uint8_t> take() { return std::move(body_); }

 private:
  std::vector<std::uint8_t> body_;
};

/// Reads them back in the same order.
class BodyReader {
 public:
  explicit BodyReader(std::span<const std::uint8_t> body) : body_(body) {}
  template <class T>
  T get() {
    T value;
    std::memcpy(&value, advance(sizeof(T)).data(), sizeof(T));
    return value;
  }
  std::span<const std::uint8_t> bytes() {
    return advance(static_cast<std::size_t>(get<std::uint64_t>()));
  }

 private:
  std::span<const std::uint8_t> advance(std::size_t n) {
    if (n > body_.size()) throw std::runtime_error("a message is too short");
    const auto head = body_.first(n);
    body_ = body_.subspan(n);
    return head;
  }
  std::span<const std::uint8_t> body_;
};

/// Sends all of it, waiting if it must; false if the other side has ended.
bool send_message(int socket,
                  std::uint32_t kind,
                  std::span<const std::uint8_t> body);

/// Waits for one message; nothing if the other side has ended.
std::optional<Message> receive_message(int socket);

/// Collects what arrives on a socket without waiting.
class Inbox {
 public:
  /// Reads what is there; false once the other side has ended.
  bool fill(int socket);
  /// The next complete message.
  std::optional<Message> next();

 private:
  std::vector<std::uint8_t> bytes_;
  std::size_t used_ = 0;
};

}  // namespace physinv
