#include "studio/print/projector_session.hpp"

#include "printing/host/projector_patterns.hpp"
#include "printing/job/png.hpp"

namespace pliant::studio {
namespace {

Result<job::Image> image_of(const std::string& pattern, int square_px, const machine::Projector& projector) {
    host::PatternOptions options;
    options.width_px = projector.width_px;
    options.height_px = projector.height_px;
    options.pixel_um = projector.pixel_um;
    options.square_px = square_px;
    return host::test_pattern(pattern, options);
}

}  // namespace

Status ProjectorSession::show(const Order& order, const machine::Projector& projector) {
    if (!(order.seconds > 0 && order.seconds <= longest_s))
        return input_error("seconds: above 0 and at most {} are needed", longest_s);
    const Result<job::Image> image = image_of(order.pattern, order.square_px, projector);
    if (!image) return tl::unexpected(image.error());
    const std::lock_guard lock(mutex_);
    if (where_ != order.where) screen_.reset();
    if (!screen_) {
        host::ScreenOptions options;
        options.width_px = projector.width_px;
        options.height_px = projector.height_px;
        options.longest_light_s = longest_s;
        auto screen = host::ScreenProjector::open(order.where, options);
        if (!screen) return tl::unexpected(screen.error());
        screen_ = std::make_unique<host::ScreenProjector>(std::move(*screen));
        where_ = order.where;
    }
    if (Status dark = screen_->black(); !dark) return dark;
    return screen_->show_for(*image, order.seconds);
}

void ProjectorSession::dark() {
    const std::lock_guard lock(mutex_);
    if (screen_) (void)screen_->black();
    screen_.reset();
}

Result<std::string> pattern_picture(const std::string& pattern, int square_px, const machine::Projector& projector) {
    const Result<job::Image> image = image_of(pattern, square_px, projector);
    if (!image) return tl::unexpected(image.error());
    return job::encode_png(*image);
}

}  // namespace pliant::studio
