// Decodes images one exposure ahead: during an exposure or a vat change, a thread fetches the next image.
#pragma once

#include <functional>
#include <future>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "base/core/error.hpp"
#include "printing/job/job.hpp"

namespace pliant::host {

/// Gets the requested image from `source` and then, in a thread, the next one in `order`. `source` is never called
/// concurrently; it must outlive this object. Requests in another order work too, without the gain.
class ImageAhead {
public:
    using Source = std::function<Result<job::Image>(int layer, int material)>;
    using Order = std::vector<std::pair<int, int>>;  ///< layer and material of each exposure

    ImageAhead(Source source, Order order);
    ~ImageAhead();
    ImageAhead(const ImageAhead&) = delete;
    ImageAhead& operator=(const ImageAhead&) = delete;

    [[nodiscard]] Result<job::Image> get(int layer, int material);
    [[nodiscard]] int fetched_ahead() const { return fetched_ahead_; }  ///< images that were ready when requested

private:
    void begin(std::size_t place);
    void begin_next(int layer, int material);

    Source source_;
    Order order_;
    std::size_t next_ = 0;  ///< in order_, after the last request
    std::pair<int, int> coming_{};
    std::future<void> fetching_;
    std::optional<Result<job::Image>> image_;  ///< number `coming_`, once fetched
    int fetched_ahead_ = 0;
};

/// The exposures of a job's G-code, in order; lines other than `;@expose` are skipped.
[[nodiscard]] ImageAhead::Order order_of_exposures(std::string_view gcode);

}  // namespace pliant::host
