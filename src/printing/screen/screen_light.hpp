// How long a light is on is decided where the frames are presented, frame by frame.
#pragma once

#include <functional>

#include "printing/screen/screen_panel.hpp"
#include "printing/wire/devices.hpp"

namespace pliant::host {

/// Presents `image` until the next black frame comes as near to `seconds` after the first lit one as frames allow, then
/// black. At least one frame is lit. Late frames count as long as they were; the light is longer than asked by more
/// than half a frame only if the last frame itself was late. `keep_on` is asked after every frame: false ends the
/// light at the next. Whatever happens, the last thing presented is black, or black has failed too.
/// Precondition: seconds > 0, the image has the panel's size. `lit` is called once the first frame is on the panel.
[[nodiscard]] Result<Light> keep_light(Panel& panel, const job::Image& image, double seconds,
                                       const std::function<void()>& lit, const std::function<bool()>& keep_on);

}  // namespace pliant::host
