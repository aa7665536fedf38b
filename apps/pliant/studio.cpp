// pliant studio: the web interface in which a robot is simulated live, sliced and printed.
#include <fmt/core.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>

#include "command.hpp"
#include "presentation/studio/access.hpp"
#include "presentation/studio/server.hpp"

namespace pliant::app {
namespace {

constexpr int usual_port = 7117;

struct Options {
    std::string file;
    int port = -1;  ///< -1: the usual one, or any if that is taken
    std::string address = "127.0.0.1";
    Output output;
};

/// A port that was asked for is that port; else the usual one or, if that is taken, any.
Result<std::unique_ptr<studio::Server>> start(studio::Studio& studio, const Options& options,
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

Result<int> run_studio(const Options& options) {
    // Blocked before any thread is made, so that every thread leaves them to sigwait.
    sigset_t signals;
    sigemptyset(&signals);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&signals, signal);
    pthread_sigmask(SIG_BLOCK, &signals, nullptr);

    Result<std::unique_ptr<studio::Studio>> studio = studio::Studio::open({options.file, PLIANT_VERSION});
    if (!studio) return tl::unexpected(studio.error());
    studio::ServerSettings settings{options.address, 0, ""};
    if (!studio::is_loopback(options.address)) settings.token = studio::random_key();
    const auto server = start(**studio, options, settings);
    if (!server) return tl::unexpected(server.error());
    const std::string host =
        options.address.find(':') == std::string::npos ? options.address : "[" + options.address + "]";
    const std::string address = fmt::format("http://{}:{}/{}", host, (*server)->port(),
                                            settings.token.empty() ? "" : "?token=" + settings.token);
    if (options.output.quiet)
        fmt::print("{}\n", address);
    else
        fmt::print("Pliant studio: {}\nCtrl-C ends it.\n", address);
    std::fflush(stdout);
    wait_for_interrupt(signals);
    return exit_done;
}

}  // namespace

void add_studio(CLI::App& app, int& status) {
    auto options = std::make_shared<Options>();
    CLI::App* command = app.add_subcommand("studio", "web interface: simulate a robot live, slice it and print it");
    command->add_option("file", options->file, "robot file (TOML) or job (.zip); without it an example");
    command->add_option("--port", options->port, "port to listen on; 0: any (7117, or any if that is taken)")
        ->check(CLI::Range(0, 65535));
    command->add_option("--bind", options->address,
                        "address to listen on; any but loopback needs the token that is printed");
    add_output_options(*command, options->output, false);
    command->footer("Example: pliant studio examples/cable_gripper/gripper.toml");
    on_call(*command, status, [options] { return run_studio(*options); });
}

}  // namespace pliant::app
