// Animated GIF, which slides, chats and web pages can show. Written with giflib.
#pragma once

#include <span>
#include <string>

#include "base/core/error.hpp"
#include "presentation/draw/raycast.hpp"

namespace pliant::report {

/// Loops for ever; the last frame is shown for `last_ms`. At most 255 colours, chosen from all frames; only the changed
/// part of each frame is written. Times are rounded to hundredths of a second. Precondition: at least one frame, all of
/// one size, at most 65,535 pixels wide and high. Errors: out of memory.
[[nodiscard]] Result<std::string> animated_gif(std::span<const Image> frames, int frame_ms, int last_ms);

}  // namespace pliant::report
