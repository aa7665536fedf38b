#include "simulation/linearisation/element_derivatives.hpp"

#include <algorithm>
#include <span>

#include "base/core/parallel.hpp"
#include "base/linalg/vectors.hpp"
#include "simulation/material/law_parameters.hpp"

namespace pliant::sim {
namespace {

constexpr std::size_t tets_at_once = 512;

using linalg::Matrix3;
using linalg::Matrix9;
using Vector9 = Eigen::Matrix<double, 9, 1>;

using linalg::view;

/// forces += P grad N_a.
void add_stress(const Elements& elements, std::size_t t, int q, const Matrix3& P, Eigen::VectorXd& forces) {
    for (int a = 0; a < static_cast<int>(elements.nodes_per_tet()); ++a)
        forces.segment<3>(3 * elements.node_of(t, a)) += P * linalg::vector(elements.shape_gradient(t, q, a));
}

}  // namespace

Eigen::MatrixXd constants_of_tets(const Elements& elements, std::size_t material,
                                  const std::vector<double>& direction) {
    const auto constants = static_cast<Eigen::Index>(direction.size());
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(constants, static_cast<Eigen::Index>(elements.tet_count()));
    for (std::size_t t = 0; t < elements.tet_count(); ++t) {
        if (elements.material(t) == static_cast<int>(material))
            all.col(static_cast<Eigen::Index>(t)) = Eigen::Map<const Eigen::VectorXd>(direction.data(), constants);
    }
    return all;
}

void add_law_force(const Elements& elements, const Eigen::MatrixXd& direction, const Eigen::VectorXd& x,
                   Eigen::VectorXd& forces) {
    for (std::size_t t = 0; t < elements.tet_count(); ++t) {
        const auto changes = direction.col(static_cast<Eigen::Index>(t));
        if (changes.isZero(0)) continue;
        for (int q = 0; q < elements.points_per_tet(); ++q) {
            const auto slopes =
                material::stress_by_constants(elements.law(t), elements.deformation_gradient(t, q, view(x)));
            Matrix3 P = Matrix3::Zero();
            for (std::size_t c = 0; c < slopes.size(); ++c) P += changes[static_cast<Eigen::Index>(c)] * slopes[c];
            add_stress(elements, t, q, elements.point_volume(t, q) * P, forces);
        }
    }
}

Eigen::MatrixXd law_products(const Elements& elements, const Description& description, const Eigen::VectorXd& x,
                             const Eigen::VectorXd& weights) {
    std::size_t most = 0;
    for (const Material& material : description.materials)
        most = std::max(most, material::parameters(material.law)[0].direction.size());
    const std::size_t count = elements.tet_count();
    Eigen::MatrixXd products = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(most), static_cast<Eigen::Index>(count));
    parallel_for(count, tets_at_once, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            for (int q = 0; q < elements.points_per_tet(); ++q) {
                const Matrix3 change = elements.point_volume(t, q) * elements.deformation_gradient(t, q, view(weights));
                const auto slopes =
                    material::stress_by_constants(elements.law(t), elements.deformation_gradient(t, q, view(x)));
                for (std::size_t c = 0; c < slopes.size(); ++c)
                    products(static_cast<Eigen::Index>(c), static_cast<Eigen::Index>(t)) +=
                        slopes[c].cwiseProduct(change).sum();
            }
        }
    });
    return products;
}

void add_tangent_product(const Elements& elements, const std::vector<bool>& wanted, const Eigen::VectorXd& x,
                         const Eigen::VectorXd& motion, Eigen::VectorXd& forces) {
    for (std::size_t t = 0; t < elements.tet_count(); ++t) {
        bool any = false;
        for (int a = 0; a < static_cast<int>(elements.nodes_per_tet()) && !any; ++a)
            any = wanted[static_cast<std::size_t>(elements.node_of(t, a))];
        if (!any) continue;
        for (int q = 0; q < elements.points_per_tet(); ++q) {
            const Matrix3 dF = elements.deformation_gradient(t, q, view(motion));
            const Matrix9 H = material::tangent(elements.law(t), elements.deformation_gradient(t, q, view(x)));
            const Vector9 dP = H * Eigen::Map<const Vector9>(dF.data());
            add_stress(elements, t, q, elements.point_volume(t, q) * Eigen::Map<const Matrix3>(dP.data()), forces);
        }
    }
}

Masses masses_at(const Description& d, const Controls& controls, const Eigen::VectorXd& x) {
    Masses masses;
    for (const Material& material : d.materials) masses.density_kg_m3.push_back(material.density_kg_m3);
    masses.weight = -d.gravity_share.at(controls.time) * linalg::vector(d.gravity_m_s2);
    if (controls.inertia) masses.acceleration = controls.inertia->acceleration(x);
    return masses;
}

Eigen::VectorXd density_products(const Elements& elements, const Masses& masses, const Eigen::VectorXd& weights) {
    std::vector<double> by_mass(elements.tet_count(), 0.0);
    if (masses.acceleration.size() > 0) by_mass = elements.mass_products(view(weights), view(masses.acceleration));
    Eigen::VectorXd products = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(elements.tet_count()));
    parallel_for(elements.tet_count(), tets_at_once, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            double& product = products[static_cast<Eigen::Index>(t)];
            for (int q = 0; q < elements.points_per_tet(); ++q) {
                double along = by_mass[t];
                for (int a = 0; a < static_cast<int>(elements.nodes_per_tet()); ++a)
                    along +=
                        elements.shape_value(q, a) *
                        masses.weight.dot(weights.segment<3>(3 * static_cast<Eigen::Index>(elements.node_of(t, a))));
                product += elements.point_volume(t, q) * along;
            }
        }
    });
    return products;
}

void add_density_force(const Elements& elements, const Masses& masses, const Eigen::VectorXd& density,
                       Eigen::VectorXd& forces) {
    std::vector<double> mass(elements.tet_count(), 0.0);
    for (std::size_t t = 0; t < elements.tet_count(); ++t) {
        for (int q = 0; q < elements.points_per_tet(); ++q) {
            const double more = density[static_cast<Eigen::Index>(t)] * elements.point_volume(t, q);
            mass[t] += more;
            for (int a = 0; a < static_cast<int>(elements.nodes_per_tet()); ++a)
                forces.segment<3>(3 * elements.node_of(t, a)) += more * elements.shape_value(q, a) * masses.weight;
        }
    }
    if (masses.acceleration.size() > 0) elements.apply_mass(mass, view(masses.acceleration), view(forces));
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
    elements.apply_mass(mass_rate, view(masses.acceleration), view(forces));
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
