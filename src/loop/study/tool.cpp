#include "loop/study/tool.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "base/core/file_handle.hpp"
#include "base/core/process.hpp"

namespace pliant::study {
namespace {

namespace fs = std::filesystem;

/// The program's path on PATH; empty: not found.
fs::path found_in_path(const std::string& name) {
    const char* const path = std::getenv("PATH");
    std::string_view rest = path == nullptr ? "/usr/local/bin:/usr/bin:/bin" : path;
    while (!rest.empty()) {
        const std::size_t end = std::min(rest.find(':'), rest.size());
        const fs::path file = fs::path(rest.substr(0, end)) / name;
        if (::access(file.c_str(), X_OK) == 0) return file;
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    return {};
}

struct Pipe {
    FileHandle read, write;
};

Result<Pipe> make_pipe() {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) return failure("no pipe can be made: {}", std::strerror(errno));
    return Pipe{FileHandle(ends[0]), FileHandle(ends[1])};
}

/// Appends available bytes; closes the file at its end.
void take(FileHandle& file, std::string& text) {
    std::array<char, 4096> piece{};
    const ssize_t got = ::read(file.number(), piece.data(), piece.size());
    if (got > 0)
        text.append(piece.data(), static_cast<std::size_t>(got));
    else if (got == 0 || errno != EINTR)
        file.close();
}

int ended(pid_t process) {
    int status = 0;
    while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace

Result<ToolOutcome> run_tool(const std::string& name, const std::vector<std::string>& words, double limit_s,
                             const Progress& progress) {
    using Clock = std::chrono::steady_clock;
    const fs::path program = found_in_path(name);
    if (program.empty()) return failure("{}: there is no such program in PATH; is Slurm installed here?", name);
    Result<Pipe> output = make_pipe(), errors = make_pipe();
    if (!output || !errors) return tl::unexpected(output ? errors.error() : output.error());
    const auto process = start_process(program, words, {-1, output->write.number(), errors->write.number()});
    if (!process) return tl::unexpected(process.error());
    output->write.close();
    errors->write.close();
    const auto until =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(limit_s));
    ToolOutcome outcome;
    while (output->read.is_open() || errors->read.is_open()) {
        if (progress.cancelled() || Clock::now() > until) {
            ::kill(*process, SIGKILL);
            (void)ended(*process);
            if (progress.cancelled()) return cancelled();
            return failure("{}: took longer than {:g} s", name, limit_s);
        }
        std::array<pollfd, 2> files{{{output->read.number(), POLLIN, 0}, {errors->read.number(), POLLIN, 0}}};
        constexpr int look_every_ms = 100;
        if (::poll(files.data(), files.size(), look_every_ms) <= 0) continue;
        if (files[0].revents != 0) take(output->read, outcome.output);
        if (files[1].revents != 0) take(errors->read, outcome.errors);
    }
    outcome.status = ended(*process);
    return outcome;
}

}  // namespace pliant::study
