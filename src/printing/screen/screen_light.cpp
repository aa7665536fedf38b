#include "printing/screen/screen_light.hpp"

#include <algorithm>

namespace pliant::host {
namespace {

/// Black frames that synchronise with the panel's vertical blanking before the exposure, which is then timed between
/// equal frames.
constexpr int lead_frames = 2;
constexpr double tie_s = 1e-6;  // a duration midway between two frames becomes the shorter exposure

/// Presents and times the lit frames. The light stays on until something else is presented.
Status light_frames(Panel& panel, const job::Image& image, const std::function<void()>& lit,
                    const std::function<bool()>& keep_on, Light& light, double& first_s, double& last_s) {
    for (;;) {
        const Result<double> at = panel.present(&image);
        if (!at) return tl::unexpected(at.error());
        if (light.frames++ == 0) {
            first_s = *at;
            lit();
        } else {
            light.longest_frame_s = std::max(light.longest_frame_s, *at - last_s);
        }
        last_s = *at;
        // A black frame presented now appears one frame later; another lit frame would delay it by one more.
        const double dark_s = last_s + panel.frame_s() - first_s;
        if (dark_s >= light.asked_s - panel.frame_s() / 2 - tie_s || !keep_on()) return {};
    }
}

}  // namespace

Result<Light> keep_light(Panel& panel, const job::Image& image, double seconds, const std::function<void()>& lit,
                         const std::function<bool()>& keep_on) {
    for (int i = 0; i < lead_frames; ++i) {
        if (const auto at = panel.present(nullptr); !at) return tl::unexpected(at.error());
    }
    Light light{seconds, 0, 0, panel.frame_s(), 0};
    double first_s = 0;
    double last_s = 0;
    const Status status = light_frames(panel, image, lit, keep_on, light, first_s, last_s);
    const Result<double> dark = panel.present(nullptr);
    if (!status) return tl::unexpected(status.error());
    if (!dark) return tl::unexpected(dark.error());
    light.on_s = *dark - first_s;
    light.longest_frame_s = std::max(light.longest_frame_s, *dark - last_s);
    return light;
}

}  // namespace pliant::host
