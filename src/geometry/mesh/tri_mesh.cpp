#include "geometry/mesh/tri_mesh.hpp"

#include "base/core/boxes.hpp"

namespace pliant::mesh {

double signed_volume(const TriMesh& mesh) {
    const Vec3 origin = mesh.points.empty() ? Vec3{} : mesh.points.front();  // a point of the surface: avoids
                                                                             // cancellation far from the origin
    double sum = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
        sum += dot(mesh.points[a] - origin, cross(mesh.points[b] - origin, mesh.points[c] - origin));
    }
    return sum / 6;
}

Box3 bounds(const TriMesh& mesh) {
    const Box3 box = bounds_of(mesh.points);
    return box;
}

TriMesh scaled(TriMesh mesh, double factor) {
    for (Vec3& p : mesh.points) p *= factor;
    return mesh;
}

void append(TriMesh& surface, const TriMesh& other) {
    const int offset = static_cast<int>(surface.points.size());
    surface.points.insert(surface.points.end(), other.points.begin(), other.points.end());
    for (const auto& [a, b, c] : other.triangles) surface.triangles.push_back({a + offset, b + offset, c + offset});
}

}  // namespace pliant::mesh
