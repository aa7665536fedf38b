// How Ctrl-C (SIGINT) and a request to end (SIGTERM) reach a command.
#pragma once

namespace pliant::app {

/// What a signal does. A second one counts only if it comes over 30 ms after the first: some programs, `timeout` among
/// them, send theirs to the program and to its group, which is twice.
enum class OnSignal {
    end,       ///< what it does to any program
    leave,     ///< ends the program at once with exit status 1 and the line "cancelled": there is nothing to keep yet
    ask,       ///< the first makes interrupted() true, the second leaves
    ask_twice  ///< the first makes interrupted() true, the second interrupted_again(): half a file must be put away
};

/// From now on; a signal that has come already counts. For the main thread.
void on_signal(OnSignal what);

[[nodiscard]] bool interrupted();
[[nodiscard]] bool interrupted_again();
/// The second, or a later one, was Ctrl-C.
[[nodiscard]] bool pressed_again();

}  // namespace pliant::app
