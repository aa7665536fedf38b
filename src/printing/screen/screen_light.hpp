// Times an exposure where the frames are presented, frame by frame.
#pragma once

#include <functional>

#include "printing/screen/screen_panel.hpp"
#include "printing/wire/devices.hpp"

namespace pliant::host {

/// Presents `image` until the next black frame is due as near as possible to `seconds` after the first lit one, then
/// black. At least one frame is lit. Late frames count with their actual duration; the exposure is too long by more
/// than half a frame only if the last frame itself was late. `keep_on` is called after every frame; false ends the
/// exposure at the next. In every case black is presented last, or has failed as well.
/// Precondition: seconds > 0, the image has the panel's size. `lit` is called once the first frame is on the panel.
[[nodiscard]] Result<Light> keep_light(Panel& panel, const job::Image& image, double seconds,
                                       const std::function<void()>& lit, const std::function<bool()>& keep_on);

}  // namespace pliant::host
