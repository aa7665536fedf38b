#include "simulation/gradient/objective.hpp"

namespace pliant::sim {

Judgement squared_distance(std::span<const double> values, std::span<const double> wanted,
                           std::span<const double> weights) {
    Judgement judgement;
    for (std::size_t k = 0; k < values.size(); ++k) {
        const double off = values[k] - wanted[k], weight = weights.empty() ? 1 : weights[k];
        judgement.value += weight * off * off;
        judgement.slopes.push_back(2 * weight * off);
    }
    return judgement;
}

Objective at_end(const Measure& measure, int steps) {
    return {{measure}, [steps](int step, std::span<const double> values) {
                return step == steps ? Judgement{values[0], {1}} : Judgement{};
            }};
}

std::vector<Measure> along_axes(Measure measure) {
    std::vector<Measure> all;
    for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
        measure.direction = axis;
        all.push_back(measure);
    }
    return all;
}

}  // namespace pliant::sim
