// Model parts of 3MF files: properties, objects, components, slice stacks.
#include "geometry/threemf/read_3mf.hpp"
#include "input.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    (void)pliant::threemf::parse_3mf_model(std::string(as_text(data, size)), "fuzz.model");
    return 0;
}
