// Whole 3MF files: entries of the zip file, relationships, and models that reference each other.
#include "file.hpp"
#include "geometry/threemf/read_3mf.hpp"
#include "input.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const TemporaryFile file(as_text(data, size), ".3mf");
    (void)pliant::threemf::read_3mf(file.path());
    return 0;
}
