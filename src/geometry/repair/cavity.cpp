#include "geometry/repair/cavity.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "base/core/disjoint_sets.hpp"
#include "geometry/repair/surface_shells.hpp"

namespace pliant::mesh {
namespace {

/// Sets of faces connected by edges: (faces) the first face of each face's set.
std::vector<int> components(const std::vector<Face>& faces) {
    struct Edge {
        int low, high, face;
        bool operator<(const Edge& o) const { return std::tie(low, high, face) < std::tie(o.low, o.high, o.face); }
    };
    std::vector<Edge> edges;
    for (std::size_t f = 0; f < faces.size(); ++f) {
        for (std::size_t k = 0; k < 3; ++k) {
            const auto [low, high] = std::minmax(faces[f].nodes[k], faces[f].nodes[(k + 1) % 3]);
            edges.push_back({low, high, static_cast<int>(f)});
        }
    }
    std::sort(edges.begin(), edges.end());
    DisjointSets sets(faces.size());
    for (std::size_t e = 1; e < edges.size(); ++e) {
        if (edges[e].low == edges[e - 1].low && edges[e].high == edges[e - 1].high)
            sets.join(edges[e].face, edges[e - 1].face);
    }
    std::vector<int> first(faces.size());
    for (std::size_t f = 0; f < faces.size(); ++f) first[f] = sets.find(static_cast<int>(f));
    return first;
}

TriMesh surface_of(const TetMesh& mesh, const std::vector<Face>& faces, const std::vector<int>& component, int wanted) {
    TriMesh surface{mesh.points, {}};
    for (std::size_t f = 0; f < faces.size(); ++f) {
        if (component[f] == wanted)
            surface.triangles.push_back({faces[f].nodes[0], faces[f].nodes[1], faces[f].nodes[2]});
    }
    return surface;
}

}  // namespace

Result<std::vector<Face>> cavity_faces(const TetMesh& mesh, const Vec3& point) {
    const std::vector<Face> faces = boundary_faces(mesh);
    const std::vector<int> component = components(faces);
    int nearest = -1;
    double least = std::numeric_limits<double>::infinity();
    double winding = 0;
    for (std::size_t f = 0; f < faces.size(); ++f) {
        if (component[f] != static_cast<int>(f)) continue;
        const TriMesh surface = surface_of(mesh, faces, component, static_cast<int>(f));
        const double turns = winding_number(surface, point);
        winding += turns;
        const double volume = -signed_volume(surface);  // normals point out of the material, so a cavity is inside out
        if (turns > -0.5 || volume >= least) continue;
        nearest = static_cast<int>(f);
        least = volume;
    }
    if (winding > 0.5) return input_error("lies in the material");
    if (nearest < 0)
        return input_error(
            "lies in no closed cavity: the space around it is open to the outside; close each mouth with cap = SHAPE");
    std::vector<Face> wall;
    for (std::size_t f = 0; f < faces.size(); ++f) {
        if (component[f] == nearest) wall.push_back(faces[f]);
    }
    return wall;
}

}  // namespace pliant::mesh
