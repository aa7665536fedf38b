#include "printing/screen/projector.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <thread>
#include <utility>

#include "base/core/file_handle.hpp"
#include "base/core/parse_all.hpp"
#include "base/core/process.hpp"

namespace pliant::host {
namespace {

constexpr double answer_s = 5;
constexpr double start_s = 15;

std::filesystem::path screen_program(const std::filesystem::path& given) {
    if (!given.empty()) return given;
    std::error_code error;
    return std::filesystem::read_symlink("/proc/self/exe", error).parent_path() / "pliant-screen";
}

/// A running program and its output.
struct Speaker {
    pid_t process = -1;
    FileHandle output;
};

/// In a session of its own, so that a key that ends the host does not end the program.
Result<Speaker> start(const std::filesystem::path& program, const std::vector<std::string>& words) {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) return failure("no pipe: {}", std::strerror(errno));
    FileHandle output(ends[0]);
    const FileHandle theirs(ends[1]);
    const Result<pid_t> process = start_process(program, words, {.output = theirs.number()});
    if (!process) return tl::unexpected(process.error());
    return Speaker{*process, std::move(output)};
}

/// Reads a program's output until it closes it or, with `line_is_enough`, until the first line. A program that is
/// silent for too long is ended.
std::string hear(const Speaker& speaker, bool line_is_enough) {
    const int file = speaker.output.number();
    std::string heard;
    for (;;) {
        pollfd wait{file, POLLIN, 0};
        const int ready = ::poll(&wait, 1, static_cast<int>(start_s * 1000));
        if (ready < 0 && errno == EINTR) continue;
        if (ready == 0) ::kill(speaker.process, SIGKILL);
        std::array<char, 1024> bytes;
        const ssize_t got = ready > 0 ? ::read(file, bytes.data(), bytes.size()) : 0;
        if (got <= 0) return heard;
        heard.append(bytes.data(), static_cast<std::size_t>(got));
        if (line_is_enough && heard.find('\n') != std::string::npos) return heard;
    }
}

/// A child process that is not waited for would remain a zombie as long as the host lives.
void reap_later(pid_t process) {
    std::thread([process] { ::waitpid(process, nullptr, 0); }).detach();
}

/// Starts the holder of a panel. Returns once it listens.
Status start_screen(const std::filesystem::path& program, const std::vector<std::string>& words) {
    const Result<Speaker> screen = start(program, words);
    if (!screen) return tl::unexpected(screen.error());
    std::string said = hear(*screen, true);
    reap_later(screen->process);
    while (!said.empty() && said.back() == '\n') said.pop_back();
    if (said == "ready") return {};
    return failure("{}", said.empty() ? "pliant-screen does not start" : said);
}

std::string display_socket(int number) {
    const char* display = std::getenv("DISPLAY");
    return screen_socket_name(fmt::format("display {} of {}", number, display == nullptr ? "KMSDRM" : display));
}

Result<ScreenSocket> connect_display(int number, const std::filesystem::path& program) {
    const std::string name = display_socket(number);
    if (auto socket = ScreenSocket::connect(name)) return socket;
    if (Status status = start_screen(program, {name, "display", std::to_string(number)}); !status)
        return tl::unexpected(status.error());
    return ScreenSocket::connect(name);
}

Result<ScreenSocket> connect_folder(const std::filesystem::path& folder, const ScreenOptions& options,
                                    const std::filesystem::path& program) {
    std::error_code error;
    const auto whole = std::filesystem::weakly_canonical(std::filesystem::absolute(folder), error);
    const std::string name = screen_socket_name("folder " + whole.string());
    const std::vector<std::string> words = {name, "folder", whole.string(), std::to_string(options.width_px),
                                            std::to_string(options.height_px)};
    if (Status status = start_screen(program, words); !status) return tl::unexpected(status.error());
    return ScreenSocket::connect(name);
}

}  // namespace

Result<ScreenProjector> ScreenProjector::open(const std::string& where, const ScreenOptions& options) {
    const auto program = screen_program(options.program);
    const auto number = display_number(where);
    if (!number && (options.width_px <= 0 || options.height_px <= 0))
        return input_error("projector {}: a folder needs the size of the images", where);
    const auto where_error = [&](const Error& error) {
        return tl::unexpected(Error{Cause::input, fmt::format("projector {}: {}", where, error.message)});
    };
    auto socket = number ? connect_display(*number, program) : connect_folder(where, options, program);
    if (!socket) return where_error(socket.error());
    if (Status status = socket->send({Say::hello, options.width_px, options.height_px, {}, {}}); !status)
        return where_error(status.error());
    const auto answer = socket->receive(answer_s);
    if (!answer) return where_error(answer.error());
    if (answer->say != Say::ready) return where_error({Cause::input, answer->bytes});
    const double refresh_hz = answer->light.frame_s > 0 ? 1 / answer->light.frame_s : 0;
    PanelInfo panel{number.value_or(0), answer->bytes, answer->width_px, answer->height_px, refresh_hz};
    return ScreenProjector(std::move(*socket), std::move(panel), options.longest_light_s);
}

/// Reads messages up to the one awaited; the end of an exposure may come before it.
Status ScreenProjector::wait_for(Say wanted, double timeout_s) {
    for (;;) {
        const auto message = socket_.receive(timeout_s);
        if (!message) {
            // The holder goes black when the connection ends.
            socket_.close();
            return failure("projector: {}", message.error().message);
        }
        if (message->say == Say::refused) {
            socket_.close();
            return failure("projector: {}", message->bytes);
        }
        if (message->say == Say::ended) {
            last_light_ = message->light;
            asked_s_ = 0;
        }
        if (message->say == wanted) return {};
    }
}

Status ScreenProjector::show(const job::Image& image) {
    return show_for(image, longest_s_);
}

Status ScreenProjector::show_for(const job::Image& image, double seconds) {
    if (!socket_.is_open()) return failure("projector: its connection has ended");
    const std::size_t pixels = static_cast<std::size_t>(panel_.width_px) * static_cast<std::size_t>(panel_.height_px);
    if (image.width_px != panel_.width_px || image.height_px != panel_.height_px || image.pixels.size() != pixels) {
        return input_error(
            "projector: an image of {} x {} px on a panel of {} x {} px: exact pixels need the same size",
            image.width_px, image.height_px, panel_.width_px, panel_.height_px);
    }
    if (!(seconds > 0)) return input_error("projector: a light of {:g} s", seconds);
    Message message{Say::light, image.width_px, image.height_px, {}, {}};
    message.light.asked_s = std::min(seconds, longest_s_);
    message.bytes.assign(reinterpret_cast<const char*>(image.pixels.data()), image.pixels.size());
    if (Status status = socket_.send(message); !status) {
        socket_.close();
        return failure("projector: {}", status.error().message);
    }
    if (Status status = wait_for(Say::lit, answer_s); !status) return status;
    asked_s_ = message.light.asked_s;
    return {};
}

Status ScreenProjector::black() {
    if (!socket_.is_open()) return failure("projector: its connection has ended");
    if (Status status = socket_.send({Say::dark, 0, 0, {}, {}}); !status) {
        socket_.close();
        return failure("projector: {}", status.error().message);
    }
    return wait_for(Say::is_dark, answer_s);
}

Result<std::optional<Light>> ScreenProjector::finish() {
    if (asked_s_ > 0) {
        if (Status status = wait_for(Say::ended, asked_s_ + answer_s); !status) return tl::unexpected(status.error());
    }
    return last_light_;
}

Result<std::vector<PanelInfo>> list_displays(const std::filesystem::path& program) {
    const Result<Speaker> lister = start(screen_program(program), {"--list"});
    if (!lister) return tl::unexpected(lister.error());
    std::string said = hear(*lister, false);
    int how = 0;
    ::waitpid(lister->process, &how, 0);
    if (WIFSIGNALED(how)) return failure("pliant-screen does not answer");
    if (!WIFEXITED(how) || WEXITSTATUS(how) != 0) return failure("{}", said.substr(0, said.find('\n')));
    std::vector<PanelInfo> panels;
    while (!said.empty()) {
        const std::string line = said.substr(0, said.find('\n'));
        said.erase(0, line.size() + 1);
        PanelInfo panel;
        int name_at = 0;
        if (std::sscanf(line.c_str(), "%d\t%d\t%d\t%lf\t%n", &panel.number, &panel.width_px, &panel.height_px,
                        &panel.refresh_hz, &name_at) < 4)
            continue;
        panel.name = line.substr(static_cast<std::size_t>(name_at));
        panels.push_back(panel);
    }
    return panels;
}

std::optional<int> display_number(const std::string& where) {
    int number = -1;
    return parse_all(where, number) && number >= 0 ? std::optional(number) : std::nullopt;
}

Result<bool> release_display(int display) {
    const auto socket = ScreenSocket::connect(display_socket(display));
    if (!socket) return false;
    if (Status status = socket->send({Say::leave, 0, 0, {}, {}}); !status) return tl::unexpected(status.error());
    const auto answer = socket->receive(answer_s);
    if (!answer) return tl::unexpected(answer.error());
    if (answer->say == Say::refused) return failure("display {}: {}", display, answer->bytes);
    (void)socket->receive(answer_s);  // the end of the connection
    return true;
}

}  // namespace pliant::host
