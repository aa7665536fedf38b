// The pages that look on, and the one that steers.
//
// Every connection has a queue: texts in order, and one place for the latest frame of each robot, so that a slow page
// sees fewer frames and never old ones. What writes to the wire waits on its connection and belongs to the server.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>

namespace pliant::studio {

using Bytes = std::shared_ptr<const std::string>;

/// One WebSocket.
class Connection {
public:
    struct Outgoing {
        Bytes bytes;
        bool binary = false;
    };
    /// Waits for something to send; nothing once the connection has been closed.
    [[nodiscard]] std::optional<Outgoing> next();
    void send_text(Bytes text);
    void send_frame(Bytes frame);
    /// Of the robot beside, which has a place of its own.
    void send_frame_beside(Bytes frame);
    void close();

    std::string page;              ///< who it is; empty before its hello. Guarded by the hub
    std::set<std::string> fields;  ///< that it wants to see. Guarded by the hub

private:
    std::mutex mutex_;
    std::condition_variable something_;
    std::deque<Bytes> texts_;
    Bytes frame_, beside_;
    bool beside_next_ = false;
    bool closed_ = false;
};

class Hub {
public:
    using Clock = std::chrono::steady_clock;
    /// `now` tells the time; a test may turn it.
    explicit Hub(std::function<Clock::time_point()> now = Clock::now) : now_(std::move(now)) {}

    [[nodiscard]] std::shared_ptr<Connection> join();
    void leave(const std::shared_ptr<Connection>& connection);
    /// A page without a helmsman takes the helm. Everybody is told.
    void hello(const std::shared_ptr<Connection>& connection, const std::string& page);
    void want_fields(const std::shared_ptr<Connection>& connection, std::set<std::string> fields);

    /// Asks for the helm: free, it is taken; else whoever has it is asked.
    void ask(const std::shared_ptr<Connection>& connection);
    /// Hands the helm to who asked first.
    void give(const std::shared_ptr<Connection>& connection);
    void let_go(const std::shared_ptr<Connection>& connection);
    /// True for who steers and, while nobody does, for anyone. A page that has been gone for 10 s steers no more.
    [[nodiscard]] bool may_steer(const std::string& page);

    void send_text(const std::string& json);
    void send_frame(const Bytes& frame);
    void send_frame_beside(const Bytes& frame);
    [[nodiscard]] std::set<std::string> fields();
    [[nodiscard]] std::size_t count();
    void close_all();

private:
    void drop_lost_helm();
    void tell_everybody();

    std::function<Clock::time_point()> now_;
    std::mutex mutex_;
    std::set<std::shared_ptr<Connection>> connections_;
    std::string helm_;                            ///< page that steers; empty: nobody
    std::optional<Clock::time_point> helm_lost_;  ///< when its last connection went
    std::deque<std::string> asking_;
};

}  // namespace pliant::studio
