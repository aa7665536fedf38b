// The mouths of a meshed chamber: faces of its wall that belong to no body.
#pragma once

#include <string>
#include <vector>

#include "geometry/mesh/tet_mesh.hpp"
#include "simulation/scene/model_draft.hpp"

namespace pliant::robot {

/// Puts the faces that belong to no body last; returns their number. `faces`: of a chamber's region in `draft.whole`.
[[nodiscard]] std::size_t put_mouths_last(const ModelDraft& draft, std::vector<mesh::Face>& faces);

/// What leaves the chamber open, for people; "" if it is closed: a support without motion must hold each node of a
/// mouth along its normal, so that the mouth stays in its plane. `faces`: of the chamber's region in `draft.whole`;
/// `wall`: made of them, with its mouths. Precondition: supports have been added.
[[nodiscard]] std::string open_mouth(const ModelDraft& draft, const ChamberSpec& spec,
                                     const std::vector<mesh::Face>& faces, const sim::Wall& wall);

}  // namespace pliant::robot
