// A small robot and a recorder of events, for the tests of the studio's sessions.
#pragma once

#include <doctest/doctest.h>

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace pliant::studio::test {

using Json = nlohmann::json;

inline constexpr const char* bar = R"(name = "bar"
length_unit = "mm"
material.soft = { youngs_modulus = "1 MPa", poisson_ratio = 0.45, resin = "semi-flex" }
body = [{ name = "bar", material = "soft", geometry = { box = [[0, 0, 0], [4, 3, 2]] } }]
fixed = [{ name = "clamp", box = [[0, 0, 0], [0, 3, 2]] }]
marker = [{ name = "tip", point = [4, 1.5, 1] }]
mesh = { size = "1.5 mm" }
[[cable]]
name = "flexor"
points = [[0, 1.5, 1.8], [2, 1.5, 1.8], [4, 1.5, 1.8]]
target = { shortening = "0.2 mm" }
)";

/// The events of a session, in order, from any thread.
class Events {
public:
    void add(const std::string& json) {
        const std::lock_guard lock(mutex_);
        all_.push_back(Json::parse(json));
        changed_.notify_all();
    }
    /// Waits for the first event that satisfies `wanted`, and returns it.
    Json wait_for(const std::function<bool(const Json&)>& wanted) {
        std::unique_lock lock(mutex_);
        Json found;
        const bool came = changed_.wait_for(lock, std::chrono::seconds(60), [&] {
            for (const Json& event : all_) {
                if (wanted(event)) return found = event, true;
            }
            return false;
        });
        REQUIRE_MESSAGE(came, "what was waited for was never told");
        return found;
    }
    [[nodiscard]] std::size_t count(const std::string& type) const {
        const std::lock_guard lock(mutex_);
        std::size_t n = 0;
        for (const Json& event : all_) n += event["type"] == type ? 1 : 0;
        return n;
    }
    void clear() {
        const std::lock_guard lock(mutex_);
        all_.clear();
    }

private:
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<Json> all_;
};

}  // namespace pliant::studio::test
