#include "printing/operate/process_guard.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>

#include "base/core/boot_name.hpp"

namespace pliant::operate {
namespace {

struct Message {
    GuardWord word = GuardWord::farewell;
    long light = 0;
    double at_s = 0;
};

/// The last exposure reported to the guard.
struct LastLight {
    long number = 0;  ///< 0: none yet
    GuardWord word = GuardWord::dark;
    double lit_at_s = 0;
    double on_s = 0;
};

double monotonic_s() {
    timespec now{};
    ::clock_gettime(CLOCK_MONOTONIC, &now);
    return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9;
}

double now_of(const ProcessGuard::Options& options) {
    return options.clock != nullptr ? options.clock->now() : monotonic_s() * options.clock_speed;
}

/// The guard's actions when the host has died. The image is removed first.
void host_died(const ProcessGuard::Options& options, const std::string& boot, const LastLight& last) {
    double on_s = last.on_s;
    if (last.word == GuardWord::lit) {
        if (!options.shown.empty()) ::unlink(options.shown.c_str());
        on_s = now_of(options) - last.lit_at_s;
    }
    if (last.number == 0 || boot.empty()) return;  // without the boot nobody could believe the times
    std::array<char, 160> line{};
    const int length = std::snprintf(line.data(), line.size(), "%s %ld on %.6f\n", boot.c_str(), last.number, on_s);
    const int file = ::open(options.witness.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
    if (file < 0) return;
    if (::write(file, line.data(), static_cast<std::size_t>(length)) == length) ::fsync(file);
    ::close(file);
}

/// The guard must not keep open what this program has open (sockets, the journal, other guards' pipes).
void close_all_but(int kept) {
    if (kept > 3) ::close_range(3, static_cast<unsigned>(kept) - 1, 0);
    ::close_range(static_cast<unsigned>(kept) + 1, ~0U, 0);
}

/// The main loop of the guard. It must not wait for locks: those of other threads stay locked in this process.
[[noreturn]] void stand_guard(int line, const ProcessGuard::Options& options, const std::string& boot) {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) std::signal(signal, SIG_IGN);
    ::setsid();
    LastLight last;
    for (;;) {
        Message message;
        const ssize_t got = ::read(line, &message, sizeof message);
        if (got < 0 && errno == EINTR) continue;
        if (got != sizeof message) break;
        if (message.word == GuardWord::farewell) ::_exit(0);
        last.word = message.word;
        if (message.word == GuardWord::announced) last.number = message.light, last.on_s = 0;
        if (message.word == GuardWord::lit) last.lit_at_s = message.at_s;
        if (message.word == GuardWord::dark) last.on_s = message.at_s - last.lit_at_s;
    }
    host_died(options, boot, last);
    ::_exit(0);
}

}  // namespace

Result<ProcessGuard> ProcessGuard::start(const Options& options) {
    std::array<int, 2> ends{};
    if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0)
        return failure("no guard: {}", std::strerror(errno));
    const FileHandle theirs(ends[0]);
    FileHandle ours(ends[1]);
    const std::string boot = boot_name().value_or("");
    const pid_t process = ::fork();
    if (process < 0) return failure("no guard: {}", std::strerror(errno));
    if (process == 0) {
        close_all_but(theirs.number());
        stand_guard(theirs.number(), options, boot);
    }
    return ProcessGuard(std::move(ours), process, options);
}

ProcessGuard::~ProcessGuard() {
    if (!line_.is_open()) return;
    (void)tell(GuardWord::farewell);
    line_.close();
    ::waitpid(process_, nullptr, 0);
}

/// Each message arrives whole or not at all, and none raises SIGPIPE: the print goes on without a guard that has ended.
Status ProcessGuard::tell(GuardWord word, long light, double at_s) const {
    const Message message{word, light, at_s};
    ssize_t put = 0;
    do {
        put = ::send(line_.number(), &message, sizeof message, MSG_NOSIGNAL);
    } while (put < 0 && errno == EINTR);
    if (put == sizeof message) return {};
    return failure("the guard process has ended ({}): if this program dies now, nothing turns the light off",
                   std::strerror(errno));
}

Status ProcessGuard::announced(long light) {
    return tell(GuardWord::announced, light);
}

void ProcessGuard::lit(double now_s) {
    (void)tell(GuardWord::lit, 0, now_s);
}

void ProcessGuard::dark(double now_s) {
    (void)tell(GuardWord::dark, 0, now_s);
}

std::optional<double> ProcessGuard::lit_s(long light) {
    const std::optional<std::string> boot = boot_name();
    if (!boot) return std::nullopt;
    std::ifstream file(options_.witness);
    std::optional<double> found;
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        std::string when_booted, word;
        long seen = 0;
        double on_s = 0;
        const bool whole = words >> when_booted >> seen >> word >> on_s && word == "on";
        if (whole && when_booted == *boot && seen == light) found = on_s;
    }
    return found;
}

void ProcessGuard::forget() {
    ::unlink(options_.witness.c_str());
}

}  // namespace pliant::operate
