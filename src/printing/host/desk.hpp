// The exchange between requesting threads and the working thread: requests go one way, snapshot and events the other.
#pragma once

#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "printing/host/control_types.hpp"
#include "printing/host/journal_facts.hpp"

namespace pliant::host {

/// Requests to a running print.
struct Wishes {
    bool pause_after = false;
    bool pause_now = false;
    bool resume = false;
    bool cancel = false;
    bool suspend = false;
};

class Desk {
public:
    explicit Desk(Clock& clock) : clock_(clock) {}

    // Any thread.
    [[nodiscard]] Snapshot snapshot() const;
    [[nodiscard]] State state() const;
    [[nodiscard]] std::vector<Event> events_since(long number) const;
    void event(std::string_view kind, std::string text);
    /// Changes the snapshot.
    void update(const std::function<void(Snapshot&)>& change);
    /// Changes the state, with an event.
    void state(State state, std::string message = {});
    /// Changes the state to `next`, if any, where `allowed` by the snapshot. A print that begins so finds no requests
    /// of an earlier one.
    [[nodiscard]] Status ask(std::optional<State> next, const std::function<Status(const Snapshot&)>& allowed);
    /// Of a print that is under way, else an error.
    [[nodiscard]] Status wish(const std::function<void(Wishes&)>& change);
    [[nodiscard]] Status change_exposure(int material, double seconds);
    [[nodiscard]] Status skip_layer(int layer);
    /// Also of a print that has not begun.
    void suspend();
    void stop_everything();

    // The working thread.
    /// An error once an emergency stop was requested.
    [[nodiscard]] Status watch() const;
    [[nodiscard]] bool stopped() const;
    void clear_stop();
    /// Number of emergency stops so far.
    [[nodiscard]] long stops() const;
    [[nodiscard]] Wishes wishes() const;
    /// Whether resume() was requested since the last call.
    [[nodiscard]] bool take_resume();
    /// The changes requested since the last call.
    [[nodiscard]] std::vector<ChangeFact> take_changes();
    [[nodiscard]] std::vector<int> take_skips();

private:
    [[nodiscard]] Status only_when_printing() const;

    Clock& clock_;
    mutable std::mutex mutex_;
    Snapshot snapshot_;
    std::deque<Event> events_;
    long last_event_ = 0;
    Wishes wishes_;
    std::vector<ChangeFact> changes_;
    std::vector<int> skips_;
    bool stop_ = false;
    long stops_ = 0;
};

}  // namespace pliant::host
