// The connected pages, one of which controls the robot while the others only view.
//
// Every connection has a queue: texts in order, and one slot for the latest frame of each robot, so that a slow page
// sees fewer frames but never old ones. Writing to the network is done by the server's thread of each connection.
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
    /// Waits for something to send; empty once the connection has been closed.
    [[nodiscard]] std::optional<Outgoing> next();
    void send_text(Bytes text);
    void send_frame(Bytes frame);
    /// A frame of the second robot, which has a slot of its own.
    void send_frame_beside(Bytes frame);
    void close();

    std::string page;              ///< identifies the page; empty before its hello. Guarded by the hub
    std::set<std::string> fields;  ///< requested by the page. Guarded by the hub

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
    /// `now` is the clock; tests may replace it.
    explicit Hub(std::function<Clock::time_point()> now = Clock::now) : now_(std::move(now)) {}

    [[nodiscard]] std::shared_ptr<Connection> join();
    void leave(const std::shared_ptr<Connection>& connection);
    /// Registers a page. It takes control if no page is in control, or if it is a new page and the one in control has
    /// no connection. All pages are told.
    void hello(const std::shared_ptr<Connection>& connection, const std::string& page);
    void want_fields(const std::shared_ptr<Connection>& connection, std::set<std::string> fields);

    /// Some page is there: control that has been lost for 10 s passes on.
    void ping();

    /// Requests control: taken at once if free, otherwise the page in control is asked.
    void ask(const std::shared_ptr<Connection>& connection);
    /// Passes control to the page that asked first.
    void give(const std::shared_ptr<Connection>& connection);
    /// The same; if none has asked, to another one that is connected.
    void let_go(const std::shared_ptr<Connection>& connection);
    /// True for the page in control and, while there is none, for any page. A page loses control after 10 s without a
    /// connection.
    [[nodiscard]] bool may_steer(const std::string& page);

    void send_text(const std::string& json);
    void send_frame(const Bytes& frame);
    void send_frame_beside(const Bytes& frame);
    [[nodiscard]] std::set<std::string> fields();
    [[nodiscard]] std::size_t count();
    void close_all();

private:
    void drop_lost_helm();
    void pass_on(const std::string& from);
    void tell_everybody();

    std::function<Clock::time_point()> now_;
    std::mutex mutex_;
    std::set<std::shared_ptr<Connection>> connections_;
    std::string helm_;                            ///< page in control; empty: none
    std::optional<Clock::time_point> helm_lost_;  ///< when its last connection closed
    std::deque<std::string> asking_;
    std::set<std::string> seen_;  ///< all pages so far
};

}  // namespace pliant::studio
