#include "geometry/mesher/message_pipe.hpp"

#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>

namespace pliant::mesh {
namespace {

constexpr std::size_t head_size = 1 + sizeof(std::uint64_t);

bool send_all(int file, const char* bytes, std::size_t size) {
    while (size > 0) {
        const ssize_t sent = ::send(file, bytes, size, MSG_NOSIGNAL);
        if (sent < 0 && errno == EINTR) continue;
        if (sent <= 0) return false;
        bytes += sent;
        size -= static_cast<std::size_t>(sent);
    }
    return true;
}

}  // namespace

bool MessagePipe::send(MessageKind kind, std::string_view bytes) const {
    std::array<char, head_size> head{};
    head[0] = static_cast<char>(kind);
    const std::uint64_t size = bytes.size();
    std::memcpy(head.data() + 1, &size, sizeof(size));
    return send_all(file(), head.data(), head.size()) && send_all(file(), bytes.data(), bytes.size());
}

std::optional<std::uint64_t> MessagePipe::announced_size() const {
    if (come_.size() < head_size) return std::nullopt;
    std::uint64_t size = 0;
    std::memcpy(&size, come_.data() + 1, sizeof(size));
    return size;
}

bool MessagePipe::take_message(Message& message) {
    const std::optional<std::uint64_t> size = announced_size();
    if (!size || come_.size() - head_size < *size) return false;
    message.kind = static_cast<MessageKind>(come_[0]);
    message.bytes.assign(come_, head_size, static_cast<std::size_t>(*size));
    come_.erase(0, head_size + static_cast<std::size_t>(*size));
    return true;
}

Received MessagePipe::receive(Message& message, int wait_ms, std::uint64_t most_bytes) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::milliseconds(wait_ms);
    std::array<char, 65536> chunk{};
    while (announced_size().value_or(0) <= most_bytes) {
        if (take_message(message)) return Received::message;
        pollfd ready{file(), POLLIN, 0};
        const int count = ::poll(&ready, 1, wait_ms);
        if (count < 0 && errno == EINTR) continue;
        if (count == 0) return Received::waiting;
        const ssize_t got = ::recv(file(), chunk.data(), chunk.size(), 0);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return Received::closed;
        come_.append(chunk.data(), static_cast<std::size_t>(got));
        // Whoever never stops sending must not keep the caller from looking at the clock.
        if (wait_ms >= 0 && std::chrono::steady_clock::now() > until) return Received::waiting;
    }
    return Received::too_large;
}

}  // namespace pliant::mesh
