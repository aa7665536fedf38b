// Stacks of layer images from other programs.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "base/core/error.hpp"
#include "printing/slice/image.hpp"

namespace pliant::job {

/// The PNG images of a folder or a zip file (.sl1, .nanodlp, .cws, any .zip) whose names end with a number: layer
/// images in the order of that number, which may begin at 0 or 1. Previews and thumbnails are passed over. Of several
/// groups of names, as in "cone_0001.png", the largest is the stack. One thread at a time.
class ImageStack {
public:
    /// Errors: no such images, a number that is missing or comes twice, images of different sizes, a layer height that
    /// cannot be (stack_height.hpp); all with names.
    [[nodiscard]] static Result<ImageStack> open(const std::filesystem::path& path);
    ImageStack(ImageStack&&) noexcept;
    ImageStack& operator=(ImageStack&&) noexcept;
    ~ImageStack();

    [[nodiscard]] int layer_count() const;
    [[nodiscard]] int width_px() const;
    [[nodiscard]] int height_px() const;
    /// As the files beside the images say; nullopt: they do not.
    [[nodiscard]] std::optional<double> layer_um() const;
    /// Grey, of any kind of PNG that the file holds. Errors: what libpng refuses.
    [[nodiscard]] Result<slice::Image> image(int layer) const;

private:
    struct State;
    explicit ImageStack(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

/// True for a folder, and for a zip file that holds PNG images and is neither a 3MF file nor a job.
[[nodiscard]] bool is_image_stack(const std::filesystem::path& path);

}  // namespace pliant::job
