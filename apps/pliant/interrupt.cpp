#include "interrupt.hpp"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <ctime>
#include <string_view>

#include "base/core/files.hpp"

namespace pliant::app {
namespace {

constexpr std::int64_t passed_on_ms = 30;

// A signal handler can only access globals.
std::atomic<OnSignal> reaction = OnSignal::end;
std::atomic<std::int64_t> first_ms = 0;  // 0: there was none
std::atomic<bool> again = false, key_again = false;
std::atomic<pid_t> owner = 0;
std::atomic<bool> on_terminal = false;
std::atomic<bool> in_json = false;
static_assert(std::atomic<std::int64_t>::is_always_lock_free && std::atomic<OnSignal>::is_always_lock_free);

std::int64_t monotonic_ms() {
    timespec now{};
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return std::int64_t{1000} * now.tv_sec + now.tv_nsec / 1'000'000 + 1;
}

/// Async-signal-safe.
[[noreturn]] void leave() {
    const std::string_view line = on_terminal ? "\r\033[Kcancelled\n" : "cancelled\n";  // erases a progress bar
    (void)!::write(STDERR_FILENO, line.data(), line.size());
    constexpr std::string_view json = "{\"error\":\"cancelled\"}\n";  // as report() prints it
    if (in_json) (void)!::write(STDOUT_FILENO, json.data(), json.size());
    ::_exit(1);
}

void handle(int signal) {
    const OnSignal what = reaction;
    if (::getpid() != owner) {  // a child process that tests a STEP file: its parent prints the message
        if (what == OnSignal::leave) ::_exit(1);
        return;
    }
    const int error = errno;
    std::int64_t first = 0;
    const std::int64_t now = monotonic_ms();
    const bool is_first = first_ms.compare_exchange_strong(first, now);
    if (what == OnSignal::leave) leave();
    if (!is_first && now - first > passed_on_ms) {
        if (what == OnSignal::ask) leave();
        again = true;
        if (signal == SIGINT) key_again = true;
    }
    errno = error;
}

/// SIGHUP: the terminal is gone. nohup asks to go on then.
bool is_ignored(int signal) {
    struct sigaction now {};
    return ::sigaction(signal, nullptr, &now) == 0 && now.sa_handler == SIG_IGN;
}

}  // namespace

void on_signal(OnSignal what) {
    owner = ::getpid();
    on_terminal = ::isatty(STDERR_FILENO) == 1;
    reaction = what;
    for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, what == OnSignal::end ? SIG_DFL : handle);
    if (!is_ignored(SIGHUP)) std::signal(SIGHUP, what == OnSignal::end ? SIG_DFL : handle);
    if (what == OnSignal::leave && interrupted()) leave();
}

void tell_cancelled_in_json() {
    in_json = true;
}

Status write_file_and_leave(const std::filesystem::path& path, std::string_view bytes) {
    on_signal(OnSignal::ask_twice);
    Status written = write_file(path, bytes);
    on_signal(OnSignal::leave);
    return written;
}

bool interrupted() {
    return first_ms != 0;
}

bool interrupted_again() {
    return again;
}

bool pressed_again() {
    return key_again;
}

}  // namespace pliant::app
