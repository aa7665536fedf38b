#include "robot/description/regions.hpp"

#include <algorithm>
#include <limits>

namespace pliant::robot {

std::vector<Region> regions_of(const Robot& robot) {
    std::vector<Region> regions;
    for (std::size_t i = 0; i < robot.bodies.size(); ++i) {
        const BodySpec& body = robot.bodies[i];
        regions.push_back({Region::Use::body, i, "body", body.name, &body.geometry, body.line, true});
    }
    for (std::size_t i = 0; i < robot.chambers.size(); ++i) {
        const ChamberSpec& chamber = robot.chambers[i];
        if (std::holds_alternative<SurfaceFile>(chamber.air) || std::holds_alternative<CavityAt>(chamber.air)) continue;
        regions.push_back(
            {Region::Use::chamber, i, "chamber", chamber.name, &chamber.air, chamber.line, chamber.elements});
    }
    const bool gaps_act =
        std::any_of(robot.cables.begin(), robot.cables.end(), [](const CableSpec& c) { return c.gap_elements; });
    for (std::size_t i = 0; i < robot.gaps.size(); ++i) {
        const GapSpec& gap = robot.gaps[i];
        regions.push_back({Region::Use::gap, i, "gap", gap.name, &gap.space, gap.line, gaps_act});
    }
    return regions;
}

double softest_Pa(const Robot& robot) {
    double softest = std::numeric_limits<double>::infinity();
    for (const BodySpec& body : robot.bodies) {
        const MaterialSpec& material = robot.materials[static_cast<std::size_t>(body.material)];
        softest = std::min(softest, material::youngs_modulus(material::moduli(material.law)));
    }
    return softest;
}

}  // namespace pliant::robot
