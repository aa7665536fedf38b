// Starting other programs.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"

namespace pliant {

/// Standard input, output and error of a new process; a negative number means /dev/null.
struct ProcessFiles {
    int input = -1;
    int output = -1;
    int error = -1;
};

/// Starts a program without searching PATH; `words` are its arguments without the program's name. It runs in a session
/// of its own, so a Ctrl-C that ends this program does not end it, and with no signal blocked. The caller must wait for
/// the process (waitpid). Errors: names the program and the system's reason.
[[nodiscard]] Result<pid_t> start_process(const std::filesystem::path& program, std::vector<std::string> words,
                                          const ProcessFiles& files);

/// A text in single quotes, as the shells sh, bash, zsh and fish read it.
[[nodiscard]] std::string in_shell_quotes(std::string_view text);

/// How a process ended.
struct ProcessEnd {
    int status = 0;    ///< as of waitpid()
    double cpu_s = 0;  ///< processor time that it used
};

/// "signal 9: Killed" or "exit status 1".
[[nodiscard]] std::string end_text(const ProcessEnd& end);

/// By a signal that it cannot catch, as the system does when memory is short.
[[nodiscard]] bool was_killed(const ProcessEnd& end);

/// A process from start_process(), killed with its owner. In a copy of this program that fork() made it is nobody's
/// child: there it is left alone.
class ChildProcess {
public:
    explicit ChildProcess(pid_t process);
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;
    ~ChildProcess() { (void)end(); }

    /// Kills it if it still runs.
    ProcessEnd end();
    /// Gives it a second to exit by itself, for processes that were asked to or that have closed their pipe.
    ProcessEnd let_end();
    /// Started by this process, not by one that it was forked from.
    [[nodiscard]] bool is_ours() const;

private:
    pid_t process_;  ///< -1 once it has ended
    pid_t parent_;
    ProcessEnd end_;
};

}  // namespace pliant
