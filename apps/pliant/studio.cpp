// pliant studio: the web interface in which a robot is simulated live, sliced and printed.
#include <fmt/core.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <future>
#include <nlohmann/json.hpp>
#include <thread>

#include "../usage.hpp"
#include "base/core/process.hpp"
#include "command.hpp"
#include "inputs.hpp"
#include "printed.hpp"
#include "studio/base/access.hpp"
#include "studio/base/token_file.hpp"
#include "studio/server/server.hpp"

namespace pliant::app {
namespace {

constexpr int usual_port = 7117;

struct StudioOptions {
    std::string file;
    int port = -1;  ///< -1: the default one, or any free one if that is taken
    std::string address = "127.0.0.1";
    std::string token_file;
    std::string notify, webcam;
    bool open = false;
    Output output;
};

/// A requested port is used as given; otherwise the default one or, if that is taken, any free one.
Result<std::unique_ptr<studio::Server>> start(studio::Studio& studio, const StudioOptions& options,
                                              studio::ServerSettings settings) {
    settings.port = options.port >= 0 ? options.port : usual_port;
    auto server = studio::Server::start(studio, settings);
    if (server || options.port >= 0) return server;
    settings.port = 0;
    return studio::Server::start(studio, settings);
}

void wait_for_interrupt(const sigset_t& signals) {
    int signal = 0;
    sigwait(&signals, &signal);
}

/// The host part of the address: the computer's name if bound to all of its addresses.
std::string host_of(const std::string& address) {
    std::array<char, 256> name{};
    if ((address == "0.0.0.0" || address == "::") && ::gethostname(name.data(), name.size() - 1) == 0)
        return name.data();
    return address.find(':') == std::string::npos ? address : "[" + address + "]";
}

/// A token generated for this run is printed as part of the address; one from a file is not, because others might read
/// it.
void tell(const StudioOptions& options, const std::string& address) {
    if (options.output.json) {
        print_json(nlohmann::json{{"address", address}}, -1);
    } else if (options.output.quiet) {
        fmt::print("{}\n", address);
    } else {
        fmt::print("Pliant studio: {}\n", address);
        if (!options.token_file.empty())
            fmt::print("The token is in {}: add ?token=TOKEN to the address.\n", options.token_file);
        fmt::print("Ctrl-C ends it.\n");
    }
    std::fflush(stdout);
}

/// Opens the desktop's browser. If there is none, the address has been printed.
void open_browser(const std::string& address) {
    const Result<pid_t> browser = start_process("/usr/bin/env", {"xdg-open", address}, {});
    if (browser) std::thread([process = *browser] { ::waitpid(process, nullptr, 0); }).detach();
}

Result<std::string> choose_token(const StudioOptions& options) {
    if (!options.token_file.empty()) return studio::read_or_make_token(options.token_file);
    return studio::is_loopback(options.address) ? "" : studio::random_key();
}

Result<int> run_studio(const StudioOptions& options) {
    if (!options.webcam.empty() && studio::origin_of(options.webcam).empty())
        return input_error("--webcam {}: an address is needed, as in http://camera:8080/stream", options.webcam);
    if (kind_of(options.file) == FileKind::geometry)
        return input_error("{}: is geometry; start pliant studio without it, and drop it onto the page", options.file);
    // Blocked before any thread is created, so that all threads leave them to sigwait.
    sigset_t signals;
    sigemptyset(&signals);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&signals, signal);
    pthread_sigmask(SIG_BLOCK, &signals, nullptr);

    Result<std::unique_ptr<studio::Studio>> studio =
        studio::Studio::open({options.file, PLIANT_VERSION, options.notify, options.webcam});
    if (!studio) return tl::unexpected(studio.error());
    // What a page shows first is drawn before its address is told, while no browser wants the same processors.
    std::promise<void> light;
    const std::jthread ahead([&studio, &light](const std::stop_token& stop) {
        (void)(*studio)->first_picture(false, stop);
        light.set_value();
        (void)(*studio)->first_picture(true, stop);
    });
    (void)light.get_future().wait_for(std::chrono::milliseconds(500));
    const Result<std::string> token = choose_token(options);
    if (!token) return tl::unexpected(token.error());
    std::error_code error;
    const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
    const auto server =
        start(**studio, options, {options.address, 0, *token, !options.token_file.empty(), program.parent_path()});
    if (!server) return tl::unexpected(server.error());
    const std::string address = fmt::format("http://{}:{}/", host_of(options.address), (*server)->port());
    const std::string with_token = token->empty() ? address : address + "?token=" + *token;
    tell(options, options.token_file.empty() ? with_token : address);
    if (options.open) open_browser(with_token);
    wait_for_interrupt(signals);
    return exit_done;
}

}  // namespace

void add_studio(CLI::App& app, int& status) {
    auto options = std::make_shared<StudioOptions>();
    CLI::App* command = app.add_subcommand("studio", "web interface: simulate a robot live, slice it and print it");
    command->add_option("file", options->file, "robot file (TOML) or job (.zip); without it an example");
    command->add_option("--port", options->port, "port to listen on; 0: any (7117, or any if that is taken)")
        ->check(between(0, 65535));
    command->add_option("--bind", options->address,
                        "address to listen on; any but loopback needs the token that is printed");
    command->add_option("--token-file", options->token_file,
                        "file with the token that pages need; made with a random one where there is none");
    command->add_option(
        "--notify", options->notify,
        "command for the shell when a print has ended or waits for you: PLIANT_EVENT (finished, failed, "
        "stopped, waiting), PLIANT_TEXT, PLIANT_JOB");
    command->add_option("--webcam", options->webcam,
                        "address of a picture or MJPEG stream of the machine, as in http://camera:8080/stream");
    command->add_flag("--open", options->open, "open the page in the browser of the desktop");
    add_output_options(*command, options->output, true);
    command->footer("Example: pliant studio examples/cable_gripper/gripper.toml");
    on_call(*command, status, [options] { return run_studio(*options); });
}

}  // namespace pliant::app
