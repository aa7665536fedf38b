// Single lines of G-code, and the host's directives in its comments.
#include "printing/machine/gcode.hpp"

#include "input.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view line = as_text(data, size);
    (void)pliant::machine::parse_command(line);
    if (pliant::machine::is_directive(line)) (void)pliant::machine::parse_directive(line);
    return 0;
}
