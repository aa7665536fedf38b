// The control as requests and messages, modelled on OctoPrint's API and independent of HTTP. docs/reference/host-api.md
// lists what each path takes and returns.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "printing/host/control.hpp"

namespace pliant::host {

struct ApiAnswer {
    int status = 200;  ///< as in HTTP: 200, 204 no content, 400 bad request, 404 no such path, 405 method, 409 conflict
                       ///< with the state
    std::string json;  ///< "" with 204
};

/// Answers one request. `path` begins with "/api/" and has no query; `body` is JSON or "". Thread-safe.
[[nodiscard]] ApiAnswer handle_api(Control& control, std::string_view method, std::string_view path,
                                   std::string_view body);

/// The first message to a new client: `{"history": {...}}`; sets `last_event` to the newest event in it.
[[nodiscard]] std::string history_message(const Control& control, long& last_event);
/// What has happened since event `last_event`, which is advanced: `{"current": {...}}`. To be called a few times per
/// second.
[[nodiscard]] std::string current_message(const Control& control, long& last_event);

}  // namespace pliant::host
