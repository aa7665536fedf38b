// Connections that wait in a server without a request, so that those who never finish one do not take the places of
// others.
#pragma once

#include <chrono>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <utility>

namespace pliant::studio {

/// Address and port of the other end.
using Caller = std::pair<std::string, int>;

/// Watches the connections of one port of this process. Of those that have no request under way, too many are hung up:
/// the oldest of the address that has most.
class Crowd {
public:
    static constexpr std::size_t most_waiting = 32;

    Crowd() = default;
    ~Crowd();
    Crowd(const Crowd&) = delete;
    Crowd& operator=(const Crowd&) = delete;

    /// The head of a request of this caller has come, or its answer has been given. From any thread.
    void begin(Caller caller);
    void end(const Caller& caller);

    /// Begins to watch, until destroyed. Precondition: port > 0.
    void watch(int port);
    /// One look at all connections; `watch` does this ten times a second.
    void thin(int port);

private:
    using Clock = std::chrono::steady_clock;

    std::mutex mutex_;
    std::set<Caller> at_work_;
    std::map<Caller, Clock::time_point> since_;  ///< of those that wait; used by `thin` alone
    std::jthread thread_;
};

}  // namespace pliant::studio
