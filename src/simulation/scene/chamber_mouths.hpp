// Whether the wall of a meshed chamber is closed.
#pragma once

#include <string>
#include <vector>

#include "geometry/mesh/tet_mesh.hpp"
#include "simulation/scene/model_draft.hpp"

namespace pliant::robot {

/// What leaves the chamber open, for people; "" if it is closed. A face of the wall that belongs to no body is a mouth:
/// a support without motion must hold each of its nodes along its normal, so that it stays in its plane. `faces`: of
/// the chamber's region in `draft.whole`; `wall`: made of them. Precondition: supports have been added.
[[nodiscard]] std::string open_mouth(const ModelDraft& draft, const ChamberSpec& spec,
                                     const std::vector<mesh::Face>& faces, const sim::Wall& wall);

}  // namespace pliant::robot
