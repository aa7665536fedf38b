// pliant-screen: holds a panel for a host, which starts it and reads its standard output.
//
//     pliant-screen --list
//     pliant-screen NAME display NUMBER
//     pliant-screen NAME folder DIR WIDTH HEIGHT
//
// NAME is that of the socket it serves. The light is controlled by a separate process, so that it ends when the host
// does, however that ends. If that process itself dies, its parent starts another one.
#include <fmt/core.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "printing/screen/frame_folder.hpp"
#include "printing/screen/screen_sdl.hpp"
#include "printing/screen/screen_server.hpp"

namespace pliant::host {
namespace {

// A signal handler can access only globals.
volatile sig_atomic_t asked_to_stop = 0;
volatile sig_atomic_t server_process = 0;
volatile int* in_good_order = nullptr;  ///< shared by both processes: the panel has been released

void on_stop(int) {
    asked_to_stop = 1;
    if (server_process > 0) ::kill(server_process, SIGTERM);
}

struct Wanted {
    std::string name;
    bool folder = false;
    std::string place;  ///< number of a display, or path of a folder
    int width_px = 0, height_px = 0;
};

/// The host waits for one line: "ready", or an error. Later lines are dropped.
void answer_host(const std::string& line) {
    fmt::print("{}\n", line);
    std::fflush(stdout);
    if (std::freopen("/dev/null", "w", stdout) == nullptr) std::fclose(stdout);
}

/// Retries, because the screen of a host that has just ended takes a moment to release its name.
Result<ScreenSocket> listen_patiently(const std::string& name) {
    constexpr int tries = 40;
    auto listener = ScreenSocket::listen(name);
    for (int k = 1; k < tries && !listener && asked_to_stop == 0; ++k) {
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
        listener = ScreenSocket::listen(name);
    }
    return listener;
}

Status serve(Panel& panel, const Wanted& wanted, const std::string& driver, bool again) {
    auto listener = listen_patiently(wanted.name);
    if (!listener) return failure("another program is using this panel ({})", listener.error().message);
    ScreenServerOptions options;
    options.once = wanted.folder;
    options.first_host_s = again ? 0 : 10;
    options.driver = driver;
    options.stop = [] { return asked_to_stop != 0; };
    if (!again) answer_host("ready");
    Status status = serve_screen(panel, *listener, options);
    if (status) *in_good_order = 1;
    return status;
}

Status serve_folder(const Wanted& wanted, bool again) {
    auto folder = FrameFolder::open(wanted.place, wanted.width_px, wanted.height_px);
    if (!folder) return tl::unexpected(folder.error());
    return serve(*folder, wanted, "folder", again);
}

Status serve_display(const Wanted& wanted, bool again) {
    const auto video = SdlVideo::open();
    if (!video) return tl::unexpected(video.error());
    const auto panel = video->open_panel(std::atoi(wanted.place.c_str()));
    if (!panel) return tl::unexpected(panel.error());
    return serve(**panel, wanted, video->driver(), again);
}

/// Exit status of the process that holds the panel: 0 if it released it properly, 1 if it never had it.
int server(const Wanted& wanted, bool again) {
    const Status status = wanted.folder ? serve_folder(wanted, again) : serve_display(wanted, again);
    if (status) return 0;
    if (!again) answer_host(status.error().message);
    return 1;
}

/// Keeps a server running until it ends properly or could not start.
int supervise(const Wanted& wanted) {
    constexpr int most_restarts = 20;
    void* shared = ::mmap(nullptr, sizeof(int), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (shared == MAP_FAILED) return 1;
    in_good_order = static_cast<volatile int*>(shared);
    for (int start = 0; start < most_restarts && asked_to_stop == 0; ++start) {
        const pid_t process = ::fork();
        if (process < 0) return 1;
        if (process == 0) {
            server_process = 0;
            std::exit(server(wanted, start > 0));
        }
        server_process = process;
        // Only the server may keep the pipe to the host open.
        if (start == 0 && std::freopen("/dev/null", "w", stdout) == nullptr) std::fclose(stdout);
        int how = 0;
        while (::waitpid(process, &how, 0) < 0 && errno == EINTR) continue;
        // After a proper end, later failures (such as a display disconnected meanwhile) restart nothing.
        if (*in_good_order != 0) return 0;
        if (start == 0 && WIFEXITED(how)) return WEXITSTATUS(how);
        if (start > 0) ::usleep(100000);
    }
    return 1;
}

int list() {
    const auto video = SdlVideo::open();
    if (!video) {
        fmt::print("{}\n", video.error().message);
        return 1;
    }
    for (const Display& d : video->displays())
        fmt::print("{}\t{}\t{}\t{:g}\t{}\n", d.number, d.width_px, d.height_px, d.refresh_hz, d.name);
    return 0;
}

int run(const std::vector<std::string>& words) {
    if (words.size() == 1 && words[0] == "--list") return list();
    const bool display = words.size() == 3 && words[1] == "display";
    const bool folder = words.size() == 5 && words[1] == "folder";
    if (!display && !folder) {
        fmt::print("pliant-screen is started by pliant: see pliant project --help\n");
        return 2;
    }
    Wanted wanted{words[0], folder, words[2], 0, 0};
    if (folder) {
        wanted.width_px = std::atoi(words[3].c_str());
        wanted.height_px = std::atoi(words[4].c_str());
    }
    struct sigaction action {};
    action.sa_handler = on_stop;
    for (const int signal : {SIGTERM, SIGINT, SIGHUP}) ::sigaction(signal, &action, nullptr);
    ::signal(SIGPIPE, SIG_IGN);
    return supervise(wanted);
}

}  // namespace
}  // namespace pliant::host

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    return pliant::host::run({argv + 1, argv + argc});
}
