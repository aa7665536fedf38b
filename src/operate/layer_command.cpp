#include "operate/layer_command.hpp"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>  // environ

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <vector>

namespace pliant::operate {

Status run_layer_command(const std::string& command, int layer, double most_s) {
    constexpr useconds_t look_every_us = 10000;
    std::string name = fmt::format("PLIANT_LAYER={}", layer);
    std::vector<char*> environment;
    for (char** entry = environ; *entry != nullptr; ++entry) environment.push_back(*entry);
    environment.push_back(name.data());
    environment.push_back(nullptr);
    std::string shell = "sh", option = "-c", text = command;
    std::array<char*, 4> arguments{shell.data(), option.data(), text.data(), nullptr};
    pid_t process = 0;
    const int error = ::posix_spawn(&process, "/bin/sh", nullptr, nullptr, arguments.data(), environment.data());
    if (error != 0) return failure("{}: {}", command, std::strerror(error));
    int status = 0;
    for (double waited_s = 0; ::waitpid(process, &status, WNOHANG) == 0; waited_s += look_every_us * 1e-6) {
        if (waited_s > most_s) {
            ::kill(process, SIGKILL);
            ::waitpid(process, &status, 0);
            return failure("{}: took over {:g} s and was ended", command, most_s);
        }
        ::usleep(look_every_us);
    }
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return {};
    return failure("{}: failed on layer {}", command, layer);
}

}  // namespace pliant::operate
