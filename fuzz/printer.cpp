#include "printing/machine/printer.hpp"

#include "input.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    (void)pliant::machine::parse_printer(as_text(data, size), "fuzz.toml");
    return 0;
}
