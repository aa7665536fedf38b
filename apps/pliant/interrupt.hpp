// Handling of Ctrl-C (SIGINT) and termination requests (SIGTERM) in a command.
#pragma once

#include <filesystem>
#include <string_view>

#include "base/core/error.hpp"

namespace pliant::app {

/// Effect of a signal. A second one only counts if it comes over 30 ms after the first: some programs, such as
/// `timeout`, signal both the program and its group, so that it arrives twice.
enum class OnSignal {
    end,       ///< the default: terminates the program
    leave,     ///< terminates at once with exit status 1 and the line "cancelled": there is nothing to clean up yet
    ask,       ///< the first makes interrupted() true, the second terminates
    ask_twice  ///< the first makes interrupted() true, the second interrupted_again(): a partial file must be removed
};

/// Applies from now on; a signal received earlier still counts. Main thread only.
void on_signal(OnSignal what);

/// From now on a signal that ends the program also prints {"error": "cancelled"} to standard output.
void tell_cancelled_in_json();

/// Writes a file of a command that `leave`s: a signal has its effect once the file is whole.
[[nodiscard]] Status write_file_and_leave(const std::filesystem::path& path, std::string_view bytes);

[[nodiscard]] bool interrupted();
[[nodiscard]] bool interrupted_again();
/// True if the second signal, or a later one, was Ctrl-C.
[[nodiscard]] bool pressed_again();

}  // namespace pliant::app
