// A display as a panel, through SDL2: KMSDRM without a desktop, X11 with one.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "printing/screen/screen_panel.hpp"

namespace pliant::host {

struct Display {
    int number = 0;
    std::string name;
    int width_px = 0, height_px = 0;
    double refresh_hz = 0;  ///< 0: unknown
};

/// SDL's video subsystem, for the lifetime of the object; only one per process.
class SdlVideo {
public:
    /// X11 if DISPLAY is set, else KMSDRM; SDL_VIDEODRIVER overrides. Errors: no display, or it is in use.
    [[nodiscard]] static Result<SdlVideo> open();
    SdlVideo(SdlVideo&& other) noexcept;
    SdlVideo& operator=(SdlVideo&&) = delete;
    ~SdlVideo();

    [[nodiscard]] std::vector<Display> displays() const;
    /// Covers the display with black, without cursor, above everything, in its native resolution. Errors: no such
    /// display, or it does not show exactly the given pixels (tested with a picture that is never shown).
    [[nodiscard]] Result<std::unique_ptr<Panel>> open_panel(int display) const;
    /// "x11", "KMSDRM".
    [[nodiscard]] std::string driver() const;

private:
    explicit SdlVideo(bool open) : open_(open) {}
    bool open_ = false;
};

}  // namespace pliant::host
