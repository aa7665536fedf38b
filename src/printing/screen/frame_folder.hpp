// A panel that is a folder: it shows the image `shown.png`; without that file it is dark. The virtual printer of
// `pliant twin --projector` watches it, and it keeps a record of what was shown.
#pragma once

#include <filesystem>
#include <string>

#include "printing/screen/screen_pacer.hpp"
#include "printing/screen/screen_panel.hpp"

namespace pliant::host {

/// 60 frames per second. At the end of an exposure its image is kept as 00001.png, 00002.png, ... in the folder, which
/// is created if missing; the numbers go on after those that it holds. The destructor removes `shown.png`.
class FrameFolder final : public Panel {
public:
    /// Errors: the folder cannot be created or written to.
    [[nodiscard]] static Result<FrameFolder> open(const std::filesystem::path& folder, int width_px, int height_px);
    FrameFolder(FrameFolder&& other) noexcept;
    FrameFolder& operator=(FrameFolder&&) = delete;
    ~FrameFolder() override;

    [[nodiscard]] int width_px() const override { return width_px_; }
    [[nodiscard]] int height_px() const override { return height_px_; }
    [[nodiscard]] double frame_s() const override { return 1.0 / 60; }
    [[nodiscard]] Result<double> present(const job::Image* image) override;

private:
    FrameFolder(std::filesystem::path folder, int width_px, int height_px, int kept)
        : folder_(std::move(folder)), width_px_(width_px), height_px_(height_px), shown_(kept) {}
    [[nodiscard]] Status put_out();

    std::filesystem::path folder_;
    int width_px_ = 0, height_px_ = 0;
    int shown_ = 0;                    ///< number of the last image
    const job::Image* lit_ = nullptr;  ///< image in `shown.png`
    Pacer pacer_{1.0 / 60};
};

}  // namespace pliant::host
