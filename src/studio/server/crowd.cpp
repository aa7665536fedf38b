#include "studio/server/crowd.hpp"

#include <netdb.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <functional>
#include <optional>
#include <vector>

#include "studio/server/own_sockets.hpp"

namespace pliant::studio {
namespace {

constexpr std::chrono::milliseconds between_looks{100};

/// The other end of a connected TCP socket.
std::optional<Caller> caller_of(int file) {
    sockaddr_storage address{};
    socklen_t length = sizeof address;
    if (getpeername(file, reinterpret_cast<sockaddr*>(&address), &length) != 0) return std::nullopt;
    std::array<char, NI_MAXHOST> host{};
    std::array<char, NI_MAXSERV> port{};
    if (getnameinfo(reinterpret_cast<const sockaddr*>(&address), length, host.data(), host.size(), port.data(),
                    port.size(), NI_NUMERICHOST | NI_NUMERICSERV) != 0)
        return std::nullopt;
    int number = 0;
    const std::string text = port.data();
    std::from_chars(text.data(), text.data() + text.size(), number);
    return Caller{host.data(), number};
}

std::map<Caller, int> callers(int port) {
    std::map<Caller, int> found;
    for (const int file : sockets_at(port)) {
        if (std::optional<Caller> caller = caller_of(file)) found.emplace(std::move(*caller), file);
    }
    return found;
}

}  // namespace

Crowd::~Crowd() = default;

void Crowd::begin(Caller caller) {
    const std::lock_guard lock(mutex_);
    at_work_.insert(std::move(caller));
}

void Crowd::end(const Caller& caller) {
    const std::lock_guard lock(mutex_);
    at_work_.erase(caller);
}

void Crowd::watch(int port) {
    thread_ = std::jthread([this, port](const std::stop_token& stopped) {
        while (!stopped.stop_requested()) {
            thin(port);
            std::this_thread::sleep_for(between_looks);
        }
    });
}

void Crowd::thin(int port) {
    std::map<Caller, int> waiting = callers(port);
    const std::lock_guard lock(mutex_);
    std::erase_if(waiting, [&](const auto& one) { return at_work_.contains(one.first); });
    std::erase_if(since_, [&](const auto& one) { return !waiting.contains(one.first); });
    std::map<std::string, std::vector<Caller>> of_address;
    for (const auto& [caller, file] : waiting) {
        since_.emplace(caller, Clock::now());
        of_address[caller.first].push_back(caller);
    }
    for (auto& [address, all] : of_address)  // the oldest last
        std::ranges::sort(all, std::greater{}, [&](const Caller& caller) { return since_[caller]; });
    for (std::size_t left = waiting.size(); left > most_waiting; --left) {
        auto& most =
            std::ranges::max_element(of_address, {}, [](const auto& one) { return one.second.size(); })->second;
        (void)shutdown(waiting[most.back()], SHUT_RDWR);
        most.pop_back();
    }
}

}  // namespace pliant::studio
