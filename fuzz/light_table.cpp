#include "input.hpp"
#include "printing/host/projector_patterns.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto table = pliant::host::parse_light_table(as_text(data, size), "fuzz.txt");
    if (table) (void)pliant::host::light_mask(*table, 7, 5, 1);
    return 0;
}
