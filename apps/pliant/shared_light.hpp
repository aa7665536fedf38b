// The projector of a virtual printer in the same program: written by the host's thread, read by the machine's thread.
#pragma once

#include <mutex>
#include <optional>

#include "printing/twin/twin.hpp"
#include "printing/wire/devices.hpp"

namespace pliant::app {

class SharedLight final : public host::Projector {
public:
    [[nodiscard]] Status show(const job::Image& image) override {
        const std::scoped_lock lock(mutex_);
        image_ = image;
        return {};
    }
    [[nodiscard]] Status black() override {
        const std::scoped_lock lock(mutex_);
        image_.reset();
        return {};
    }
    [[nodiscard]] bool lit() const {
        const std::scoped_lock lock(mutex_);
        return image_.has_value();
    }
    /// For the machine's thread: passes the current image to the twin.
    [[nodiscard]] Status look(twin::Twin& twin) {
        const std::scoped_lock lock(mutex_);
        if (image_.has_value() == seen_) return {};
        seen_ = image_.has_value();
        if (seen_)
            twin.light_on(*image_);
        else
            twin.light_off();
        return {};
    }

private:
    mutable std::mutex mutex_;
    std::optional<job::Image> image_;
    bool seen_ = false;
};

}  // namespace pliant::app
