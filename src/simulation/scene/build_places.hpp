// Supports, plates, loads and markers: what the robot file ties to a box, a plane, a sphere, a surface, nodes or a
// point.
#pragma once

#include "simulation/actuators/attach.hpp"
#include "simulation/scene/model_draft.hpp"

namespace pliant::robot {

// Each adds to the draft's description, or to its problems where a place holds nothing of the mesh.
void add_supports(ModelDraft& draft);
void add_plates(ModelDraft& draft);
void add_loads(ModelDraft& draft);
/// `attacher`: of the draft's bodies.
void add_markers(ModelDraft& draft, const sim::Attacher& attacher);
void add_masses(ModelDraft& draft, const sim::Attacher& attacher);

/// Faces of the bodies' surface as the air outside of them sees them: their normals point into the bodies.
[[nodiscard]] sim::Wall pressed_wall(const ModelDraft& draft, std::vector<mesh::Face> faces);

}  // namespace pliant::robot
