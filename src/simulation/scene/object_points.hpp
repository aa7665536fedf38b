// Points attached to objects.
#pragma once

#include <optional>

#include "simulation/actuators/attach.hpp"
#include "simulation/scene/model_draft.hpp"

namespace pliant::robot {

/// The four nodes of an object, with the weights for points near `center`, metres (valid anywhere).
[[nodiscard]] sim::AffinePatch patch_of_object(const sim::Description& description, std::size_t object,
                                               const Vec3& center);

/// Attaches a point that lies outside all bodies and in or on an object; otherwise empty. `attacher`: for the bodies.
[[nodiscard]] std::optional<sim::Attachment> carried_by_object(const ModelDraft& draft, const sim::Attacher& attacher,
                                                               const Vec3& point);

}  // namespace pliant::robot
