// Attaches points of space to the mesh that carries them.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/core/error.hpp"
#include "geometry/mesh/tet_locator.hpp"
#include "geometry/mesh/tet_mesh.hpp"
#include "simulation/parts/description.hpp"

namespace pliant::sim {

/// Derivative of an attachment with respect to the rest position of its point: the change of each node's weight, 1/m.
/// Without nodes the point is fixed in space and moves itself.
struct AttachmentSlope {
    std::vector<int> nodes;
    std::vector<Vec3> weights;
};

/// A patch of nodes whose mean affine motion carries every point near its centre: the weights are linear in the
/// position of the point.
struct AffinePatch {
    std::vector<int> nodes;       ///< empty: fixed in space
    std::vector<double> weights;  ///< of the centre
    std::vector<Vec3> slopes;     ///< their derivative with respect to the position, 1/m
    Vec3 center;                  ///< metres
    double reach = 0;             ///< approximate radius of the patch
    [[nodiscard]] Attachment at(const Vec3& point) const;
};

/// The patch whose affine motion best fits that of these nodes, each weighted; empty if the nodes lie in one plane.
[[nodiscard]] std::optional<AffinePatch> fitted_patch(std::vector<int> nodes, std::span<const double> importance,
                                                      const std::vector<Vec3>& points, const Vec3& center);

/// A plane on which a support holds nodes along its normal only: the mesh may be half of a robot, whose other half is
/// its mirror image.
struct SymmetryPlane {
    Vec3 point;
    Vec3 normal;              ///< of length 1
    std::vector<bool> holds;  ///< (nodes)
};

/// The patches that the points of a robot were attached to, for a copy of it that is drawn slightly differently on the
/// same tets. A point on a face lies in several tets, and rounding decides which of them counts: without this the
/// copies choose differently, and their weights differ by a jump.
class KeptPatches {
public:
    struct Patch {
        Vec3 point;
        double radius = 0;
        std::size_t tet_count = 0;  ///< of the mesh it belongs to
        std::vector<int> nodes{};
        double reach = 0;
        int farthest = -1;
    };
    /// From now on patches are found, and no longer added.
    void close() { closed_ = true; }
    [[nodiscard]] bool closed() const { return closed_; }
    void add(Patch patch) { patches_.push_back(std::move(patch)); }
    /// The nearest patch of a mesh with that many tets and about that radius for which `fits` is true; null if none is
    /// near.
    [[nodiscard]] const Patch* find(const Vec3& point, double radius, std::size_t tet_count,
                                    const std::function<bool(const Patch&)>& fits) const;

private:
    std::vector<Patch> patches_;
    bool closed_ = false;
};

/// Built once per mesh, which must outlive it. Lengths are in the mesh's unit.
class Attacher {
public:
    /// `kept`: adds its patches or, closed, takes them from there; must outlive it.
    explicit Attacher(const mesh::TetMesh& mesh, KeptPatches* kept = nullptr);

    /// Attaches a point to the tet that contains it. Errors: the point lies outside the mesh by more than `tolerance`;
    /// the message gives the distance. Within the tolerance the nearest tet carries the point by extrapolation beyond
    /// its face: the rest position of the point is kept, and its motion is that of the face and its slope. If the tet
    /// is too flat for that, its nearest own point is used instead.
    [[nodiscard]] Result<Attachment> carried_by_tet(const Vec3& point, double tolerance) const;

    /// How far a point lies outside the mesh; 0 inside.
    [[nodiscard]] double distance_outside(const Vec3& point) const { return locator_.locate(point).distance; }

    /// The longest edge of the tet that contains the point, or else is nearest.
    [[nodiscard]] double edge_of_tet(const Vec3& point) const;

    /// The point's motion is the mean motion of the material within `radius`, and a force on it spreads over that
    /// patch: a moving-least-squares weight that reproduces every affine motion exactly (Lancaster and Salkauskas
    /// 1981). The patch stays on the point's side of a gap, is at least as large as the tet that holds the point, and
    /// uses at most 64 nodes. On a plane of symmetry it includes the mirror images of its nodes, as in the whole robot;
    /// each node then has the weights of all its images, and the point lies in the plane at rest; across it, it follows
    /// its nodes.
    [[nodiscard]] Result<Attachment> spread(const Vec3& point, double radius, double tolerance,
                                            std::span<const SymmetryPlane> planes = {}) const;

    /// The material within `radius` of a point, chosen as in spread(). Errors: those of spread(), and nodes in one
    /// plane.
    [[nodiscard]] Result<AffinePatch> patch(const Vec3& point, double radius, double tolerance) const;

    /// The mean affine motion of the material within `radius`: from the same patch and fit, or, if the patch has none,
    /// from the tet that contains the point.
    [[nodiscard]] Result<AttachedFrame> frame(const Vec3& point, double radius, double tolerance) const;

    /// Derivative of the attachment from spread() with respect to the point, valid as long as the nodes of its patch,
    /// or the tet that contains the point, stay the same. Errors: those of spread().
    [[nodiscard]] Result<AttachmentSlope> slope(const Vec3& point, double radius, double tolerance,
                                                std::span<const SymmetryPlane> planes = {}) const;

private:
    struct Patch {
        std::vector<int> nodes;
        double reach = 0;
        int farthest = -1;  ///< node of the tet that limits the reach; -1: the radius does
    };
    /// The nodes of a patch and their mirror images.
    struct Images {
        std::vector<Vec3> places;   ///< first those of the nodes
        std::vector<int> of;        ///< (places) index of the node in the patch
        std::vector<Vec3> normals;  ///< of the planes of symmetry that the point lies on
        /// (nodes) <- the sum over the images of each, from (places).
        [[nodiscard]] Eigen::VectorXd gathered(const Eigen::VectorXd& values) const;
    };
    [[nodiscard]] Patch patch_at(int tet, const Vec3& point, double radius) const;
    [[nodiscard]] std::optional<Patch> kept_patch(const Vec3& point, double radius) const;
    [[nodiscard]] bool has(int node) const;
    [[nodiscard]] Images images_of(const Patch& patch, const Vec3& point, std::span<const SymmetryPlane> planes) const;
    [[nodiscard]] bool mirrors(const SymmetryPlane& plane, const Patch& patch, const Vec3& point) const;
    [[nodiscard]] AttachmentSlope slope_in_tet(const mesh::TetLocator::Location& at) const;
    [[nodiscard]] Result<mesh::TetLocator::Location> locate(const Vec3& point, double tolerance) const;
    [[nodiscard]] std::vector<int> connected_nodes_within(int tet, const Vec3& point, double radius) const;

    const mesh::TetMesh* mesh_;
    mesh::TetLocator locator_;
    std::vector<int> tet_start_;  ///< (n + 1)
    std::vector<int> tets_;       ///< tets at each node
    KeptPatches* kept_;
};

/// The wall formed by faces, whose nodes become its points. `index` (nodes of the mesh that the faces come from) gives
/// each node of the robot; -1: the point does not move, as in the mouth of a chamber that a support closes.
[[nodiscard]] Wall wall_of_faces(const mesh::TetMesh& mesh, std::span<const mesh::Face> faces,
                                 std::span<const int> index);

}  // namespace pliant::sim
