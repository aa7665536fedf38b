// Supports, plates, loads and markers: what the robot file ties to a box, a plane, a sphere, a surface, nodes or a
// point.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "simulation/actuators/attach.hpp"
#include "simulation/scene/model_draft.hpp"

namespace pliant::robot {

// Each adds to the draft's description, or to its problems where a place holds nothing of the mesh.
void add_supports(ModelDraft& draft);
void add_plates(ModelDraft& draft);
void add_loads(ModelDraft& draft, const sim::Attacher& attacher);
/// Those on objects, once these are there.
void add_loads_on_objects(ModelDraft& draft);
/// `attacher`: of the draft's bodies.
void add_markers(ModelDraft& draft, const sim::Attacher& attacher);
void add_masses(ModelDraft& draft, const sim::Attacher& attacher);

/// What is tied to a point, for messages; `kinds`: plural of `kind`.
struct Place {
    std::string_view kind, kinds;
    const std::string& name;
    int line;
    double radius_m;  ///< of the material that carries it; 0: the tet that holds it
};
/// What a point, in length units, rides on; nothing where it lies outside every body, which is then said.
[[nodiscard]] std::optional<sim::Attachment> carried(ModelDraft& draft, const sim::Attacher& attacher,
                                                     const Vec3& point, const Place& what);
/// The nodes that a selector catches; `kind`, `name` and `line` are for messages.
[[nodiscard]] std::vector<int> caught_nodes(ModelDraft& draft, const Selector& selector, std::string_view kind,
                                            const std::string& name, int line);

/// Faces of the bodies' surface as the air outside of them sees them: their normals point into the bodies.
[[nodiscard]] sim::Wall pressed_wall(const ModelDraft& draft, std::vector<mesh::Face> faces);

}  // namespace pliant::robot
