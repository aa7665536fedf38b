// Points that ride on objects.
#pragma once

#include <optional>

#include "simulation/actuators/attach.hpp"
#include "simulation/scene/model_draft.hpp"

namespace pliant::robot {

/// The four nodes of an object and what carries points near `center`, metres, anywhere.
[[nodiscard]] sim::AffinePatch patch_of_object(const sim::Description& description, std::size_t object,
                                               const Vec3& center);

/// What carries a point that lies outside all bodies and in or on an object; nothing else. `attacher`: of the bodies.
[[nodiscard]] std::optional<sim::Attachment> carried_by_object(const ModelDraft& draft, const sim::Attacher& attacher,
                                                               const Vec3& point);

}  // namespace pliant::robot
