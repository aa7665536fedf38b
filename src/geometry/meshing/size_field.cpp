#include "geometry/meshing/size_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/core/segment.hpp"

namespace pliant::mesh {
namespace {

constexpr double least_share = 1.0 / 8;
/// Edge length grows by this fraction of the distance from a small-size region.
constexpr double growth = 0.5;

}  // namespace

SizeField::SizeField(std::span<const BodyGeometry> bodies, const MeshSettings& settings)
    : size_(settings.size), cable_size_(settings.size_near_cables), cables_(settings.cables) {
    for (const BodyGeometry& body : bodies) body_.push_back(body.size > 0 ? body.size : size_);
}

SizeField::Cell SizeField::cell_of(const Vec3& p) const {
    Cell cell{};
    for (std::size_t k = 0; k < 3; ++k) cell[k] = static_cast<int>(std::floor(p[k] / size_));
    return cell;
}

void SizeField::add_walls(const std::vector<WallSample>& walls, double elements) {
    for (const WallSample& wall : walls) {
        const double wanted = wall.thickness / elements;
        if (wanted >= size_) continue;
        too_thin_ = too_thin_ || wanted < least_share * size_;
        const double size = std::max(wanted, least_share * size_);
        const Cell middle = cell_of(wall.at);
        for (int i = -1; i <= 1; ++i) {
            for (int j = -1; j <= 1; ++j) {
                for (int k = -1; k <= 1; ++k) {
                    const Cell cell{middle[0] + i, middle[1] + j, middle[2] + k};
                    double& least = walls_.try_emplace(cell, size_).first->second;
                    least = std::min(least, i == 0 && j == 0 && k == 0 ? size : std::min(size_, 1.5 * size));
                }
            }
        }
    }
}

double SizeField::near_cables(const Vec3& p) const {
    if (cable_size_ <= 0) return std::numeric_limits<double>::infinity();
    double away = std::numeric_limits<double>::infinity();
    for (const auto& points : cables_) {
        for (std::size_t i = 1; i < points.size(); ++i)
            away = std::min(away, distance_to_segment(p, points[i - 1], points[i]));
    }
    return cable_size_ + growth * std::max(0.0, away - 2 * cable_size_);
}

double SizeField::near_walls(const Vec3& p) const {
    const auto found = walls_.find(cell_of(p));
    return found == walls_.end() ? std::numeric_limits<double>::infinity() : found->second;
}

double SizeField::at(std::size_t body, const Vec3& p) const {
    return std::min({body_[body], near_cables(p), near_walls(p)});
}

bool SizeField::uniform() const {
    const auto same = [&](double size) { return size == size_; };
    return std::all_of(body_.begin(), body_.end(), same) && (cable_size_ <= 0 || cables_.empty()) && walls_.empty();
}

}  // namespace pliant::mesh
