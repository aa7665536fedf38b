#include "robot/description/mixture.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"
#include "simulation/material/response.hpp"

using namespace pliant;
using namespace pliant::material;

namespace {

Matrix3 some_deformation() {
    Matrix3 F;
    F << 1.3, 0.1, 0, -0.05, 0.9, 0.2, 0.1, 0, 1.05;
    return F;
}

}  // namespace

TEST_CASE("the stress of a mixture of two materials of one law is the weighted mean") {
    const std::pair<Law, Law> pairs[] = {{neo_hookean(1e6, 0.45), neo_hookean(5e6, 0.3)},
                                         {st_venant_kirchhoff(1e6, 0.45), st_venant_kirchhoff(5e6, 0.3)},
                                         {corotated(1e6, 0.4), corotated(5e6, 0.3)},
                                         {MooneyRivlin{1e6, 2e5, 1e8}, MooneyRivlin{3e6, 1e5, 2e8}},
                                         {Yeoh{1e6, -1e4, 1e3, 1e8}, Yeoh{3e6, 1e5, 0, 2e8}},
                                         {shape_blend(1e6, 0.4), shape_blend(5e6, 0.2)}};
    const Matrix3 F = some_deformation();
    for (const auto& [soft, hard] : pairs) {
        CAPTURE(name(soft));
        const Matrix3 mean = 0.7 * stress(soft, F) + 0.3 * stress(hard, F);
        CHECK((stress(mixed(soft, hard, 0.3), F) - mean).norm() < 1e-9 * mean.norm());
        CHECK((stress(mixed(soft, hard, 0), F) - stress(soft, F)).norm() == 0);
        CHECK((stress(mixed(soft, hard, 1), F) - stress(hard, F)).norm() == 0);
    }
}

TEST_CASE("a mixture of two laws is neo-Hookean with the mean moduli") {
    const Law soft = neo_hookean(1e6, 0.45), hard = Ogden{1, {2e6}, {3}, 1e8};
    const Law mix = mixed(soft, hard, 0.25);
    REQUIRE(std::holds_alternative<NeoHookean>(mix));
    CHECK(moduli(mix).shear_Pa ==
          near(0.75 * moduli(soft).shear_Pa + 0.25 * moduli(hard).shear_Pa, {.relative = 1e-5}));
    CHECK(moduli(mix).bulk_Pa == near(0.75 * moduli(soft).bulk_Pa + 0.25 * moduli(hard).bulk_Pa, {.relative = 1e-12}));
}
