#include "loop/study/wire.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>

#include "base/core/json.hpp"

namespace pliant::study {
namespace {

constexpr std::uint32_t longest = 64U << 20;

}  // namespace

bool send_message(int file, const nlohmann::json& message) {
    const std::string text = json_text(message);
    const auto size = static_cast<std::uint32_t>(text.size());
    std::string bytes(sizeof size, '\0');
    std::memcpy(bytes.data(), &size, sizeof size);
    bytes += text;
    for (std::size_t sent = 0; sent < bytes.size();) {
        const ssize_t now = ::send(file, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
        if (now < 0 && errno == EINTR) continue;
        if (now <= 0) return false;
        sent += static_cast<std::size_t>(now);
    }
    return true;
}

bool Inbox::read_some(int file) {
    std::array<char, 65536> piece{};
    ssize_t got = 0;
    do {
        got = ::read(file, piece.data(), piece.size());
    } while (got < 0 && errno == EINTR);
    if (got <= 0) return false;
    come_.append(piece.data(), static_cast<std::size_t>(got));
    return true;
}

std::optional<nlohmann::json> Inbox::take() {
    std::uint32_t size = 0;
    if (failed_ || come_.size() < sizeof size) return std::nullopt;
    std::memcpy(&size, come_.data(), sizeof size);
    failed_ = size > longest;
    if (failed_ || come_.size() < sizeof size + size) return std::nullopt;
    auto message = parse_json(come_.substr(sizeof size, size));
    come_.erase(0, sizeof size + size);
    failed_ = message.is_discarded();
    if (failed_) return std::nullopt;
    return message;
}

}  // namespace pliant::study
