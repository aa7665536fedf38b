// Files of surfaces, for the tests of this module.
#pragma once

#include <doctest/doctest.h>

#include <string>
#include <string_view>

#include "base/core/files.hpp"
#include "base/core/test_folder.hpp"
#include "geometry/files/surface_file.hpp"

namespace pliant::mesh::test {

/// What `write_stl` writes.
inline std::string binary_stl(const TriMesh& mesh) {
    const pliant::test::Folder folder("stl");
    REQUIRE(write_stl(folder / "a.stl", mesh));
    return read_file(folder / "a.stl").value();
}

/// Why a file "a" of these bytes is refused; "" if it is read.
inline std::string surface_problem(std::string_view bytes) {
    const Result<SurfaceFile> file = parse_surface(bytes, "a");
    return file ? "" : file.error().message;
}

}  // namespace pliant::mesh::test
