#include "sim/attach.hpp"

#include <doctest/doctest.h>

#include "sim/reference_problems.hpp"

using namespace pliant;
using namespace pliant::sim;

namespace {

/// Where the attachment goes when every node follows an affine map.
Vec3 mapped(const Attachment& point, const mesh::TetMesh& mesh) {
    const auto map = [](const Vec3& p) {
        return Vec3{1.1 * p.x - 0.3 * p.y + 2, 0.2 * p.x + 0.9 * p.y - 0.1 * p.z, p.z + 0.5 * p.y - 1};
    };
    Vec3 sum;
    for (std::size_t i = 0; i < point.nodes.size(); ++i)
        sum += point.weights[i] * map(mesh.points[static_cast<std::size_t>(point.nodes[i])]);
    return sum;
}

Vec3 expected(const Vec3& p) {
    return {1.1 * p.x - 0.3 * p.y + 2, 0.2 * p.x + 0.9 * p.y - 0.1 * p.z, p.z + 0.5 * p.y - 1};
}

}  // namespace

TEST_CASE("carried points and eyelets of every size follow affine motions exactly") {
    for (const int order : {1, 2}) {
        mesh::TetMesh mesh = reference::kuhn_box({10, 4, 4}, 10, 4, 4, [](Vec3) { return 0; });
        if (order == 2) mesh = mesh::to_quadratic(mesh);
        const Attacher attacher(mesh);
        for (const double radius : {0.0, 0.3, 1.5, 6.0}) {
            for (const Vec3& p : {Vec3{5.2, 1.7, 2.9}, Vec3{0, 0, 0}, Vec3{10, 2, 4}, Vec3{3, 2, 2}}) {
                const auto point = attacher.spread(p, radius, 1e-6);
                REQUIRE(point);
                CHECK(norm(mapped(*point, mesh) - expected(p)) < 1e-9);
                CHECK(point->nodes.size() <= 64);
            }
        }
        CHECK(attacher.spread({5, 2, 2}, 1.5, 1e-6)->nodes.size() > attacher.spread({5, 2, 2}, 0, 1e-6)->nodes.size());
    }
}

TEST_CASE("an eyelet does not reach over a gap") {
    // Two blocks side by side, joined by a bridge far from the point.
    mesh::TetMesh box =
        reference::kuhn_box({9, 2, 6}, 9, 2, 6, [](Vec3 c) { return c.x > 4 && c.x < 5 && c.z > 1 ? 1 : 0; });
    mesh::TetMesh mesh = box;
    mesh.nodes.clear();
    mesh.region.clear();
    for (std::size_t t = 0; t < box.tet_count(); ++t) {
        if (box.region[t] == 1) continue;
        mesh.nodes.insert(mesh.nodes.end(), box.tet(t).begin(), box.tet(t).end());
        mesh.region.push_back(0);
    }
    const Attacher attacher(mesh);
    const auto point = attacher.spread({3.9, 1, 5}, 2.5, 1e-6);
    REQUIRE(point);
    for (const int node : point->nodes) CHECK(mesh.points[static_cast<std::size_t>(node)].x <= 4);
}

TEST_CASE("a point outside is refused, a hair outside is carried by the nearest tet") {
    const mesh::TetMesh mesh = reference::kuhn_box({1, 1, 1}, 2, 2, 2, [](Vec3) { return 0; });
    const Attacher attacher(mesh);
    CHECK_FALSE(attacher.carried_by_tet({1.5, 0.5, 0.5}, 1e-3));
    CHECK(attacher.carried_by_tet({1.0005, 0.5, 0.5}, 1e-3));
}
