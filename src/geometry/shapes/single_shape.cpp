#include "geometry/shapes/single_shape.hpp"

#include "base/core/rotation.hpp"

namespace pliant::mesh {
namespace {

template <class Place>
SphereSolid placed(const SphereSolid& sphere, const Place& place) {
    return {place(sphere.center), sphere.radius};
}

template <class Place>
CylinderSolid placed(const CylinderSolid& cylinder, const Place& place) {
    return {place(cylinder.from), place(cylinder.to), cylinder.radius};
}

template <class Shape>
std::optional<Shape> single(const Solid& solid) {
    if (const auto* shape = std::get_if<Shape>(&solid->shape)) return *shape;
    if (const auto* moved = std::get_if<TranslatedSolid>(&solid->shape)) {
        const std::optional<Shape> inner = single<Shape>(moved->of);
        if (!inner) return std::nullopt;
        return placed(*inner, [&](const Vec3& p) { return p + moved->offset; });
    }
    if (const auto* around = std::get_if<RotatedSolid>(&solid->shape)) {
        const std::optional<Shape> inner = single<Shape>(around->of);
        if (!inner) return std::nullopt;
        return placed(*inner, [&](const Vec3& p) {
            return turned(p - around->center, unit(around->axis), around->angle_rad, around->center);
        });
    }
    return std::nullopt;
}

}  // namespace

std::optional<SphereSolid> single_sphere(const Solid& solid) {
    return single<SphereSolid>(solid);
}

std::optional<CylinderSolid> single_cylinder(const Solid& solid) {
    return single<CylinderSolid>(solid);
}

}  // namespace pliant::mesh
