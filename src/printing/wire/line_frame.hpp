// Formats a command for the wire: numbered and with checksum.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>

namespace pliant::host {

/// A line with a line end before and after it. If the only line end between two lines were lost or damaged, they would
/// merge into one, and one in 256 of such passes the checksum; empty lines are harmless.
inline std::string framed_line(long number, std::string_view command) {
    const std::string line = fmt::format("N{} {}", number, command);
    int sum = 0;
    for (const char c : line) sum ^= static_cast<unsigned char>(c);
    return fmt::format("\n{}*{}\n", line, sum);
}

}  // namespace pliant::host
