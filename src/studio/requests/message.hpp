// Messages that a page sends over its WebSocket: JSON texts, one object each, distinguished by "type".
//
//     {"type": "hello", "page": "k3J..."}                       identifies the page; repeated after a lost connection
//     {"type": "drive", "tag": 7, "time": 0.5, "actuators": [{"name": "flexor", "kind": "length_ratio", "value": 0.8}]}
//     {"type": "follow", "tag": 8, "time": 0.5}                 all actuators follow the program at this time
//     {"type": "play", "on": true}      {"type": "rest"}
//     {"type": "pull", "vertex": 12, "to": [10, 0, 5]}          millimetres      {"type": "release"}
//     {"type": "lead", "marker": "tip", "to": [10, 0, 5]}       millimetres; the actuators follow, until "release"
//     {"type": "fields", "names": ["J"]}
//     {"type": "steer", "action": "ask" | "give" | "leave"}
//     {"type": "ping"}
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/core/error.hpp"

namespace pliant::studio {

inline constexpr std::size_t longest_message = 64 * 1024;

struct Hello {
    std::string page;  ///< 8 to 64 letters, digits, '-' and '_'
};
struct ActuatorValue {
    std::string name;
    std::string
        kind;  ///< length_ratio, shortening_mm, tension_N; volume_ratio, volume_change_mm3, pressure_kPa, gas_ratio
    double value = 0;
};
struct DriveMessage {
    double tag = 0;              ///< of the input; returned with the frame that shows it
    std::optional<double> time;  ///< program time, for loads and supports; empty: unchanged
    std::vector<ActuatorValue> actuators;
};
struct Follow {
    double tag = 0;
    double time = 0;
};
struct Play {
    bool on = true;
};
struct Rest {};
struct PullMessage {
    double tag = 0;
    int vertex = 0;
    std::array<double, 3> to_mm{};
};
struct LeadMessage {
    double tag = 0;
    std::string marker;
    std::array<double, 3> to_mm{};
};
struct Release {};
struct FieldsMessage {
    std::vector<std::string> names;
};
struct Steer {
    enum class Action { ask, give, leave } action = Action::ask;
};
struct Ping {};

using Message = std::variant<Hello, DriveMessage, Follow, Play, Rest, PullMessage, LeadMessage, Release, FieldsMessage,
                             Steer, Ping>;

/// Errors name the key. Times are at least 0. Numbers are finite and within +-1e9, lists at most 256 long, names at
/// most 200 bytes.
[[nodiscard]] Result<Message> parse_message(std::string_view text);

}  // namespace pliant::studio
