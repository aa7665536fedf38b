// Tet meshes for the tests of this module.
#pragma once

#include <string>

#include "geometry/mesh/tet_mesh.hpp"

namespace pliant::mesh::test {

/// Two tets that share the face (1, 2, 3), in a region each; they fill 1/6 and 1/3 of the unit cube.
inline TetMesh two_tets(const std::string& first = "a", const std::string& second = "b") {
    TetMesh mesh;
    mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
    mesh.nodes = {0, 1, 2, 3, 1, 2, 3, 4};
    mesh.region = {0, 1};
    mesh.region_names = {first, second};
    return mesh;
}

}  // namespace pliant::mesh::test
