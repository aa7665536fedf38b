#include "printing/host/desk.hpp"

#include <utility>

namespace pliant::host {
namespace {

constexpr std::size_t most_events = 2000;

}  // namespace

Snapshot Desk::snapshot() const {
    const std::scoped_lock lock(mutex_);
    Snapshot snapshot = snapshot_;
    snapshot.last_event = last_event_;
    return snapshot;
}

State Desk::state() const {
    const std::scoped_lock lock(mutex_);
    return snapshot_.state;
}

std::vector<Event> Desk::events_since(long number) const {
    const std::scoped_lock lock(mutex_);
    std::vector<Event> events;
    for (const Event& event : events_) {
        if (event.number > number) events.push_back(event);
    }
    return events;
}

void Desk::event(std::string_view kind, std::string text) {
    const double now_s = clock_.now();
    const std::scoped_lock lock(mutex_);
    events_.push_back({++last_event_, now_s, std::string(kind), std::move(text)});
    if (events_.size() > most_events) events_.pop_front();
}

void Desk::update(const std::function<void(Snapshot&)>& change) {
    const std::scoped_lock lock(mutex_);
    change(snapshot_);
}

void Desk::state(State state, std::string message) {
    event("state", std::string(state_text(state)) + (message.empty() ? "" : ": " + message));
    update([&](Snapshot& s) {
        s.state = state;
        s.connecting = false;
        s.message = std::move(message);
    });
}

Status Desk::ask(std::optional<State> next, const std::function<Status(const Snapshot&)>& allowed) {
    const std::scoped_lock lock(mutex_);
    if (Status status = allowed(snapshot_); !status || !next) return status;
    if (is_printing(*next) && !is_printing(snapshot_.state)) {
        wishes_ = {};
        changes_.clear();
        skips_.clear();
    }
    snapshot_.connecting = *next == State::printing;
    snapshot_.state = *next;
    snapshot_.message.clear();  // of the state before
    return {};
}

Status Desk::only_when_printing() const {
    if (is_printing(snapshot_.state)) return {};
    return failure("not possible now: no print is under way");
}

Status Desk::wish(const std::function<void(Wishes&)>& change) {
    const std::scoped_lock lock(mutex_);
    if (Status status = only_when_printing(); !status) return status;
    change(wishes_);
    return {};
}

void Desk::suspend() {
    const std::scoped_lock lock(mutex_);
    wishes_.suspend = true;
}

Wishes Desk::wishes() const {
    const std::scoped_lock lock(mutex_);
    return wishes_;
}

bool Desk::take_resume() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(wishes_.resume, false);
}

Status Desk::change_exposure(int material, double seconds) {
    const std::scoped_lock lock(mutex_);
    if (Status status = only_when_printing(); !status) return status;
    changes_.push_back({material, seconds, 0});
    return {};
}

Status Desk::skip_layer(int layer) {
    const std::scoped_lock lock(mutex_);
    if (Status status = only_when_printing(); !status) return status;
    skips_.push_back(layer);
    return {};
}

void Desk::stop_everything() {
    const std::scoped_lock lock(mutex_);
    stop_ = true;
    ++stops_;
}

long Desk::stops() const {
    const std::scoped_lock lock(mutex_);
    return stops_;
}

void Desk::clear_stop() {
    const std::scoped_lock lock(mutex_);
    stop_ = false;
}

bool Desk::stopped() const {
    const std::scoped_lock lock(mutex_);
    return stop_;
}

Status Desk::watch() const {
    return stopped() ? Status(failure("emergency stop")) : Status{};
}

std::vector<ChangeFact> Desk::take_changes() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(changes_, {});
}

std::vector<int> Desk::take_skips() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(skips_, {});
}

}  // namespace pliant::host
