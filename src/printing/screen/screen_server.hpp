// Holds a panel for one host after the other. It is black when idle: before the first host, between hosts, after the
// last.
#pragma once

#include <functional>

#include "printing/screen/screen_panel.hpp"
#include "printing/screen/screen_wire.hpp"

namespace pliant::host {

struct ScreenServerOptions {
    bool once = false;           ///< ends with its first host; otherwise only `leave` ends it
    double first_host_s = 1e9;   ///< with `once`: ends if no host connects within this time
    std::string driver;          ///< name of the panel's driver, for people
    std::function<bool()> stop;  ///< polled many times a second
};

/// Serves until a host sends `leave`, `stop` returns true, or the panel breaks (an error). An exposure never outlasts
/// its requested time, its host, or the connection. Only one host is served at a time; others are refused.
[[nodiscard]] Status serve_screen(Panel& panel, ScreenSocket& listener, const ScreenServerOptions& options);

}  // namespace pliant::host
