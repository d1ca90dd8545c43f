#include "suite/harness/wire.h"

#include <sys/socket.h>

#include <array>
#include <cerrno>

namespace physinv {
namespace {

struct Header {
  std::uint64_t length = 0;
  std::uint64_t kind = 0;
};

bool send_all(int socket, const void* data, std::size_t size) {
  const auto* p = static_cast<const std::uint8_t*>(data);
  while (size > 0) {
    const ssize_t sent = send(socket, p, size, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    p += sent, size -= static_cast<std::size_t>(sent);
  }
  return true;
}

bool receive_all(int socket, void* data, std::size_t size) {
  auto* p = static_cast<std::uint8_t*>(data);
  while (size > 0) {
    const ssize_t got = recv(socket, p, size, 0);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    p += got, size -= static_cast<std::size_t>(got);
  }
  return true;
}

}  // namespace

bool send_message(int socket,
                  std::uint32_t kind,
                  std::span<const std::uint8_t> body) {
  const Header header{.length = body.size(), .kind = kind};
  return send_all(socket, &header, sizeof(header)) &&
         send_all(socket, body.data(), body.size());
}

std::optional<Message> receive_message(int socket) {
  Header header;
  if (!receive_all(socket, &header, sizeof(header))) return std::nullopt;
  Message message{static_cast<std::uint32_t>(header.kind), {}};
  message.body.resize(header.length);
  if (!receive_all(socket, message.body.data(), header.length))
    return std::nullopt;
  return message;
}

bool Inbox::fill(int socket) {
  std::array<std::uint8_t, 65536> chunk;
  while (true) {
    const ssize_t got = recv(socket, chunk.data(), chunk.size(), MSG_DONTWAIT);
    if (got > 0) {
      bytes_.insert(bytes_.end(), chunk.data(), chunk.data() + got);
    } else if (got < 0 && errno == EINTR) {
      continue;
    } else {
      return got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK);
    }
  }
}

std::optional<Message> Inbox::next() {
  const std::size_t there = bytes_.size() - used_;
  Header header;
  if (there < sizeof(header)) return std::nullopt;
  std::memcpy(&header, bytes_.data() + used_, sizeof(header));
  if (there < sizeof(header) + header.length) return std::nullopt;
  const auto begin =
      bytes_.begin() + static_cast<std::ptrdiff_t>(used_ + sizeof(header));
  Message message{static_cast<std::uint32_t>(header.kind),
                  {begin, begin + static_cast<std::ptrdiff_t>(header.length)}};
  used_ += sizeof(header) + header.length;
  if (used_ == bytes_.size()) bytes_.clear(), used_ = 0;
  return message;
}

}  // namespace physinv
