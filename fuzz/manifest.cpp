#include "printing/job/manifest.hpp"

#include "input.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    (void)pliant::job::manifest_from_json(as_text(data, size), "fuzz.json");
    return 0;
}
