#include "printing/screen/screen_sdl.hpp"

#include <SDL2/SDL.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "printing/screen/screen_pacer.hpp"

namespace pliant::host {
namespace {

constexpr double usual_refresh_hz = 60;

tl::unexpected<Error> sdl_failure(std::string_view what) {
    return failure("{}: {}", what, SDL_GetError());
}

/// Converts grey to ARGB.
std::vector<Uint32> argb(const job::Image& image) {
    std::vector<Uint32> colours(image.pixels.size());
    for (std::size_t i = 0; i < colours.size(); ++i) colours[i] = 0xff000000U | image.pixels[i] * 0x010101U;
    return colours;
}

class SdlPanel final : public Panel {
public:
    SdlPanel(int width_px, int height_px, double frame_s, bool may_sync)
        : width_px_(width_px), height_px_(height_px), frame_s_(frame_s), pacer_(frame_s), synced_(may_sync) {}
    SdlPanel(const SdlPanel&) = delete;
    SdlPanel& operator=(const SdlPanel&) = delete;
    ~SdlPanel() override {
        if (texture_ != nullptr) SDL_DestroyTexture(texture_);
        if (renderer_ != nullptr) SDL_DestroyRenderer(renderer_);
        if (window_ != nullptr) SDL_DestroyWindow(window_);
    }

    [[nodiscard]] int width_px() const override { return width_px_; }
    [[nodiscard]] int height_px() const override { return height_px_; }
    [[nodiscard]] double frame_s() const override { return frame_s_; }

    Status open(int display, const SDL_Rect& place) {
        // A desktop's window manager would move, decorate, minimise or cover the window; on X11 it can be bypassed.
        const bool x11 = std::strcmp(SDL_GetCurrentVideoDriver(), "x11") == 0;
        const Uint32 flags = x11 ? SDL_WINDOW_BORDERLESS | SDL_WINDOW_ALWAYS_ON_TOP : SDL_WINDOW_FULLSCREEN_DESKTOP;
        window_ = SDL_CreateWindow("Pliant projector", place.x, place.y, place.w, place.h, flags);
        if (window_ == nullptr) return sdl_failure("no window");
        if (SDL_GetWindowDisplayIndex(window_) != display) {
            return failure("display {} cannot be told from display {}: both lie at {}, {}; join them by RandR", display,
                           SDL_GetWindowDisplayIndex(window_), place.x, place.y);
        }
        SDL_ShowCursor(SDL_DISABLE);
        if (Status status = open_renderer(); !status) return status;
        if (!synced_) return {};
        const Result<bool> in_step = keeps_step();
        if (!in_step) return tl::unexpected(in_step.error());
        if (*in_step) return {};
        synced_ = false;
        return open_renderer();
    }

    Result<double> present(const job::Image* image) override {
        if (image != nullptr && image != shown_) {
            if (Status status = upload(*image); !status) return tl::unexpected(status.error());
        }
        shown_ = image;
        if (Status status = draw(image != nullptr); !status) return tl::unexpected(status.error());
        if (!synced_) pacer_.wait();
        SDL_RenderPresent(renderer_);
        return pacer_.mark();
    }

    Status idle() override {
        bool exposed = false;
        for (SDL_Event event; SDL_PollEvent(&event) != 0;) {
            if (event.type == SDL_QUIT || event.type == SDL_RENDER_DEVICE_RESET) return failure("the display is gone");
            if (event.type != SDL_WINDOWEVENT) continue;
            const auto what = event.window.event;
            if (what == SDL_WINDOWEVENT_CLOSE) return failure("the display is gone");
            if (what == SDL_WINDOWEVENT_SIZE_CHANGED || what == SDL_WINDOWEVENT_DISPLAY_CHANGED) {
                if (Status status = check_size(); !status) return status;
            }
            exposed = exposed || what == SDL_WINDOWEVENT_EXPOSED;
        }
        // While an image is shown every frame is redrawn anyway.
        if (exposed && shown_ == nullptr) {
            if (const auto at = present(nullptr); !at) return tl::unexpected(at.error());
        }
        return {};
    }

private:
    Status check_size() {
        int width = 0, height = 0;
        if (SDL_GetRendererOutputSize(renderer_, &width, &height) != 0) return sdl_failure("no size");
        if (width == width_px_ && height == height_px_) return {};
        return failure("the display has {} x {} px, its window {} x {} px: is it scaled?", width_px_, height_px_, width,
                       height);
    }

    Status upload(const job::Image& image) {
        const auto colours = argb(image);
        if (SDL_UpdateTexture(texture_, nullptr, colours.data(), width_px_ * 4) == 0) return {};
        return sdl_failure("no image");
    }

    Status draw(bool lit) {
        const bool good = SDL_SetRenderDrawColor(renderer_, 0, 0, 0, 255) == 0 && SDL_RenderClear(renderer_) == 0 &&
                          (!lit || SDL_RenderCopy(renderer_, texture_, nullptr, nullptr) == 0);
        return good ? Status{} : Status(sdl_failure("no frame"));
    }

    /// Draws noise into a hidden buffer and reads it back: reveals a driver that filters, scales or dithers.
    Status check_exact() {
        job::Image noise{width_px_, height_px_, {}};
        const std::size_t pixels = static_cast<std::size_t>(width_px_) * static_cast<std::size_t>(height_px_);
        noise.pixels.reserve(pixels);
        for (std::size_t i = 0; i < pixels; ++i)
            noise.pixels.push_back(static_cast<std::uint8_t>(i * 2654435761U >> 13));
        if (Status status = upload(noise); !status) return status;
        if (Status status = draw(true); !status) return status;
        std::vector<Uint32> back(pixels);
        if (SDL_RenderReadPixels(renderer_, nullptr, SDL_PIXELFORMAT_ARGB8888, back.data(), width_px_ * 4) != 0)
            return sdl_failure("what was drawn cannot be read back");
        const auto wanted = argb(noise);
        for (std::size_t i = 0; i < pixels; ++i) {
            if (((back[i] ^ wanted[i]) & 0xffffffU) == 0) continue;
            const auto width = static_cast<std::size_t>(width_px_);
            return failure("the display does not show exact pixels: {:06x} became {:06x} in row {}, column {}",
                           wanted[i] & 0xffffffU, back[i] & 0xffffffU, i / width, i % width);
        }
        return {};
    }

    Status open_renderer() {
        if (texture_ != nullptr) SDL_DestroyTexture(std::exchange(texture_, nullptr));
        if (renderer_ != nullptr) SDL_DestroyRenderer(std::exchange(renderer_, nullptr));
        if (synced_) renderer_ = SDL_CreateRenderer(window_, -1, SDL_RENDERER_ACCELERATED | SDL_RENDERER_PRESENTVSYNC);
        if (renderer_ == nullptr) renderer_ = SDL_CreateRenderer(window_, -1, SDL_RENDERER_SOFTWARE);
        if (renderer_ == nullptr) return sdl_failure("no renderer");
        if (Status status = check_size(); !status) return status;
        texture_ =
            SDL_CreateTexture(renderer_, SDL_PIXELFORMAT_ARGB8888, SDL_TEXTUREACCESS_STATIC, width_px_, height_px_);
        if (texture_ == nullptr) return sdl_failure("no texture");
        SDL_SetTextureScaleMode(texture_, SDL_ScaleModeNearest);
        SDL_SetTextureBlendMode(texture_, SDL_BLENDMODE_NONE);
        return check_exact();
    }

    /// Whether presenting waits for the display at its refresh rate. If not (no driver, or SDL only sleeps some
    /// milliseconds), frames are paced by the clock.
    Result<bool> keeps_step() {
        constexpr int lead = 5;
        constexpr int frames = 30;
        double begin_s = 0;
        double end_s = 0;
        for (int i = 0; i <= lead + frames; ++i) {
            const Result<double> at = present(nullptr);
            if (!at) return tl::unexpected(at.error());
            if (i == lead) begin_s = *at;
            end_s = *at;
        }
        return std::abs((end_s - begin_s) / frames - frame_s_) < 0.02 * frame_s_;
    }

    int width_px_, height_px_;
    double frame_s_;
    Pacer pacer_;
    bool synced_;  ///< presenting waits for the vertical blanking
    const job::Image* shown_ = nullptr;
    SDL_Window* window_ = nullptr;
    SDL_Renderer* renderer_ = nullptr;
    SDL_Texture* texture_ = nullptr;
};

}  // namespace

Result<SdlVideo> SdlVideo::open() {
    const bool x11 = std::getenv("DISPLAY") != nullptr;
    if (std::getenv("SDL_VIDEODRIVER") == nullptr) SDL_SetHint(SDL_HINT_VIDEODRIVER, x11 ? "x11" : "KMSDRM");
    SDL_SetHint(SDL_HINT_X11_FORCE_OVERRIDE_REDIRECT, "1");
    SDL_SetHint(SDL_HINT_VIDEO_MINIMIZE_ON_FOCUS_LOSS, "0");
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
    if (SDL_Init(SDL_INIT_VIDEO) != 0) {
        return failure("no display ({}): {}{}", x11 ? "X11" : "KMSDRM", SDL_GetError(),
                       x11 ? ""
                           : "; without a desktop the user must be in the groups video and render, "
                             "on a desktop DISPLAY must be set");
    }
    SDL_DisableScreenSaver();
    return SdlVideo(true);
}

SdlVideo::SdlVideo(SdlVideo&& other) noexcept : open_(std::exchange(other.open_, false)) {}

SdlVideo::~SdlVideo() {
    if (open_) SDL_Quit();
}

std::string SdlVideo::driver() const {
    return SDL_GetCurrentVideoDriver();
}

std::vector<Display> SdlVideo::displays() const {
    std::vector<Display> displays;
    for (int i = 0; i < SDL_GetNumVideoDisplays(); ++i) {
        SDL_DisplayMode mode{};
        if (SDL_GetDesktopDisplayMode(i, &mode) != 0) continue;
        const char* name = SDL_GetDisplayName(i);
        displays.push_back({i, name == nullptr ? "" : name, mode.w, mode.h, static_cast<double>(mode.refresh_rate)});
    }
    return displays;
}

Result<std::unique_ptr<Panel>> SdlVideo::open_panel(int display) const {
    const auto all = displays();
    SDL_Rect place{};
    if (display < 0 || display >= static_cast<int>(all.size()) || SDL_GetDisplayBounds(display, &place) != 0)
        return input_error("there is no display {}: they count from 0 to {}", display,
                           static_cast<int>(all.size()) - 1);
    const Display& found = all[static_cast<std::size_t>(display)];
    const double rate_hz = found.refresh_hz > 0 ? found.refresh_hz : usual_refresh_hz;
    auto panel = std::make_unique<SdlPanel>(place.w, place.h, 1 / rate_hz, found.refresh_hz > 0);
    if (Status status = panel->open(display, place); !status) return tl::unexpected(status.error());
    return panel;
}

}  // namespace pliant::host
