#include "printing/operate/picture_projector.hpp"

#include <system_error>

#include "base/core/files.hpp"
#include "printing/job/png.hpp"

namespace pliant::operate {

PictureProjector::~PictureProjector() {
    (void)black();
}

Status PictureProjector::show(const job::Image& image) {
    return write_file(shown(), job::encode_png(image));
}

Status PictureProjector::black() {
    std::error_code error;
    std::filesystem::remove(shown(), error);
    return error ? Status(failure("{}: {}", shown().string(), error.message())) : Status{};
}

}  // namespace pliant::operate
