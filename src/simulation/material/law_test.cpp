// One battery for every law; a new law is one more line in `laws`.
#include "robot/description/law.hpp"

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "base/core/near.hpp"
#include "simulation/material/law_parameters.hpp"
#include "simulation/material/response.hpp"

using namespace pliant::material;
using pliant::near;
using Vector9 = Eigen::Matrix<double, 9, 1>;

namespace {

const std::vector<std::pair<std::string, Law>> laws = {
    {"neo-hookean, nu 0.3", neo_hookean(12e6, 0.3)},
    {"neo-hookean, nu 0.499", neo_hookean(12e6, 0.499)},
    {"st-venant-kirchhoff", st_venant_kirchhoff(12e6, 0.45)},
    {"shape-blend", shape_blend(12e6, 0.45)},
    {"shape-blend, rigid target", ShapeBlend{3e6, 1.0}},
    {"mooney-rivlin", MooneyRivlin{1.2e6, 0.5e6, 18e6}},
    {"yeoh", Yeoh{1.2e6, -0.1e6, 0.02e6, 18e6}},
    {"ogden, one term", Ogden{1, {2e6}, {3.1}, 18e6}},
    {"ogden, three terms", Ogden{3, {1.5e6, 0.02e6, -0.3e6}, {1.3, 5.0, -2.0}, 18e6}},
    {"corotated", corotated(12e6, 0.45)},
    {"linear", linear(12e6, 0.45)},
};

/// Deformations with det F between about 0.3 and 3, some far from rest.
std::vector<Matrix3> deformations() {
    std::srand(11);
    std::vector<Matrix3> list;
    while (list.size() < 20) {
        const Matrix3 F = Matrix3::Identity() + 0.6 * Matrix3::Random();
        if (F.determinant() > 0.3) list.push_back(F);
    }
    return list;
}

Matrix3 some_rotation() {
    return Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
}

double scale(const Law& law) {
    return stiffness_bound(law);
}

/// Central difference of f(F) along entry k of F, counted column by column.
template <typename Function>
auto difference(const Function& f, const Matrix3& F, int k) {
    using Value = decltype(f(F));
    const double h = 1e-6;
    Matrix3 plus = F;
    Matrix3 minus = F;
    plus.data()[k] += h;
    minus.data()[k] -= h;
    return Value((f(plus) - f(minus)) / (2 * h));
}

double energy_difference(const Law& law, const Matrix3& F, int k) {
    return difference([&](const Matrix3& G) { return *energy(law, G); }, F, k);
}

Vector9 stress_difference(const Law& law, const Matrix3& F, int k) {
    const Matrix3 dP = difference([&](const Matrix3& G) { return stress(law, G); }, F, k);
    return Eigen::Map<const Vector9>(dP.data());
}

}  // namespace

TEST_CASE("no stress and no energy at rest, whatever the rotation") {
    for (const auto& [name, law] : laws) {
        CAPTURE(name);
        for (const Matrix3& F : {Matrix3(Matrix3::Identity()), some_rotation()}) {
            if (!is_objective(law) && F != Matrix3::Identity()) continue;
            CHECK(stress(law, F).norm() < 1e-12 * scale(law));
            if (has_energy(law)) CHECK(std::fabs(*energy(law, F)) < 1e-12 * scale(law));
        }
    }
}

TEST_CASE("stress is the derivative of the energy") {
    for (const auto& [name, law] : laws) {
        CAPTURE(name);
        CHECK(energy(law, Matrix3::Identity()).has_value() == has_energy(law));
        if (!has_energy(law)) continue;
        for (const Matrix3& F : deformations()) {
            const Matrix3 P = stress(law, F);
            for (int k = 0; k < 9; ++k) {
                const double difference = energy_difference(law, F, k);
                CHECK(P.data()[k] == near(difference, {.absolute = 1e-6 * P.norm()}));
            }
        }
    }
}

TEST_CASE("the tangent is the derivative of the stress, symmetric where there is an energy") {
    for (const auto& [name, law] : laws) {
        CAPTURE(name);
        for (const Matrix3& F : deformations()) {
            const Matrix9 H = tangent(law, F);
            for (int k = 0; k < 9; ++k) CHECK((H.col(k) - stress_difference(law, F, k)).norm() < 1e-6 * H.norm());
            if (has_energy(law)) CHECK((H - H.transpose()).norm() < 1e-12 * H.norm());
        }
    }
}

namespace {

/// A thousandth of a parameter; of Poisson's ratio, of the way to 0.5.
double step_of(const LawParameter& parameter) {
    return 1e-3 * (parameter.name == "poisson_ratio" ? 0.5 - parameter.value : std::fabs(parameter.value));
}

/// Four-point central difference by parameter k of a law; its error goes with the fourth power of the step.
template <typename Function>
auto difference_by(const Law& law, std::size_t k, const Function& f) {
    using Value = std::decay_t<decltype(f(law))>;
    const LawParameter parameter = parameters(law)[k];
    const double value = parameter.value, h = step_of(parameter);
    const auto at = [&](double step) { return f(with_parameter(law, k, value + step)); };
    return Value((8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h));
}

}  // namespace

TEST_CASE("derivatives of stress by every constant, and by E and nu, agree with finite differences") {
    for (const auto& [name, law] : laws) {
        CAPTURE(name);
        const std::vector<LawParameter> all = parameters(law);
        for (std::size_t k = 0; k < all.size(); ++k) {
            CAPTURE(all[k].name);
            for (const Matrix3& F : deformations()) {
                const auto slopes = stress_by_constants(law, F);
                REQUIRE(slopes.size() == all[k].direction.size());
                Matrix3 rate = Matrix3::Zero();
                for (std::size_t c = 0; c < slopes.size(); ++c) rate += all[k].direction[c] * slopes[c];
                const Matrix3 expected =
                    difference_by(law, k, [&](const Law& changed) -> Matrix3 { return stress(changed, F); });
                const double rounding = 1e-12 * stress(law, F).norm() / step_of(all[k]);
                CHECK((rate - expected).norm() <= 1e-8 * expected.norm() + rounding);
            }
        }
    }
}

TEST_CASE("derivatives of the moduli by every constant agree with finite differences") {
    for (const auto& [name, law] : laws) {
        CAPTURE(name);
        const std::vector<LawParameter> all = parameters(law);
        for (std::size_t k = 0; k < all.size(); ++k) {
            CAPTURE(all[k].name);
            const Moduli rate = moduli_rate(law, all[k].direction);
            const auto shear = difference_by(law, k, [](const Law& changed) { return moduli(changed).shear_Pa; });
            const auto bulk = difference_by(law, k, [](const Law& changed) { return moduli(changed).bulk_Pa; });
            const double rounding = 1e-13 * moduli(law).bulk_Pa / step_of(all[k]);
            CHECK(rate.shear_Pa == near(shear, {.relative = 1e-8, .absolute = rounding}));
            CHECK(rate.bulk_Pa == near(bulk, {.relative = 1e-8, .absolute = rounding}));
        }
    }
}

TEST_CASE("a law's parameters are its constants, and the E and nu that it was made from") {
    const std::vector<LawParameter> all = parameters(Law(corotated(12e6, 0.45)));
    REQUIRE(all.size() == 4);
    CHECK(all[2].name == "youngs_modulus");
    CHECK(all[2].value == near(12e6, {.relative = 1e-12}));
    CHECK(all[3].name == "poisson_ratio");
    CHECK(all[3].value == near(0.45, {.relative = 1e-12}));
    const Law changed = with_parameter(corotated(12e6, 0.45), 3, 0.4);
    CHECK(std::get<Corotated>(changed).lame_Pa == near(corotated(12e6, 0.4).lame_Pa, {.relative = 1e-12}));
    const Law ogden = Ogden{2, {1e6, 2e6}, {3, 4}, 1e8};
    REQUIRE(parameters(ogden).size() == 5);
    CHECK(parameters(ogden)[3].name == "alpha_2");
    CHECK(std::get<Ogden>(with_parameter(ogden, 3, 5)).alpha[1] == 5);
}

TEST_CASE("rotating the deformed body rotates the stress and keeps the energy (objectivity)") {
    const Matrix3 Q = some_rotation();
    for (const auto& [name, law] : laws) {
        CAPTURE(name);
        if (!is_objective(law)) continue;
        for (const Matrix3& F : deformations()) {
            CHECK((stress(law, Q * F) - Q * stress(law, F)).norm() < 1e-11 * (scale(law) + stress(law, F).norm()));
            if (has_energy(law)) CHECK(*energy(law, Q * F) == near(*energy(law, F), {.relative = 1e-11}));
        }
    }
}

TEST_CASE("small strains follow Hooke's law with the given E and nu") {
    const double E = 12e6;
    const double nu = 0.4;
    const auto [mu, K] = moduli(E, nu);
    CHECK(bulk_modulus(mu, nu) == near(K, {.relative = 1e-12}));
    const std::vector<Law> same = {neo_hookean(E, nu),
                                   shape_blend(E, nu),
                                   st_venant_kirchhoff(E, nu),
                                   corotated(E, nu),
                                   linear(E, nu),
                                   MooneyRivlin{0.35 * mu, 0.15 * mu, K},
                                   Yeoh{mu / 2, 0.3 * mu, 0.1 * mu, K},
                                   Ogden{2, {1.5 * mu, -0.5 * mu}, {1.7, 4.0}, K}};
    for (const Law& law : same) {
        CAPTURE(name(law));
        CHECK(youngs_modulus(moduli(law)) == near(E, {.relative = 1e-12}));
        CHECK(poisson_ratio(moduli(law)) == near(nu, {.relative = 1e-12}));
        const double strain = 1e-7;  // uniaxial stress: sideways contraction nu
        const Matrix3 F = Eigen::Vector3d(1 + strain, 1 - nu * strain, 1 - nu * strain).asDiagonal();
        const Matrix3 P = stress(law, F);
        CHECK(P(0, 0) == near(E * strain, {.relative = 1e-5}));
        CHECK(std::fabs(P(1, 1)) < 1e-5 * E * strain);
        const Eigen::SelfAdjointEigenSolver<Matrix9> eigen(tangent(law, Matrix3::Identity()));
        CHECK(eigen.eigenvalues().maxCoeff() == near(stiffness_bound(law), {.relative = 1e-12}));
    }
}

TEST_CASE("rotating the body before deformation changes nothing (isotropy)") {
    const Matrix3 Q = some_rotation();
    for (const auto& [name, law] : laws) {
        CAPTURE(name);
        if (!is_objective(law)) continue;
        for (const Matrix3& F : deformations()) {
            CHECK((stress(law, F * Q) - stress(law, F) * Q).norm() < 1e-11 * (scale(law) + stress(law, F).norm()));
            if (has_energy(law)) CHECK(*energy(law, F * Q) == near(*energy(law, F), {.relative = 1e-11}));
        }
    }
}

TEST_CASE("only the linear law takes rotations for strains; rotated with its frame it is isotropic") {
    for (const auto& [name, law] : laws) {
        CAPTURE(name);
        CHECK(is_objective(law) == (stress(law, some_rotation()).norm() < 1e-12 * scale(law)));
    }
    const Linear law = linear(12e6, 0.45);
    const Matrix3 Q = some_rotation();
    for (const Matrix3& F : deformations()) {
        const Matrix3 turned = Q * F * Q.transpose();
        CHECK((stress(law, turned) - Q * stress(law, F) * Q.transpose()).norm() < 1e-11 * scale(law));
        CHECK(*energy(law, turned) / *energy(law, F) == near(1, {.relative = 1e-11}));
    }
    // About an axis by t both strains across it are cos t - 1: stress by hand, along and across the axis.
    const double t = 0.4, e = std::cos(t) - 1;
    const Matrix3 P = stress(law, Eigen::AngleAxisd(t, Eigen::Vector3d::UnitX()).toRotationMatrix());
    CHECK(P(0, 0) / (law.lame_Pa * 2 * e) == near(1, {.relative = 1e-12}));
    CHECK(P(1, 1) / (2 * (law.shear_Pa + law.lame_Pa) * e) == near(1, {.relative = 1e-12}));
    CHECK(std::fabs(P(1, 2)) < 1e-9 * scale(law));
}

namespace {

/// Nominal stress along the first axis of an incompressible body, from its energy w(l1, l2, l3) by hand.
struct ClosedForm {
    std::string name;
    Law law;
    double (*uniaxial)(double l);     ///< stretches l, l^(-1/2), l^(-1/2)
    double (*equibiaxial)(double l);  ///< stretches l, l, l^(-2)
    double (*shear)(double g);        ///< P_12 of F = I + g e1 e2^T
};

// The bulk modulus is 1e7 times the shear modulus, so J - 1 is of the order of 1e-7 to 1e-6.
constexpr double stiff = 2e13;

const std::vector<ClosedForm> closed_forms = {
    {"neo-hookean", NeoHookean{2e6, stiff}, [](double l) { return 2e6 * (l - 1 / (l * l)); },
     [](double l) { return 2e6 * (l - std::pow(l, -5)); }, [](double g) { return 2e6 * g; }},
    {"mooney-rivlin", MooneyRivlin{0.7e6, 0.3e6, stiff},
     [](double l) { return 2 * (l - 1 / (l * l)) * (0.7e6 + 0.3e6 / l); },
     [](double l) { return 2 * (l - std::pow(l, -5)) * (0.7e6 + 0.3e6 * l * l); },
     [](double g) { return 2 * (0.7e6 + 0.3e6) * g; }},
    {"yeoh", Yeoh{1e6, -0.05e6, 0.01e6, stiff},
     [](double l) {
         const double x = l * l + 2 / l - 3;
         return 2 * (l - 1 / (l * l)) * (1e6 - 0.1e6 * x + 0.03e6 * x * x);
     },
     [](double l) {
         const double x = 2 * l * l + std::pow(l, -4) - 3;
         return 2 * (l - std::pow(l, -5)) * (1e6 - 0.1e6 * x + 0.03e6 * x * x);
     },
     [](double g) { return 2 * g * (1e6 - 0.1e6 * g * g + 0.03e6 * g * g * g * g); }},
    {"ogden", Ogden{2, {1.8e6, 0.2e6}, {1.3, 5.0}, stiff},
     [](double l) {
         return 2 * 1.8e6 / 1.3 * (std::pow(l, 0.3) - std::pow(l, -1.65)) +
                2 * 0.2e6 / 5 * (std::pow(l, 4) - std::pow(l, -3.5));
     },
     [](double l) {
         return 2 * 1.8e6 / 1.3 * (std::pow(l, 0.3) - std::pow(l, -3.6)) +
                2 * 0.2e6 / 5 * (std::pow(l, 4) - std::pow(l, -11));
     },
     [](double g) {
         // dw/dg with l - 1/l = g, so dl/dg = l^2 / (1 + l^2).
         const double l = g / 2 + std::sqrt(1 + g * g / 4);
         const double slope = 2 * 1.8e6 / 1.3 * (std::pow(l, 0.3) - std::pow(l, -2.3)) +
                              2 * 0.2e6 / 5 * (std::pow(l, 4) - std::pow(l, -6));
         return slope * l * l / (1 + l * l);
     }},
};

/// The stretch sideways that leaves no stress there, with the stretch along the other axes given; nearly 1/(l1 l2).
Matrix3 stretched(const Law& law, double l, bool both) {
    double side = both ? 1 / (l * l) : 1 / std::sqrt(l);
    for (int i = 0; i < 50; ++i) {
        const Matrix3 F = Eigen::Vector3d(l, both ? l : side, side).asDiagonal();
        const Matrix9 H = tangent(law, F);
        const double slope = both ? H(8, 8) : H(8, 8) + H(8, 4);
        side -= stress(law, F)(2, 2) / slope;
    }
    return Eigen::Vector3d(l, both ? l : side, side).asDiagonal();
}

}  // namespace

TEST_CASE("nearly incompressible bodies follow the closed forms of tension, equibiaxial stretch and shear") {
    for (const ClosedForm& form : closed_forms) {
        CAPTURE(form.name);
        for (const double l : {0.6, 0.9, 1.2, 1.7, 2.5}) {
            CAPTURE(l);
            CHECK(stress(form.law, stretched(form.law, l, false))(0, 0) == near(form.uniaxial(l), {.relative = 1e-5}));
            CHECK(stress(form.law, stretched(form.law, l, true))(0, 0) ==
                  near(form.equibiaxial(l), {.relative = 1e-5}));
        }
        for (const double g : {0.1, 0.8, 2.0}) {
            Matrix3 F = Matrix3::Identity();
            F(0, 1) = g;
            CAPTURE(g);
            CHECK(stress(form.law, F)(0, 1) == near(form.shear(g), {.relative = 1e-9}));
        }
    }
}

TEST_CASE("corotated follows closed forms for a bar of constant width and for a volume change") {
    const Corotated law{2e6, 5e6};
    // Pascal: where l is 1 the stress is 0, of terms of 1e6 to 1e7 Pa.
    for (const double l : {0.6, 1.0, 1.8}) {
        const Matrix3 bar = Eigen::Vector3d(l, 1, 1).asDiagonal();
        CHECK(stress(law, bar)(0, 0) == near(2 * 2e6 * (l - 1) + 5e6 * (l - 1), {.relative = 1e-12, .absolute = 1e-6}));
        CHECK(stress(law, bar)(1, 1) == near(5e6 * (l - 1) * l, {.relative = 1e-12, .absolute = 1e-6}));
        const Matrix3 ball = l * Matrix3::Identity();
        const double J = l * l * l;
        CHECK(stress(law, ball)(2, 2) ==
              near(4e6 * (l - 1) + 5e6 * (J - 1) * l * l, {.relative = 1e-12, .absolute = 1e-6}));
    }
}

TEST_CASE("ogden with exponents 2 and -2 equals mooney-rivlin, also at equal and nearly equal stretches") {
    const Law ogden = Ogden{2, {1.4e6, 0.6e6}, {2.0, -2.0}, 18e6};
    const Law mooney = MooneyRivlin{0.7e6, 0.3e6, 18e6};
    std::vector<Matrix3> list = deformations();
    const Matrix3 Q = some_rotation();
    for (const double gap : {0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3}) {
        for (const double l : {0.7, 1.0, 1.6}) {
            list.emplace_back(Q * Eigen::Vector3d(l, l + gap, 1.1).asDiagonal() * Q);
            list.emplace_back(Eigen::Vector3d(l, l * (1 + gap), l * (1 - gap)).asDiagonal());
        }
    }
    for (const Matrix3& F : list) {
        // Near rest an energy is a small difference of terms of 1e6 Pa.
        CHECK(*energy(ogden, F) == near(*energy(mooney, F), {.relative = 1e-12, .absolute = 1e-6}));
        CHECK((stress(ogden, F) - stress(mooney, F)).norm() < 1e-11 * scale(mooney));
        const Matrix9 H = tangent(mooney, F);
        CHECK((tangent(ogden, F) - H).norm() < 1e-11 * H.norm());
    }
}

TEST_CASE("the thesis' example of 12 and 45 MPa has its shape parameters") {
    CHECK(shape_parameter_of_thesis(45.0 / 12) == near(7.08, {.relative = 1e-3}));
    CHECK(shape_parameter_small_strain(45.0 / 12) == near(5.125, {.relative = 1e-12}));
}
