#include "printing/operate/layer_command.hpp"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>  // environ

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>
#include <vector>

namespace pliant::operate {
namespace {

/// Starts `sh -c text` in a process group of its own, so that it can be killed with all its child processes.
Result<pid_t> start_shell(std::string text, std::vector<char*> environment) {
    std::string shell = "sh", option = "-c";
    std::array<char*, 4> arguments{shell.data(), option.data(), text.data(), nullptr};
    posix_spawnattr_t attributes;
    ::posix_spawnattr_init(&attributes);
    ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    ::posix_spawnattr_setpgroup(&attributes, 0);
    pid_t process = 0;
    const int error = ::posix_spawn(&process, "/bin/sh", nullptr, &attributes, arguments.data(), environment.data());
    ::posix_spawnattr_destroy(&attributes);
    if (error != 0) return failure("{}: {}", text, std::strerror(error));
    return process;
}

}  // namespace

Status run_layer_command(const std::string& command, int layer, double most_s) {
    constexpr useconds_t look_every_us = 10000;
    std::string name = fmt::format("PLIANT_LAYER={}", layer);
    std::vector<char*> environment;
    for (char** entry = environ; *entry != nullptr; ++entry) environment.push_back(*entry);
    environment.push_back(name.data());
    environment.push_back(nullptr);
    const Result<pid_t> process = start_shell(command, std::move(environment));
    if (!process) return tl::unexpected(process.error());
    int status = 0;
    for (double waited_s = 0; ::waitpid(*process, &status, WNOHANG) == 0; waited_s += look_every_us * 1e-6) {
        if (waited_s > most_s) {
            ::kill(-*process, SIGKILL);
            ::waitpid(*process, &status, 0);
            return failure("{}: took over {:g} s and was ended", command, most_s);
        }
        ::usleep(look_every_us);
    }
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return {};
    return failure("{}: failed on layer {}", command, layer + 1);
}

}  // namespace pliant::operate
