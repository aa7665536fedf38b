// Ties points of space to the mesh that carries them.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "base/core/error.hpp"
#include "geometry/mesh/tet_locator.hpp"
#include "geometry/mesh/tet_mesh.hpp"
#include "simulation/parts/description.hpp"

namespace pliant::sim {

/// How an attachment changes with the rest position of its point: of each node the change of its weight, 1/m. Without
/// nodes the point is fixed in space and moves itself.
struct AttachmentSlope {
    std::vector<int> nodes;
    std::vector<Vec3> weights;
};

/// A patch of nodes whose mean affine motion carries every point near its centre: weights that are linear in where the
/// point is.
struct AffinePatch {
    std::vector<int> nodes;       ///< none: fixed in space
    std::vector<double> weights;  ///< of the centre
    std::vector<Vec3> slopes;     ///< how they change with where the point is, 1/m
    Vec3 center;                  ///< metres
    double reach = 0;             ///< about how far the patch goes
    [[nodiscard]] Attachment at(const Vec3& point) const;
};

/// The patch that fits the motion of these nodes best, each as important as it weighs; nothing where they lie in one
/// plane.
[[nodiscard]] std::optional<AffinePatch> fitted_patch(std::vector<int> nodes, std::span<const double> importance,
                                                      const std::vector<Vec3>& points, const Vec3& center);

/// Built once per mesh; the mesh must outlive it. Lengths are in the mesh's unit.
class Attacher {
public:
    explicit Attacher(const mesh::TetMesh& mesh);

    /// The point moves with the tet that holds it. An error gives the distance of a point that lies outside by more
    /// than `tolerance`. Within it, the nearest tet carries the point as if it went on beyond its face: where the point
    /// is at rest is kept, and its motion is that of the face and its slope. A tet that is too flat for that carries
    /// its own nearest point instead.
    [[nodiscard]] Result<Attachment> carried_by_tet(const Vec3& point, double tolerance) const;

    /// How far a point lies outside the mesh; 0 inside.
    [[nodiscard]] double distance_outside(const Vec3& point) const { return locator_.locate(point).distance; }

    /// The point's motion is the mean motion of the material within `radius`, and a force on it spreads over that
    /// patch: a moving-least-squares weight that reproduces every affine motion exactly (Lancaster and Salkauskas
    /// 1981). The patch stays on the point's side of a gap, is at least as large as the tet that holds the point, and
    /// uses at most 64 nodes.
    [[nodiscard]] Result<Attachment> spread(const Vec3& point, double radius, double tolerance) const;

    /// The material within `radius` of a point, as spread() takes it. Errors: those of spread(), and nodes in one
    /// plane.
    [[nodiscard]] Result<AffinePatch> patch(const Vec3& point, double radius, double tolerance) const;

    /// The mean affine motion of the material within `radius`: that of the same patch, by the same fit, and where no
    /// patch has one that of the tet that holds the point.
    [[nodiscard]] Result<AttachedFrame> frame(const Vec3& point, double radius, double tolerance) const;

    /// How the attachment that spread() gives changes with the point, for as long as the nodes of its patch, or the tet
    /// that holds the point, stay the same. Its errors.
    [[nodiscard]] Result<AttachmentSlope> slope(const Vec3& point, double radius, double tolerance) const;

private:
    struct Patch {
        std::vector<int> nodes;
        double reach = 0;
        int farthest = -1;  ///< node of the tet that the reach is about; -1: it is the radius
    };
    [[nodiscard]] Patch patch_at(int tet, const Vec3& point, double radius) const;
    [[nodiscard]] AttachmentSlope slope_in_tet(const mesh::TetLocator::Location& at) const;
    [[nodiscard]] Result<mesh::TetLocator::Location> locate(const Vec3& point, double tolerance) const;
    [[nodiscard]] std::vector<int> connected_nodes_within(int tet, const Vec3& point, double radius) const;

    const mesh::TetMesh* mesh_;
    mesh::TetLocator locator_;
    std::vector<int> tet_start_;  ///< (n + 1)
    std::vector<int> tets_;       ///< tets of every node
};

/// The wall that faces form, their nodes as points. `index` (nodes of the mesh that the faces come from) says which
/// node of the robot each is; where it is -1 the point stays where it is: in the mouth of a chamber that a support
/// closes.
[[nodiscard]] Wall wall_of_faces(const mesh::TetMesh& mesh, std::span<const mesh::Face> faces,
                                 std::span<const int> index);

}  // namespace pliant::sim
