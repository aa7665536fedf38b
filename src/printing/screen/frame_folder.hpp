// A panel that is a folder: the light is what its `shown.png` holds, no such file is dark. What the virtual printer of
// `pliant twin --projector` looks at, and a record of what was shown.
#pragma once

#include <filesystem>
#include <string>

#include "printing/screen/screen_pacer.hpp"
#include "printing/screen/screen_panel.hpp"

namespace pliant::host {

/// 60 frames a second. A light that ends leaves its image as 00001.png, 00002.png, ... in the folder, which is made if
/// it does not exist; images of an earlier time are overwritten. At its end there is no `shown.png`.
class FrameFolder final : public Panel {
public:
    /// Errors: the folder cannot be made or written to.
    [[nodiscard]] static Result<FrameFolder> open(const std::filesystem::path& folder, int width_px, int height_px);
    FrameFolder(FrameFolder&& other) noexcept;
    FrameFolder& operator=(FrameFolder&&) = delete;
    ~FrameFolder() override;

    [[nodiscard]] int width_px() const override { return width_px_; }
    [[nodiscard]] int height_px() const override { return height_px_; }
    [[nodiscard]] double frame_s() const override { return 1.0 / 60; }
    [[nodiscard]] Result<double> present(const job::Image* image) override;

private:
    FrameFolder(std::filesystem::path folder, int width_px, int height_px)
        : folder_(std::move(folder)), width_px_(width_px), height_px_(height_px) {}
    [[nodiscard]] Status put_out();

    std::filesystem::path folder_;
    int width_px_ = 0, height_px_ = 0;
    int shown_ = 0;                    ///< lights so far
    const job::Image* lit_ = nullptr;  ///< what `shown.png` holds
    Pacer pacer_{1.0 / 60};
};

}  // namespace pliant::host
