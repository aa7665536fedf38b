#include "geometry/meshing/sampled_volume.hpp"

#include <algorithm>
#include <cmath>
#include <variant>
#include <vector>

#include "base/core/boxes.hpp"

namespace pliant::mesh::kernel {
namespace {

/// The digits of a number in a base, mirrored at the point: a Halton sequence has these as coordinates.
double mirrored(int number, int base) {
    double value = 0;
    for (double place = 1.0 / base; number > 0; number /= base, place /= base) value += place * (number % base);
    return value;
}

Box3 common_box(const Box3& a, const Box3& b) {
    Box3 box = a;
    for (std::size_t k = 0; k < 3; ++k) {
        box.low[k] = std::max(a.low[k], b.low[k]);
        box.high[k] = std::min(a.high[k], b.high[k]);
    }
    return box;
}

/// A sum of volumes, each of the points in a box that `is_in` holds for.
class Sum {
public:
    template <class IsIn>
    void add(const Box3& box, int points, const IsIn& is_in) {
        const Vec3 size = box.high - box.low;
        if (!(size.x > 0 && size.y > 0 && size.z > 0)) return;
        int hits = 0;
        for (int i = 1; i <= points; ++i) {
            const Vec3 p{box.low.x + mirrored(i, 2) * size.x, box.low.y + mirrored(i, 3) * size.y,
                         box.low.z + mirrored(i, 5) * size.z};
            if (is_in(p)) ++hits;
        }
        const double whole = size.x * size.y * size.z;
        const double share = (hits + 1.0) / (points + 2.0);  // no certainty follows from points that are all alike
        volume_ += whole * hits / points;
        variance_ += whole * whole * share * (1 - share) / (points + 2.0);
    }
    [[nodiscard]] SampledVolume result() const { return {volume_, std::sqrt(variance_)}; }

private:
    double volume_ = 0, variance_ = 0;
};

/// So many points for each of `count` solids that many solids do not need millions.
int points_each(int points, std::size_t count) {
    constexpr std::size_t many = 100;
    constexpr int least = 200;
    return count <= many ? points : std::max(least, static_cast<int>(static_cast<std::size_t>(points) * many / count));
}

std::vector<Box3> boxes_of(std::span<const Solid> solids) {
    std::vector<Box3> boxes;
    for (const Solid& solid : solids) boxes.push_back(bounds(solid));
    return boxes;
}

/// Those of the first `count` solids that may share a point with a box.
std::vector<std::size_t> meeting(const Box3& box, const std::vector<Box3>& boxes, std::size_t count) {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < count; ++i) {
        if (boxes_meet(box, boxes[i])) found.push_back(i);
    }
    return found;
}

struct CanBeSampled {
    bool operator()(const BoxSolid&) const { return true; }
    bool operator()(const SphereSolid&) const { return true; }
    bool operator()(const CylinderSolid&) const { return true; }
    bool operator()(const PrismSolid&) const { return true; }
    bool operator()(const PolyhedronSolid&) const { return true; }
    bool operator()(const CombinedSolid& s) const { return can_be_sampled(s.parts); }
    bool operator()(const TranslatedSolid& s) const { return can_be_sampled(s.of); }
    bool operator()(const RotatedSolid& s) const { return can_be_sampled(s.of); }
    bool operator()(const RepeatedSolid& s) const { return can_be_sampled(s.of); }
    bool operator()(const EnclosedSolid&) const { return false; }
    bool operator()(const NotchesSolid&) const { return false; }
    bool operator()(const StepSolid&) const { return false; }
};

}  // namespace

bool can_be_sampled(const Solid& solid) {
    return std::visit(CanBeSampled{}, solid->shape);
}

bool can_be_sampled(std::span<const Solid> solids) {
    return std::ranges::all_of(solids, [](const Solid& solid) { return can_be_sampled(solid); });
}

SampledVolume covered_volume(const Solid& solid, std::span<const Solid> others, int points) {
    const std::vector<Box3> boxes = boxes_of(others);
    const int each = points_each(points, others.size());
    const Box3 own = bounds(solid);
    Sum sum;
    for (std::size_t i = 0; i < others.size(); ++i) {
        const Box3 box = common_box(own, boxes[i]);
        const std::vector<std::size_t> before = meeting(box, boxes, i);
        sum.add(box, each, [&](const Vec3& p) {
            return contains(others[i], p) && contains(solid, p) &&
                   std::ranges::none_of(before, [&](std::size_t j) { return contains(others[j], p); });
        });
    }
    return sum.result();
}

SampledVolume repeated_volume(std::span<const Solid> parts, int points) {
    const std::vector<Box3> boxes = boxes_of(parts);
    const int each = points_each(points, parts.size());
    Sum sum;
    for (std::size_t i = 1; i < parts.size(); ++i) {
        const std::vector<std::size_t> before = meeting(boxes[i], boxes, i);
        Box3 around;
        for (const std::size_t j : before) {
            around.add(boxes[j].low);
            around.add(boxes[j].high);
        }
        if (before.empty()) continue;
        sum.add(common_box(boxes[i], around), each, [&](const Vec3& p) {
            return contains(parts[i], p) &&
                   std::ranges::any_of(before, [&](std::size_t j) { return contains(parts[j], p); });
        });
    }
    return sum.result();
}

bool fits(double volume, double slack, const std::function<SampledVolume(int points)>& sampled) {
    constexpr int few = 2000, many = 40000;
    constexpr double doubtful = 1, wrong = 2;  // deviations; points in order are much nearer than random ones
    const auto is_off_by = [&](double deviations, int points) {
        const SampledVolume known = sampled(points);
        const double doubt = deviations * known.deviation;
        // A shape that was overlooked changes nothing at all, however small it is.
        if (std::fabs(volume) < 1e-6 * slack && known.volume > doubt + 1e-3 * slack) return true;
        return !(std::fabs(volume - known.volume) <= doubt + slack);
    };
    return !is_off_by(doubtful, few) || !is_off_by(wrong, many);
}

}  // namespace pliant::mesh::kernel
