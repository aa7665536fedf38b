// Format detection. The readers have targets of their own.
#include "geometry/files/surface_file.hpp"
#include "geometry/files/tet_file.hpp"
#include "input.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view bytes = as_text(data, size);
    if (!pliant::mesh::looks_like_tet_mesh(bytes)) (void)pliant::mesh::looks_like_surface(bytes);
    return 0;
}
