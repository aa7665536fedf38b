// The control as requests and messages, in the shape that OctoPrint's users know; needs nothing of HTTP. What each path
// takes and gives is in docs/reference/host-api.md.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "printing/host/control.hpp"

namespace pliant::host {

struct ApiAnswer {
    int status = 200;  ///< as in HTTP: 200, 204 done, 400 bad request, 404 no such path, 405 method, 409 not now
    std::string json;  ///< "" with 204
};

/// Answers one request. `path` begins with "/api/" and has no query; `body` is JSON or "". Safe from any thread.
[[nodiscard]] ApiAnswer handle_api(Control& control, std::string_view method, std::string_view path,
                                   std::string_view body);

/// The first message for one who has just connected: `{"history": {...}}`; `last_event` is set to the newest event in
/// it.
[[nodiscard]] std::string history_message(const Control& control, long& last_event);
/// What has happened since event `last_event`, which is moved on: `{"current": {...}}`. Call it a few times a second.
[[nodiscard]] std::string current_message(const Control& control, long& last_event);

}  // namespace pliant::host
