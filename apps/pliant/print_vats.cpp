#include "print_vats.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <cstdio>
#include <iostream>

namespace pliant::app {

void show_vats(const plan::Plan& plan, const std::vector<std::string>& warnings, const Output& output) {
    if (output.quiet) return;
    for (const std::string& warning : warnings) fmt::print(stderr, "warning: {}\n", warning);
    for (const std::string& line : plan::vat_lines(plan)) fmt::print(stderr, "{}\n", line);
}

Status ask_for_vats(const Output& output) {
    if (output.quiet || isatty(STDIN_FILENO) != 1 || isatty(STDERR_FILENO) != 1) return {};
    fmt::print(stderr, "Are these vats in their slots and filled? [y/N] ");
    std::fflush(stderr);
    std::string answer;
    std::getline(std::cin, answer);
    if (answer == "y" || answer == "Y" || answer == "yes") return {};
    return failure("not printed: fill the vats and answer y, or give --yes");
}

}  // namespace pliant::app
