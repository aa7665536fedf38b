// The layers of a job while it is being sliced: seen before the job is whole.
#pragma once

#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "printing/job/job.hpp"

namespace pliant::studio {

/// From any thread. Of many layers every so many are kept, so that a large job takes no more memory than a small one.
class JobUnderWay {
public:
    /// Nothing is under way any more, or something new is.
    void clear();
    /// One more layer is stored. `images`: of the last layer of `so_far`. `colours`: of its materials.
    void add(const job::Manifest& so_far, int count, const std::vector<job::EncodedImage>& images,
             const std::vector<std::string>& colours);

    /// Layers that are stored, all of them.
    [[nodiscard]] int layers() const;
    /// {"layers", "count", "colours", "manifest"}: the manifest lists the layers that are kept, from the platform up,
    /// each with its "number" (from 0) in the job; null while there are none.
    [[nodiscard]] std::string json() const;
    /// PNG of the layer with this number in the job. Errors: it is not kept.
    [[nodiscard]] Result<std::string> image(int layer, int material) const;

    static constexpr std::size_t most_kept = 200;

private:
    struct Kept {
        job::Layer layer;
        std::vector<std::string> pngs;  ///< parallel to layer.images
    };
    void thin_out();

    mutable std::mutex mutex_;
    job::Manifest head_;  ///< without layers
    std::vector<std::string> colours_;
    std::map<int, Kept> kept_;  ///< by number
    int every_ = 1;             ///< those whose number is a multiple of this
    int layers_ = 0, count_ = 0;
};

}  // namespace pliant::studio
