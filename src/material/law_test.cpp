// One battery for every law; a new law is one more line in `laws`.
#include "material/law.hpp"

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <string>
#include <vector>

using namespace pliant::material;
using Vector9 = Eigen::Matrix<double, 9, 1>;

namespace {

const std::vector<std::pair<std::string, Law>> laws = {
    {"neo-hookean, nu 0.3", neo_hookean(12e6, 0.3)},          {"neo-hookean, nu 0.499", neo_hookean(12e6, 0.499)},
    {"st-venant-kirchhoff", st_venant_kirchhoff(12e6, 0.45)}, {"shape-blend", shape_blend(12e6, 0.45)},
    {"shape-blend, rigid target", ShapeBlend{3e6, 1.0}},
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

}  // namespace

TEST_CASE("no stress and no energy at rest, whatever the rotation") {
    for (const auto& [name, law] : laws) {
        CAPTURE(name);
        for (const Matrix3& F : {Matrix3(Matrix3::Identity()), some_rotation()}) {
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
            const double h = 1e-6;
            for (int k = 0; k < 9; ++k) {
                Matrix3 plus = F;
                Matrix3 minus = F;
                plus.data()[k] += h;
                minus.data()[k] -= h;
                const double difference = (*energy(law, plus) - *energy(law, minus)) / (2 * h);
                CHECK(P.data()[k] == doctest::Approx(difference).epsilon(1e-6).scale(P.norm()));
            }
        }
    }
}

TEST_CASE("the tangent is the derivative of the stress, symmetric where there is an energy") {
    for (const auto& [name, law] : laws) {
        CAPTURE(name);
        for (const Matrix3& F : deformations()) {
            const Matrix9 H = tangent(law, F);
            const double h = 1e-6;
            for (int k = 0; k < 9; ++k) {
                Matrix3 plus = F;
                Matrix3 minus = F;
                plus.data()[k] += h;
                minus.data()[k] -= h;
                const Matrix3 difference = (stress(law, plus) - stress(law, minus)) / (2 * h);
                CHECK((H.col(k) - Eigen::Map<const Vector9>(difference.data())).norm() < 1e-6 * H.norm());
            }
            if (has_energy(law)) CHECK((H - H.transpose()).norm() < 1e-12 * H.norm());
        }
    }
}

TEST_CASE("a rotation of the deformed body rotates the stress and leaves the energy") {
    const Matrix3 Q = some_rotation();
    for (const auto& [name, law] : laws) {
        CAPTURE(name);
        for (const Matrix3& F : deformations()) {
            CHECK((stress(law, Q * F) - Q * stress(law, F)).norm() < 1e-11 * (scale(law) + stress(law, F).norm()));
            if (has_energy(law)) CHECK(*energy(law, Q * F) == doctest::Approx(*energy(law, F)).epsilon(1e-11));
        }
    }
}

TEST_CASE("small strains follow Hooke's law with the given E and nu") {
    const double E = 12e6;
    const double nu = 0.4;
    for (const Law& law : {Law(neo_hookean(E, nu)), Law(shape_blend(E, nu)), Law(st_venant_kirchhoff(E, nu))}) {
        const double strain = 1e-7;  // uniaxial stress: sideways contraction nu
        const Matrix3 F = Eigen::Vector3d(1 + strain, 1 - nu * strain, 1 - nu * strain).asDiagonal();
        const Matrix3 P = stress(law, F);
        CHECK(P(0, 0) == doctest::Approx(E * strain).epsilon(1e-5));
        CHECK(std::fabs(P(1, 1)) < 1e-5 * E * strain);
        const Eigen::SelfAdjointEigenSolver<Matrix9> eigen(tangent(law, Matrix3::Identity()));
        CHECK(eigen.eigenvalues().maxCoeff() == doctest::Approx(stiffness_bound(law)));
    }
}

TEST_CASE("shape parameters of the thesis' example, 12 and 45 MPa") {
    CHECK(shape_parameter_of_thesis(45.0 / 12) == doctest::Approx(7.08).epsilon(1e-3));
    CHECK(shape_parameter_small_strain(45.0 / 12) == doctest::Approx(5.125));
}
