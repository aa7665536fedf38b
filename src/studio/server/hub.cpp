#include "studio/server/hub.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace pliant::studio {
namespace {

constexpr std::size_t most_texts = 1000;  // a page that stops reading is disconnected
constexpr std::chrono::seconds helm_kept{10};

}  // namespace

std::optional<Connection::Outgoing> Connection::next() {
    std::unique_lock lock(mutex_);
    something_.wait(lock, [&] { return closed_ || !texts_.empty() || frame_ || beside_; });
    if (closed_) return std::nullopt;
    if (!texts_.empty()) {
        Outgoing out{std::move(texts_.front()), false};
        texts_.pop_front();
        return out;
    }
    // Alternately, so that neither robot waits for the other.
    const bool beside = beside_ && (beside_next_ || !frame_);
    beside_next_ = !beside;
    return Outgoing{std::exchange(beside ? beside_ : frame_, nullptr), true};
}

void Connection::send_text(Bytes text) {
    const std::lock_guard lock(mutex_);
    if (texts_.size() >= most_texts) closed_ = true;
    texts_.push_back(std::move(text));
    something_.notify_one();
}

void Connection::send_frame(Bytes frame) {
    const std::lock_guard lock(mutex_);
    frame_ = std::move(frame);
    something_.notify_one();
}

void Connection::send_frame_beside(Bytes frame) {
    const std::lock_guard lock(mutex_);
    beside_ = std::move(frame);
    something_.notify_one();
}

void Connection::close() {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    something_.notify_one();
}

std::shared_ptr<Connection> Hub::join() {
    auto connection = std::make_shared<Connection>();
    const std::lock_guard lock(mutex_);
    connections_.insert(connection);
    return connection;
}

void Hub::leave(const std::shared_ptr<Connection>& connection) {
    connection->close();
    const std::lock_guard lock(mutex_);
    connections_.erase(connection);
    const auto same = [&](const auto& c) { return c->page == connection->page; };
    const bool here = std::any_of(connections_.begin(), connections_.end(), same);
    if (!here) std::erase(asking_, connection->page);
    if (!here && !helm_.empty() && connection->page == helm_) helm_lost_ = now_();
    tell_everybody();
}

void Hub::hello(const std::shared_ptr<Connection>& connection, const std::string& page) {
    const std::lock_guard lock(mutex_);
    connection->page = page;
    drop_lost_helm();
    const bool fresh = seen_.insert(page).second;
    if (helm_.empty() || (fresh && helm_lost_)) helm_ = page;
    if (helm_ == page) helm_lost_.reset();
    tell_everybody();
}

void Hub::want_fields(const std::shared_ptr<Connection>& connection, std::set<std::string> fields) {
    const std::lock_guard lock(mutex_);
    connection->fields = std::move(fields);
}

void Hub::ping() {
    const std::lock_guard lock(mutex_);
    drop_lost_helm();
}

void Hub::ask(const std::shared_ptr<Connection>& connection) {
    const std::lock_guard lock(mutex_);
    if (connection->page.empty()) return;
    drop_lost_helm();
    if (helm_.empty() || helm_lost_) {
        helm_ = connection->page;
        helm_lost_.reset();
    } else if (helm_ != connection->page &&
               std::find(asking_.begin(), asking_.end(), connection->page) == asking_.end()) {
        asking_.push_back(connection->page);
    }
    std::erase(asking_, helm_);
    tell_everybody();
}

void Hub::give(const std::shared_ptr<Connection>& connection) {
    const std::lock_guard lock(mutex_);
    if (connection->page != helm_ || asking_.empty()) return;
    helm_ = asking_.front();
    asking_.pop_front();
    tell_everybody();
}

void Hub::let_go(const std::shared_ptr<Connection>& connection) {
    const std::lock_guard lock(mutex_);
    if (connection->page == helm_) pass_on(connection->page);
}

bool Hub::may_steer(const std::string& page) {
    const std::lock_guard lock(mutex_);
    drop_lost_helm();
    return helm_.empty() || helm_ == page;
}

void Hub::drop_lost_helm() {
    if (!helm_lost_ || now_() - *helm_lost_ < helm_kept) return;
    helm_lost_.reset();
    pass_on(helm_);
}

/// To the page that asked first, else to any other that is connected.
void Hub::pass_on(const std::string& from) {
    const auto other = [&](const auto& c) { return !c->page.empty() && c->page != from; };
    const auto found = std::find_if(connections_.begin(), connections_.end(), other);
    helm_ = !asking_.empty() ? asking_.front() : found != connections_.end() ? (*found)->page : "";
    std::erase(asking_, helm_);
    tell_everybody();
}

void Hub::tell_everybody() {
    for (const auto& connection : connections_) {
        if (connection->page.empty()) continue;
        const bool you = connection->page == helm_;
        const bool waiting = std::find(asking_.begin(), asking_.end(), connection->page) != asking_.end();
        connection->send_text(std::make_shared<const std::string>(
            fmt::format(R"({{"type":"helm","you":{},"held":{},"asked":{},"waiting":{},"pages":{}}})", you,
                        !helm_.empty() && !helm_lost_, you && !asking_.empty(), waiting, connections_.size())));
    }
}

void Hub::send_text(const std::string& json) {
    const auto text = std::make_shared<const std::string>(json);
    const std::lock_guard lock(mutex_);
    for (const auto& connection : connections_) connection->send_text(text);
}

void Hub::send_frame(const Bytes& frame) {
    const std::lock_guard lock(mutex_);
    for (const auto& connection : connections_) connection->send_frame(frame);
}

void Hub::send_frame_beside(const Bytes& frame) {
    const std::lock_guard lock(mutex_);
    for (const auto& connection : connections_) connection->send_frame_beside(frame);
}

std::set<std::string> Hub::fields() {
    const std::lock_guard lock(mutex_);
    std::set<std::string> all;
    for (const auto& connection : connections_) all.insert(connection->fields.begin(), connection->fields.end());
    return all;
}

std::size_t Hub::count() {
    const std::lock_guard lock(mutex_);
    return connections_.size();
}

void Hub::close_all() {
    const std::lock_guard lock(mutex_);
    for (const auto& connection : connections_) connection->close();
}

}  // namespace pliant::studio
