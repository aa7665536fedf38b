// Surfaces of every format: STL, OBJ, PLY.
#include "input.hpp"
#include "mesh/surface_check.hpp"
#include "mesh/surface_file.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto surface = pliant::mesh::parse_surface(as_text(data, size), "fuzz.surface");
    if (surface) (void)pliant::mesh::check_closed(surface->mesh);
    return 0;
}
