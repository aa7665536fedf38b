// Animated GIF, the film that slides, chats and web pages show everywhere. giflib does the work.
#pragma once

#include <span>
#include <string>

#include "base/core/error.hpp"
#include "presentation/draw/raycast.hpp"

namespace pliant::report {

/// Runs for ever; the last frame stays for `last_ms`. At most 255 colours, chosen from all frames; of each frame only
/// what has changed is written. Times are rounded to hundredths of a second. Precondition: at least one frame, all of
/// one size, at most 65,535 pixels wide and high. An error: no memory.
[[nodiscard]] Result<std::string> animated_gif(std::span<const Image> frames, int frame_ms, int last_ms);

}  // namespace pliant::report
