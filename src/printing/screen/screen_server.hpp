// Holds a panel for one host after the other. Black is its rest: before the first host, between them, after the last.
#pragma once

#include <functional>

#include "printing/screen/screen_panel.hpp"
#include "printing/screen/screen_wire.hpp"

namespace pliant::host {

struct ScreenServerOptions {
    bool once = false;           ///< ends with its first host; without it only `leave` ends it
    double first_host_s = 1e9;   ///< with `once`: ends if no host comes for so long
    std::string driver;          ///< what drives the panel, for people
    std::function<bool()> stop;  ///< asked many times a second
};

/// Serves until a host says `leave`, or `stop` says so, or the panel breaks (an error). A light never outlasts what was
/// asked, its host, or the connection. While one host is served the others are refused.
[[nodiscard]] Status serve_screen(Panel& panel, ScreenSocket& listener, const ScreenServerOptions& options);

}  // namespace pliant::host
