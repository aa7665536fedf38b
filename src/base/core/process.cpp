#include "base/core/process.hpp"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace pliant {
namespace {

/// Redirections of the new process' files before the program starts.
class FileActions {
public:
    explicit FileActions(const ProcessFiles& files) {
        posix_spawn_file_actions_init(&actions_);
        put(files.input, STDIN_FILENO, O_RDONLY);
        put(files.output, STDOUT_FILENO, O_WRONLY);
        put(files.error, STDERR_FILENO, O_WRONLY);
    }
    FileActions(const FileActions&) = delete;
    FileActions& operator=(const FileActions&) = delete;
    ~FileActions() { posix_spawn_file_actions_destroy(&actions_); }

    [[nodiscard]] const posix_spawn_file_actions_t* get() const { return &actions_; }

private:
    void put(int file, int place, int flags) {
        if (file < 0)
            posix_spawn_file_actions_addopen(&actions_, place, "/dev/null", flags, 0);
        else
            posix_spawn_file_actions_adddup2(&actions_, file, place);
    }
    posix_spawn_file_actions_t actions_;
};

/// A session of its own, and no blocked signals.
class Attributes {
public:
    Attributes() {
        posix_spawnattr_init(&attributes_);
        sigset_t none;
        sigemptyset(&none);
        posix_spawnattr_setsigmask(&attributes_, &none);
        posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGMASK);
    }
    Attributes(const Attributes&) = delete;
    Attributes& operator=(const Attributes&) = delete;
    ~Attributes() { posix_spawnattr_destroy(&attributes_); }

    [[nodiscard]] const posix_spawnattr_t* get() const { return &attributes_; }

private:
    posix_spawnattr_t attributes_;
};

}  // namespace

Result<pid_t> start_process(const std::filesystem::path& program, std::vector<std::string> words,
                            const ProcessFiles& files) {
    words.insert(words.begin(), program.string());
    std::vector<char*> arguments;
    arguments.reserve(words.size() + 1);
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    pid_t process = -1;
    const int error = ::posix_spawn(&process, program.c_str(), FileActions(files).get(), Attributes().get(),
                                    arguments.data(), environ);
    if (error != 0) return failure("{}: cannot be started: {}", program.string(), std::strerror(error));
    return process;
}

std::string in_shell_quotes(std::string_view text) {
    std::string quoted = "'";
    for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return quoted + "'";
}

std::string end_text(const ProcessEnd& end) {
    if (WIFSIGNALED(end.status)) {
        const int number = WTERMSIG(end.status);
        const char* const words = ::strsignal(number);
        return fmt::format("signal {}: {}", number, words != nullptr ? words : "unknown");
    }
    return fmt::format("exit status {}", WIFEXITED(end.status) ? WEXITSTATUS(end.status) : end.status);
}

bool was_killed(const ProcessEnd& end) {
    return WIFSIGNALED(end.status) && WTERMSIG(end.status) == SIGKILL;
}

ChildProcess::ChildProcess(pid_t process) : process_(process), parent_(::getpid()) {}

bool ChildProcess::is_ours() const {
    return ::getpid() == parent_;
}

ProcessEnd ChildProcess::end() {
    if (process_ < 0 || !is_ours()) return end_;
    ::kill(process_, SIGKILL);
    rusage usage{};
    while (::wait4(process_, &end_.status, 0, &usage) < 0 && errno == EINTR) {
    }
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    end_.cpu_s = seconds(usage.ru_utime) + seconds(usage.ru_stime);
    process_ = -1;
    return end_;
}

ProcessEnd ChildProcess::let_end() {
    constexpr int looks = 100, pause_us = 10000;
    for (int look = 0; process_ >= 0 && is_ours() && look < looks; ++look) {
        siginfo_t info{};
        if (::waitid(P_PID, static_cast<id_t>(process_), &info, WEXITED | WNOHANG | WNOWAIT) != 0 || info.si_pid != 0)
            break;
        ::usleep(pause_us);
    }
    return end();
}

}  // namespace pliant
