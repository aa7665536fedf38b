#include "printing/screen/screen_wire.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstring>
#include <optional>
#include <type_traits>

namespace pliant::host {
namespace {

constexpr std::uint32_t protocol = 0x504c5331;  // "PLS1": both ends must be of the same version
constexpr std::uint64_t most_bytes = std::uint64_t{1} << 28;
constexpr double send_timeout_s = 5;

struct Head {
    std::uint32_t magic = protocol;
    Say say = Say::hello;
    std::int32_t width_px = 0, height_px = 0;
    Light light;
    std::uint64_t bytes = 0;
};
static_assert(std::is_trivially_copyable_v<Head>);

struct Deadline {
    explicit Deadline(double seconds)
        : end(std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                                     std::chrono::duration<double>(std::clamp(seconds, 0.0, 1e6)))) {}
    [[nodiscard]] int left_ms() const {
        const auto left = end - std::chrono::steady_clock::now();
        const auto ms = std::chrono::ceil<std::chrono::milliseconds>(left).count();
        return static_cast<int>(std::clamp<long>(ms, 0, 1000000000));
    }
    std::chrono::steady_clock::time_point end;
};

bool wait_for(int file, short events, const Deadline& deadline) {
    for (;;) {
        pollfd wait{file, events, 0};
        const int ready = ::poll(&wait, 1, deadline.left_ms());
        if (ready > 0) return true;
        if (ready == 0 || errno != EINTR) return false;
    }
}

Status send_all(int file, const char* bytes, std::size_t count, const Deadline& deadline) {
    while (count > 0) {
        const ssize_t sent = ::send(file, bytes, count, MSG_NOSIGNAL | MSG_DONTWAIT);
        if (sent > 0) {
            bytes += sent;
            count -= static_cast<std::size_t>(sent);
        } else if (errno == EAGAIN) {
            if (!wait_for(file, POLLOUT, deadline)) return failure("takes no more");
        } else if (errno != EINTR) {
            return failure("{}", std::strerror(errno));
        }
    }
    return {};
}

Status receive_all(int file, char* bytes, std::size_t count, const Deadline& deadline) {
    while (count > 0) {
        const ssize_t got = ::recv(file, bytes, count, MSG_DONTWAIT);
        if (got > 0) {
            bytes += got;
            count -= static_cast<std::size_t>(got);
        } else if (got == 0) {
            return failure("the connection has ended");
        } else if (errno == EAGAIN) {
            if (!wait_for(file, POLLIN, deadline)) return failure("no answer in time");
        } else if (errno != EINTR) {
            return failure("{}", std::strerror(errno));
        }
    }
    return {};
}

/// A name in the abstract namespace: it vanishes with its owner, so there are no stale socket files.
socklen_t abstract_address(const std::string& name, sockaddr_un& address) {
    address = {};
    address.sun_family = AF_UNIX;
    const std::size_t length = std::min(name.size(), sizeof(address.sun_path) - 1);
    std::memcpy(address.sun_path + 1, name.data(), length);
    return static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + length);
}

std::optional<ucred> other_end(int file) {
    ucred who{};
    socklen_t size = sizeof who;
    if (::getsockopt(file, SOL_SOCKET, SO_PEERCRED, &who, &size) != 0) return std::nullopt;
    return who;
}

bool is_same_user(int file) {
    const auto who = other_end(file);
    return who && who->uid == ::getuid();
}

}  // namespace

Result<ScreenSocket> ScreenSocket::make() {
    ScreenSocket socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    if (!socket.is_open()) return failure("no socket: {}", std::strerror(errno));
    return socket;
}

Result<ScreenSocket> ScreenSocket::listen(const std::string& name) {
    auto result = make();
    if (!result) return result;
    const int file = result->file_.number();
    sockaddr_un address;
    const socklen_t size = abstract_address(name, address);
    if (::bind(file, reinterpret_cast<const sockaddr*>(&address), size) != 0 || ::listen(file, 8) != 0)
        return failure("{}", std::strerror(errno));
    return result;
}

Result<ScreenSocket> ScreenSocket::connect(const std::string& name) {
    auto result = make();
    if (!result) return result;
    const int file = result->file_.number();
    sockaddr_un address;
    const socklen_t size = abstract_address(name, address);
    if (::connect(file, reinterpret_cast<const sockaddr*>(&address), size) != 0)
        return failure("{}", std::strerror(errno));
    if (!is_same_user(file)) return failure("another user's program holds the panel");
    return result;
}

ScreenSocket ScreenSocket::accept() const {
    ScreenSocket host(::accept4(file_.number(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (host.is_open() && !is_same_user(host.file_.number())) host.close();
    return host;
}

Status ScreenSocket::send(const Message& message) const {
    Head head;
    head.say = message.say;
    head.width_px = message.width_px;
    head.height_px = message.height_px;
    head.light = message.light;
    head.bytes = message.bytes.size();
    const Deadline deadline(send_timeout_s);
    if (Status status = send_all(file_.number(), reinterpret_cast<const char*>(&head), sizeof head, deadline); !status)
        return status;
    return send_all(file_.number(), message.bytes.data(), message.bytes.size(), deadline);
}

Result<Message> ScreenSocket::receive(double timeout_s) const {
    const Deadline deadline(timeout_s);
    Head head;
    if (Status status = receive_all(file_.number(), reinterpret_cast<char*>(&head), sizeof head, deadline); !status)
        return tl::unexpected(status.error());
    const bool good = head.magic == protocol && head.say <= Say::refused && head.bytes <= most_bytes;
    if (!good) return failure("the other end speaks another language: end all programs named pliant-screen");
    Message message{head.say, head.width_px, head.height_px, head.light, {}};
    message.bytes.resize(head.bytes);
    if (Status status = receive_all(file_.number(), message.bytes.data(), message.bytes.size(), deadline); !status)
        return tl::unexpected(status.error());
    return message;
}

int ScreenSocket::peer_process() const {
    const auto who = other_end(file_.number());
    return who ? who->pid : 0;
}

bool ScreenSocket::has_news(double timeout_s) const {
    return wait_for(file_.number(), POLLIN, Deadline(timeout_s));
}

std::string screen_socket_name(std::string_view panel) {
    std::uint64_t hash = 0xcbf29ce484222325;  // FNV-1a hash, because panel names may be longer than a socket name
    for (const char c : panel) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
    return fmt::format("pliant-screen-{}-{:016x}", ::getuid(), hash);
}

}  // namespace pliant::host
