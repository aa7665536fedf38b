#include "simulation/stepper/state_digest.hpp"

#include "base/core/digest.hpp"
#include "simulation/stepper/state_file.hpp"

namespace pliant::sim {
namespace {

void add(Digest& digest, const std::string& name, const std::vector<Attachment>& points) {
    digest.add(name.data(), name.size() + 1);  // with its end, so that names do not run together
    for (const Attachment& point : points) {
        digest.add(point.nodes.data(), point.nodes.size() * sizeof(point.nodes[0]));
        digest.add(point.weights.data(), point.weights.size() * sizeof(point.weights[0]));
    }
}

}  // namespace

std::string parts_digest(const Description& d) {
    Digest digest;
    for (const Support& support : d.supports) {
        add(digest, support.name, {});
        digest.add(support.nodes.data(), support.nodes.size() * sizeof(support.nodes[0]));
    }
    for (const Cable& cable : d.cables) add(digest, cable.name, cable.points);
    for (const Chamber& chamber : d.chambers) add(digest, chamber.name, chamber.wall.points);
    for (const PressureLoad& pressure : d.pressures) add(digest, pressure.name, pressure.wall.points);
    for (const Spring& spring : d.springs) add(digest, spring.name, spring.points);
    for (const Joint& joint : d.joints) {
        add(digest, joint.name, {joint.first.begin(), joint.first.end()});
        add(digest, joint.name, {joint.second.begin(), joint.second.end()});
    }
    return digest.text();
}

std::string mesh_digest(const mesh::TetMesh& mesh) {
    Digest digest;
    digest.add(mesh.points.data(), mesh.points.size() * sizeof(mesh.points[0]));
    digest.add(mesh.nodes.data(), mesh.nodes.size() * sizeof(mesh.nodes[0]));
    digest.add(mesh.region.data(), mesh.region.size() * sizeof(mesh.region[0]));
    return digest.text();
}

}  // namespace pliant::sim
