#include "geometry/shapes/shape_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <variant>
#include <vector>

namespace pliant::mesh {
namespace {

/// What a drawing says of the shapes of a solid.
struct ShapeNames {
    std::vector<std::string>* names;
    bool* round;

    void operator()(const BoxSolid& s) const { tell("box from", s.low); }
    void operator()(const SphereSolid& s) const {
        *round = true;
        tell("sphere at", s.center);
    }
    void operator()(const CylinderSolid& s) const {
        *round = true;
        tell("cylinder from", s.from);
    }
    void operator()(const PrismSolid&) const { tell("a prism"); }
    void operator()(const PolyhedronSolid&) const { tell("a surface"); }
    void operator()(const StepSolid&) const { tell("a STEP file"); }
    void operator()(const TranslatedSolid& s) const { std::visit(*this, s.of->shape); }
    void operator()(const RotatedSolid& s) const { std::visit(*this, s.of->shape); }
    void operator()(const RepeatedSolid& s) const { std::visit(*this, s.of->shape); }
    void operator()(const CombinedSolid& s) const { add(s.parts); }
    void operator()(const EnclosedSolid& s) const { add(s.walls); }
    void operator()(const NotchesSolid& s) const { add(s.walls); }
    void add(std::span<const Solid> solids) const {
        for (const Solid& solid : solids) std::visit(*this, solid->shape);
    }
    void tell(const char* what, const Vec3& at) const {
        tell(fmt::format("the {} ({:.6g}, {:.6g}, {:.6g})", what, at.x, at.y, at.z));
    }
    void tell(std::string name) const {
        if (std::ranges::find(*names, name) == names->end()) names->push_back(std::move(name));
    }
};

}  // namespace

std::string shapes_of(std::span<const Solid> solids) {
    constexpr std::size_t most = 4;
    std::vector<std::string> names;
    bool round = false;
    ShapeNames{&names, &round}.add(solids);
    std::string shown;
    for (std::size_t i = 0; i < std::min(names.size(), most); ++i) shown += (i == 0 ? "" : ", ") + names[i];
    return names.size() <= most ? shown : fmt::format("{} and {} other shapes", shown, names.size() - most);
}

bool has_round_shapes(const Solid& solid) {
    std::vector<std::string> names;
    bool round = false;
    ShapeNames{&names, &round}.add({&solid, 1});
    return round;
}

}  // namespace pliant::mesh
