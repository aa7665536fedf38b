#include "simulation/scene/build_grades.hpp"

#include <array>
#include <cmath>

#include "base/core/share.hpp"
#include "robot/description/mixture.hpp"

namespace pliant::robot {
namespace {

/// The materials of grades; added when first used.
class GradeMaterials {
public:
    GradeMaterials(ModelDraft& draft, int first, int second) : draft_(draft), first_(first), second_(second) {
        known_.fill(-1);
        known_.front() = first;
        known_.back() = second;
    }

    int at(double share) {
        const auto grade = static_cast<std::size_t>(std::lround(share * grades));
        if (known_[grade] < 0) known_[grade] = add(static_cast<double>(grade) / grades);
        return known_[grade];
    }

private:
    int add(double share) {
        auto& materials = draft_.description.materials;
        const sim::Material &a = materials[static_cast<std::size_t>(first_)],
                            &b = materials[static_cast<std::size_t>(second_)];
        sim::Material mixture{fmt::format("{} with {:.0f} % {}", a.name, 100 * share, b.name),
                              material::mixed(a.law, b.law, share),
                              (1 - share) * a.density_kg_m3 + share * b.density_kg_m3};
        materials.push_back(std::move(mixture));
        return static_cast<int>(materials.size()) - 1;
    }

    ModelDraft& draft_;
    int first_, second_;
    std::array<int, grades + 1> known_{};
};

void grade(ModelDraft& draft, const BodySpec& body, int region) {
    sim::Description& d = draft.description;
    const PrintBlend& blend = *body.blend;
    const double unit_m = draft.robot.unit_m;
    GradeMaterials materials(draft, body.material, blend.material);
    for (std::size_t t = 0; t < d.mesh.tet_count(); ++t) {
        if (d.mesh.region[t] != region) continue;
        Vec3 middle;
        for (std::size_t c = 0; c < 4; ++c) middle += 0.25 * d.mesh.points[static_cast<std::size_t>(d.mesh.tet(t)[c])];
        d.material_of_tet[t] = materials.at(share_along(blend.shares, unit_m * blend.from, unit_m * blend.to, middle));
    }
}

}  // namespace

void add_grades(ModelDraft& draft) {
    const auto& bodies = draft.robot.bodies;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        if (!bodies[b].blend) continue;
        sim::Description& d = draft.description;
        if (d.material_of_tet.empty()) {
            d.material_of_tet.reserve(d.mesh.region.size());
            for (const int region : d.mesh.region)
                d.material_of_tet.push_back(d.material_of_region[static_cast<std::size_t>(region)]);
        }
        grade(draft, bodies[b], draft.kept_region(draft.region_of(Region::Use::body, bodies[b].name)));
    }
}

}  // namespace pliant::robot
