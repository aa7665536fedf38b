// The option -o of commands that write only where it is given.
#pragma once

#include <CLI/App.hpp>
#include <string>

namespace pliant::app {

/// An empty name, as of a variable of a shell that is not set, is an error: it would mean "write nothing".
inline CLI::Option* add_output_path(CLI::App& command, std::string& path, const std::string& description) {
    return command.add_option("-o,--output", path, description)
        ->check(CLI::Validator(
            [](const std::string& given) {
                return given.empty() ? std::string("the name is empty; name where to write") : std::string();
            },
            ""));
}

}  // namespace pliant::app
