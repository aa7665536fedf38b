// Builds supports, plates, loads and markers, which the robot file places by a box, a plane, a sphere, a surface, nodes
// or a point.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "simulation/actuators/attach.hpp"
#include "simulation/scene/model_draft.hpp"

namespace pliant::robot {

// Each adds to the draft's description, or to its problems if a selector contains nothing of the mesh.
void add_supports(ModelDraft& draft);
void add_plates(ModelDraft& draft);
void add_loads(ModelDraft& draft, const sim::Attacher& attacher);
/// Loads on objects, after the objects have been added.
void add_loads_on_objects(ModelDraft& draft);
/// `attacher`: for the draft's bodies.
void add_markers(ModelDraft& draft, const sim::Attacher& attacher);
void add_masses(ModelDraft& draft, const sim::Attacher& attacher);

/// Something attached to a point, for messages; `kinds`: plural of `kind`.
struct Place {
    std::string_view kind, kinds;
    const std::string& name;
    int line;
    double radius_m;  ///< of the material that carries it; 0: the tet that contains it
    Vec3 force_N{};   ///< that acts on it: on a plane of symmetry along which it acts, the mirror image carries it too
};
/// Attaches a point, in length units; empty if it lies outside every body, which is reported as a problem.
[[nodiscard]] std::optional<sim::Attachment> carried(ModelDraft& draft, const sim::Attacher& attacher,
                                                     const Vec3& point, const Place& what);
/// True if supports hold all of these points in all directions. Precondition: supports have been added.
[[nodiscard]] bool are_held(const sim::Description& description, std::span<const sim::Attachment> points);

/// The nodes inside a selector; `kind`, `name` and `line` are for messages.
[[nodiscard]] std::vector<int> caught_nodes(ModelDraft& draft, const Selector& selector, std::string_view kind,
                                            const std::string& name, int line);

/// Faces of the bodies' surface as a wall seen from the outside air: their normals point into the bodies.
[[nodiscard]] sim::Wall pressed_wall(const ModelDraft& draft, std::vector<mesh::Face> faces);

}  // namespace pliant::robot
