// Stacks of layer images from other programs.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "base/core/error.hpp"
#include "printing/job/stack_height.hpp"
#include "printing/slice/image.hpp"

namespace pliant::job {

/// The PNG images of a folder or a zip file (.sl1, .nanodlp, .cws, any .zip) whose names end with a number: layer
/// images in the order of that number, which may begin at 0 or 1. Previews and thumbnails are ignored. Of several
/// groups of names, such as "cone_0001.png", the largest is the stack; see left_out(). Not thread-safe.
class ImageStack {
public:
    /// Errors: no such images, a missing or duplicate number, images of different sizes, an invalid layer height
    /// (stack_height.hpp); all with names.
    [[nodiscard]] static Result<ImageStack> open(const std::filesystem::path& path);
    ImageStack(ImageStack&&) noexcept;
    ImageStack& operator=(ImageStack&&) noexcept;
    ~ImageStack();

    [[nodiscard]] int layer_count() const;
    [[nodiscard]] int width_px() const;
    [[nodiscard]] int height_px() const;
    /// From the files beside the images; nullopt if they do not say.
    [[nodiscard]] std::optional<double> layer_um() const;
    /// Likewise; of the first layer, where it is given.
    [[nodiscard]] std::optional<double> first_layer_um() const;
    /// Likewise.
    [[nodiscard]] std::optional<PixelSize> pixel() const;
    /// Names the images of another group that could be layers too: those of the next largest one, if they have the same
    /// size. "": none.
    [[nodiscard]] const std::string& left_out() const;
    /// The image as grey, whatever kind of PNG the file holds. Errors: what libpng rejects.
    [[nodiscard]] Result<slice::Image> image(int layer) const;

private:
    struct State;
    explicit ImageStack(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

/// True for a folder, and for a zip file with PNG images that is neither a 3MF file nor a job.
[[nodiscard]] bool is_image_stack(const std::filesystem::path& path);

}  // namespace pliant::job
