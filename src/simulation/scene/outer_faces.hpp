// Which faces of the bodies are their outer surface.
#pragma once

#include <vector>

#include "geometry/mesh/tet_mesh.hpp"
#include "simulation/scene/model_draft.hpp"

namespace pliant::robot {

/// The boundary faces of the bodies.
struct BodyFaces {
    std::vector<mesh::Face> outer;  ///< that the surroundings reach
    std::vector<mesh::Face> inner;  ///< walls of chambers, and of cavities that are closed all around
};

/// Each in the order of mesh::boundary_faces().
[[nodiscard]] BodyFaces body_faces(const ModelDraft& draft);

}  // namespace pliant::robot
