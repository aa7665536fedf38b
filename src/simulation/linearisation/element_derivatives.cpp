#include "simulation/linearisation/element_derivatives.hpp"

#include <span>

#include "base/linalg/vectors.hpp"
#include "simulation/material/law_parameters.hpp"

namespace pliant::sim {
namespace {

using linalg::Matrix3;
using Vector9 = Eigen::Matrix<double, 9, 1>;

using linalg::view;

/// forces += P grad N_a.
void add_stress(const Elements& elements, std::size_t t, int q, const Matrix3& P, Eigen::VectorXd& forces) {
    for (int a = 0; a < static_cast<int>(elements.nodes_per_tet()); ++a)
        forces.segment<3>(3 * elements.node_of(t, a)) += P * linalg::vector(elements.shape_gradient(t, q, a));
}

}  // namespace

void add_law_force(const Elements& elements, std::size_t material, const std::vector<double>& direction,
                   const Eigen::VectorXd& x, Eigen::VectorXd& forces) {
    for (std::size_t t = 0; t < elements.tet_count(); ++t) {
        if (elements.material(t) != static_cast<int>(material)) continue;
        for (int q = 0; q < elements.points_per_tet(); ++q) {
            const auto slopes =
                material::stress_by_constants(elements.law(t), elements.deformation_gradient(t, q, view(x)));
            Matrix3 P = Matrix3::Zero();
            for (std::size_t c = 0; c < slopes.size(); ++c) P += direction[c] * slopes[c];
            add_stress(elements, t, q, elements.point_volume(t, q) * P, forces);
        }
    }
}

std::vector<std::vector<double>> law_products(const Elements& elements, const Description& description,
                                              const Eigen::VectorXd& x, const Eigen::VectorXd& weights) {
    std::vector<std::vector<double>> products;
    for (const Material& material : description.materials)
        products.emplace_back(material::parameters(material.law)[0].direction.size(), 0.0);
    for (std::size_t t = 0; t < elements.tet_count(); ++t) {
        std::vector<double>& of = products[static_cast<std::size_t>(elements.material(t))];
        for (int q = 0; q < elements.points_per_tet(); ++q) {
            const Matrix3 change = elements.point_volume(t, q) * elements.deformation_gradient(t, q, view(weights));
            const auto slopes =
                material::stress_by_constants(elements.law(t), elements.deformation_gradient(t, q, view(x)));
            for (std::size_t c = 0; c < slopes.size(); ++c) of[c] += slopes[c].cwiseProduct(change).sum();
        }
    }
    return products;
}

std::vector<double> tet_volumes(const Elements& elements, std::size_t material) {
    std::vector<double> volumes(elements.tet_count(), 0.0);
    for (std::size_t t = 0; t < volumes.size(); ++t) {
        for (int q = 0; q < elements.points_per_tet() && elements.material(t) == static_cast<int>(material); ++q)
            volumes[t] += elements.point_volume(t, q);
    }
    return volumes;
}

void add_weight(const Elements& elements, std::size_t material, const Eigen::Vector3d& acceleration,
                Eigen::VectorXd& forces) {
    for (std::size_t t = 0; t < elements.tet_count(); ++t) {
        if (elements.material(t) != static_cast<int>(material)) continue;
        for (int q = 0; q < elements.points_per_tet(); ++q) {
            for (int a = 0; a < static_cast<int>(elements.nodes_per_tet()); ++a)
                forces.segment<3>(3 * elements.node_of(t, a)) +=
                    elements.point_volume(t, q) * elements.shape_value(q, a) * acceleration;
        }
    }
}

void add_rest_product(const Elements& elements, const Masses& masses, const Eigen::VectorXd& x,
                      const Eigen::VectorXd& motion, Eigen::VectorXd& forces) {
    std::vector<double> mass_rate(elements.tet_count(), 0.0);
    for (std::size_t t = 0; t < elements.tet_count(); ++t) {
        const double density = masses.density_kg_m3[static_cast<std::size_t>(elements.material(t))];
        for (int q = 0; q < elements.points_per_tet(); ++q) {
            const Matrix3 F = elements.deformation_gradient(t, q, view(x));
            const Matrix3 L = elements.deformation_gradient(t, q, view(motion));
            const Matrix3 P = material::stress(elements.law(t), F);
            const Matrix3 dF = -F * L;
            const Vector9 dP = material::tangent(elements.law(t), F) * Eigen::Map<const Vector9>(dF.data());
            const double volume = elements.point_volume(t, q);
            const Matrix3 change = L.trace() * P + Eigen::Map<const Matrix3>(dP.data()) - P * L.transpose();
            add_stress(elements, t, q, volume * change, forces);
            const double mass = density * volume * L.trace();
            mass_rate[t] += mass;
            for (int a = 0; a < static_cast<int>(elements.nodes_per_tet()); ++a)
                forces.segment<3>(3 * elements.node_of(t, a)) += mass * elements.shape_value(q, a) * masses.weight;
        }
    }
    if (masses.acceleration.size() == 0) return;
    elements.apply_mass(mass_rate, view(masses.acceleration), {forces.data(), static_cast<std::size_t>(forces.size())});
}

void add_rest_weights(const Elements& elements, const Masses& masses, const Eigen::VectorXd& x,
                      const Eigen::VectorXd& weights, Eigen::VectorXd& result) {
    std::vector<double> by_mass(elements.tet_count(), 0.0);
    if (masses.acceleration.size() > 0) by_mass = elements.mass_products(view(weights), view(masses.acceleration));
    for (std::size_t t = 0; t < elements.tet_count(); ++t) {
        const double density = masses.density_kg_m3[static_cast<std::size_t>(elements.material(t))];
        for (int q = 0; q < elements.points_per_tet(); ++q) {
            const Matrix3 F = elements.deformation_gradient(t, q, view(x));
            const Matrix3 G = elements.deformation_gradient(t, q, view(weights));
            const Matrix3 P = material::stress(elements.law(t), F);
            const Vector9 M = material::tangent(elements.law(t), F).transpose() * Eigen::Map<const Vector9>(G.data());
            double along = P.cwiseProduct(G).sum() + density * by_mass[t];
            for (int a = 0; a < static_cast<int>(elements.nodes_per_tet()); ++a)
                along += density * elements.shape_value(q, a) *
                         masses.weight.dot(weights.segment<3>(3 * elements.node_of(t, a)));
            const Matrix3 change =
                along * Matrix3::Identity() - F.transpose() * Eigen::Map<const Matrix3>(M.data()) - G.transpose() * P;
            add_stress(elements, t, q, elements.point_volume(t, q) * change, result);
        }
    }
}

}  // namespace pliant::sim
