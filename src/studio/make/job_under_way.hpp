// The layers of a job that is still being sliced, for a preview.
#pragma once

#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "printing/job/job.hpp"

namespace pliant::studio {

/// Thread-safe. If there are many layers only every n-th is kept, so that a large job takes no more memory than a small
/// one.
class JobUnderWay {
public:
    /// Clears it: nothing is being sliced any more, or a new job is.
    void clear();
    /// Stores one more layer. `images`: of the last layer of `so_far`. `colours`: of its materials.
    void add(const job::Manifest& so_far, int count, const std::vector<job::EncodedImage>& images,
             const std::vector<std::string>& colours);

    /// Number of sliced layers, whether kept or not.
    [[nodiscard]] int layers() const;
    /// {"layers", "count", "colours", "manifest"}: the manifest lists the kept layers, from the platform up, each with
    /// its "number" (from 0) in the job; null if there are none.
    [[nodiscard]] std::string json() const;
    /// PNG of the layer with this number in the job. Errors: it was not kept.
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
    int every_ = 1;             ///< layers whose number is a multiple of this are kept
    int layers_ = 0, count_ = 0;
};

}  // namespace pliant::studio
