// A model under construction: the mesh, what has been attached to it so far, and the problems found.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/mesh/tet_mesh.hpp"
#include "robot/description/regions.hpp"
#include "robot/description/robot.hpp"
#include "simulation/actuators/attach.hpp"
#include "simulation/model/model.hpp"

namespace pliant::robot {

/// The tets that carry material, on the nodes of a description's mesh.
[[nodiscard]] mesh::TetMesh tets_of_bodies(const Robot& robot, const mesh::TetMesh& all);

/// The mean length of the edges of all tets; 0 without any.
[[nodiscard]] double mean_edge(const mesh::TetMesh& mesh);

/// Metres throughout. The robot must outlive it.
struct ModelDraft {
    /// Sets the meshes and the tolerances; `mesh` is that of build_mesh().
    ModelDraft(const Robot& robot, mesh::TetMesh mesh);

    /// Adds FILE:LINE: KIND "NAME": TEXT to the problems.
    void problem(int line, std::string_view kind, std::string_view name, const std::string& text);

    /// A point in the robot file's unit, as text for messages.
    [[nodiscard]] std::string show(const Vec3& p_m) const;
    /// "the robot reaches from ... to ...".
    [[nodiscard]] std::string show_bounds() const;

    /// Records a point that is attached to the bodies from `distance_m` outside them.
    void count_point(std::string_view kind, double distance_m);
    /// Remarks about the recorded points, for the user.
    [[nodiscard]] std::vector<std::string> notes_on_points() const;

    [[nodiscard]] Box3 box_of(const BoxSelector& selector) const;
    /// Index of a region of `whole`. Precondition: it exists.
    [[nodiscard]] std::size_t region_of(Region::Use use, std::string_view name) const;
    /// The regions of the description's mesh that form a gap: one, or one for each notch. Precondition: the gap has
    /// elements.
    [[nodiscard]] std::vector<int> regions_of_gap(const GapSpec& gap) const;
    /// The material of a region of `whole`. Precondition: the region has elements, and materials have been added.
    [[nodiscard]] int material_of(std::size_t region) const;

    /// Index of a region of `whole` in the description's mesh. Precondition: it has elements.
    [[nodiscard]] int kept_region(std::size_t region) const;

    const Robot& robot;
    mesh::TetMesh whole;             ///< regions as in regions_of()
    std::vector<int> node_of_whole;  ///< (nodes of whole) index in the description's mesh, or -1
    sim::Description description;    ///< with its mesh: the regions with elements
    std::vector<int> notches;        ///< regions of the description's mesh: notches after the first, in order
    mesh::TetMesh bodies;            ///< the description's mesh without actuated space
    Box3 box;                        ///< of the description's mesh
    double tolerance = 0;            ///< for points expected on the surface
    double box_margin = 0;           ///< for points expected in a box or sphere
    double point_reach = 0;          ///< how far outside the bodies a guide point or marker may lie
    std::vector<Diagnostic> problems;
    sim::KeptPatches* kept = nullptr;  ///< what points are attached to

    struct Points {
        std::size_t all = 0, outside = 0;
        double farthest_m = 0;
    };
    std::map<std::string, Points, std::less<>> points;  ///< by kind
};

}  // namespace pliant::robot
