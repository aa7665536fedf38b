#include "studio/make/job_under_way.hpp"

#include <nlohmann/json.hpp>

#include "base/core/json.hpp"
#include "printing/job/manifest.hpp"
#include "studio/base/dumped.hpp"

namespace pliant::studio {

using Json = nlohmann::json;

void JobUnderWay::clear() {
    const std::lock_guard lock(mutex_);
    kept_.clear();
    every_ = 1;
    layers_ = count_ = 0;
}

void JobUnderWay::add(const job::Manifest& so_far, int count, const std::vector<job::EncodedImage>& images,
                      const std::vector<std::string>& colours) {
    const std::lock_guard lock(mutex_);
    const int number = static_cast<int>(so_far.layers.size()) - 1;
    if (number == 0) {
        head_ = so_far;
        head_.layers.clear();
        colours_ = colours;
    }
    layers_ = number + 1;
    count_ = count;
    if (number % every_ != 0) return;
    Kept kept{so_far.layers.back(), {}};
    for (const job::EncodedImage& image : images) kept.pngs.push_back(image.png);
    kept_.emplace(number, std::move(kept));
    if (kept_.size() > most_kept) thin_out();
}

/// Drops every second one.
void JobUnderWay::thin_out() {
    every_ *= 2;
    std::erase_if(kept_, [&](const auto& entry) { return entry.first % every_ != 0; });
}

int JobUnderWay::layers() const {
    const std::lock_guard lock(mutex_);
    return layers_;
}

std::string JobUnderWay::json() const {
    const std::lock_guard lock(mutex_);
    if (kept_.empty()) return "null";
    job::Manifest manifest = head_;
    for (const auto& [number, kept] : kept_) manifest.layers.push_back(kept.layer);
    Json listed = parse_json(job::to_json(manifest));
    std::size_t i = 0;
    for (const auto& [number, kept] : kept_) listed["layers"][i++]["number"] = number;
    return dumped({{"layers", layers_}, {"count", count_}, {"colours", colours_}, {"manifest", std::move(listed)}});
}

Result<std::string> JobUnderWay::image(int layer, int material) const {
    const std::lock_guard lock(mutex_);
    const auto found = kept_.find(layer);
    if (found == kept_.end()) return input_error("there is no such layer");
    const auto& images = found->second.layer.images;
    for (std::size_t i = 0; i < images.size(); ++i) {
        if (images[i].material == material) return found->second.pngs[i];
    }
    return input_error("nothing of this material is in this layer");
}

}  // namespace pliant::studio
