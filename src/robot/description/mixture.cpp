#include "robot/description/mixture.hpp"

namespace pliant::material {
namespace {

/// Means of the constants of two laws of the same kind, if that is equivalent to the mean of their energies.
struct Mean {
    double s;

    [[nodiscard]] double of(double a, double b) const { return (1 - s) * a + s * b; }

    Law operator()(const NeoHookean& a, const NeoHookean& b) const {
        return NeoHookean{of(a.shear_Pa, b.shear_Pa), of(a.bulk_Pa, b.bulk_Pa)};
    }
    Law operator()(const StVenantKirchhoff& a, const StVenantKirchhoff& b) const {
        return StVenantKirchhoff{of(a.shear_Pa, b.shear_Pa), of(a.lame_Pa, b.lame_Pa)};
    }
    Law operator()(const Corotated& a, const Corotated& b) const {
        return Corotated{of(a.shear_Pa, b.shear_Pa), of(a.lame_Pa, b.lame_Pa)};
    }
    Law operator()(const Linear& a, const Linear& b) const {
        return Linear{of(a.shear_Pa, b.shear_Pa), of(a.lame_Pa, b.lame_Pa)};
    }
    Law operator()(const MooneyRivlin& a, const MooneyRivlin& b) const {
        return MooneyRivlin{of(a.c10_Pa, b.c10_Pa), of(a.c01_Pa, b.c01_Pa), of(a.bulk_Pa, b.bulk_Pa)};
    }
    Law operator()(const Yeoh& a, const Yeoh& b) const {
        return Yeoh{of(a.c10_Pa, b.c10_Pa), of(a.c20_Pa, b.c20_Pa), of(a.c30_Pa, b.c30_Pa), of(a.bulk_Pa, b.bulk_Pa)};
    }
    Law operator()(const ShapeBlend& a, const ShapeBlend& b) const {
        const double weight = of(a.weight_Pa, b.weight_Pa);
        return ShapeBlend{weight, of(a.weight_Pa * a.a, b.weight_Pa * b.a) / weight};
    }
    template <class A, class B>
    Law operator()(const A& a, const B& b) const {
        const Moduli one = moduli(Law{a}), other = moduli(Law{b});
        return NeoHookean{of(one.shear_Pa, other.shear_Pa), of(one.bulk_Pa, other.bulk_Pa)};
    }
};

}  // namespace

Law mixed(const Law& first, const Law& second, double share_of_second) {
    if (share_of_second <= 0) return first;
    if (share_of_second >= 1) return second;
    return std::visit(Mean{share_of_second}, first, second);
}

}  // namespace pliant::material
