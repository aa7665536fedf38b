#include "printing/screen/image_ahead.hpp"

#include <algorithm>

#include "printing/machine/gcode.hpp"

namespace pliant::host {

ImageAhead::ImageAhead(Source source, Order order) : source_(std::move(source)), order_(std::move(order)) {
    if (!order_.empty()) begin(0);
}

ImageAhead::~ImageAhead() {
    if (fetching_.valid()) fetching_.wait();
}

void ImageAhead::begin(std::size_t place) {
    next_ = place;
    coming_ = order_[place];
    fetching_ = std::async(std::launch::async, [this] { image_.emplace(source_(coming_.first, coming_.second)); });
}

Result<job::Image> ImageAhead::get(int layer, int material) {
    const std::pair<int, int> wanted{layer, material};
    // An unused fetch must be finished, too, before the source is called again.
    if (fetching_.valid()) fetching_.get();
    const bool ready = image_.has_value() && coming_ == wanted;
    if (ready) ++fetched_ahead_;
    Result<job::Image> image = ready ? std::move(*image_) : source_(layer, material);
    image_.reset();
    begin_next(layer, material);
    return image;
}

/// Fetches the image that follows the next occurrence of `layer` and `material` in the order.
void ImageAhead::begin_next(int layer, int material) {
    const auto from = order_.begin() + static_cast<std::ptrdiff_t>(std::min(next_, order_.size()));
    auto at = std::find(from, order_.end(), std::pair{layer, material});
    if (at == order_.end()) at = std::find(order_.begin(), from, std::pair{layer, material});
    if (at == order_.end() || at + 1 == order_.end()) return;
    begin(static_cast<std::size_t>(at - order_.begin()) + 1);
}

ImageAhead::Order order_of_exposures(std::string_view gcode) {
    ImageAhead::Order order;
    while (!gcode.empty()) {
        const std::string_view line = gcode.substr(0, gcode.find('\n'));
        gcode.remove_prefix(std::min(gcode.size(), line.size() + 1));
        if (!machine::is_directive(line)) continue;
        const auto directive = machine::parse_directive(line);
        if (directive && directive->expose) order.emplace_back(directive->expose->layer, directive->expose->material);
    }
    return order;
}

}  // namespace pliant::host
