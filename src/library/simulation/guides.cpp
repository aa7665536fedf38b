#include "library/simulation/guides.hpp"

#include <utility>
#include <vector>

#include "library/base/calls.hpp"
#include "simulation/scene/guide_slopes.hpp"

namespace pliant {

library::Guides library::guides_of(const Model::Data& model) {
    Guides guides;
    std::vector<robot::GuideSlope> slopes = value_of(robot::guide_slopes(model.scene.robot, model.scene.model));
    for (robot::GuideSlope& one : slopes) {
        guides.shown.push_back({std::move(one.name), {one.rest_m.x, one.rest_m.y, one.rest_m.z}});
        guides.points.push_back({one.path, one.point, std::move(one.slope), one.of_spring});
    }
    return guides;
}

}  // namespace pliant
