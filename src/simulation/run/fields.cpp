#include "simulation/run/fields.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "base/core/parallel.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/material/response.hpp"
#include "simulation/model/model.hpp"
#include "simulation/run/element_fields.hpp"
#include "simulation/run/trajectory.hpp"

namespace pliant::sim {
namespace {

double von_mises(const linalg::Matrix3& cauchy) {
    const linalg::Matrix3 deviator = cauchy - cauchy.trace() / 3 * linalg::Matrix3::Identity();
    return std::sqrt(1.5 * deviator.squaredNorm());
}

/// The largest singular value, in closed form: a frame asks for it at every point, and nothing else of the SVD.
double largest_stretch(const linalg::Matrix3& F) {
    Eigen::SelfAdjointEigenSolver<linalg::Matrix3> squares;
    squares.computeDirect(F.transpose() * F, Eigen::EigenvaluesOnly);
    return std::sqrt(squares.eigenvalues()[2]);
}

}  // namespace

Fields compute_fields(const Model& model, std::span<const Vec3> positions) {
    return fields_of(model.elements(), {&positions.data()->x, 3 * positions.size()});
}

Fields fields_of(const Elements& elements, std::span<const double> x) {
    const std::size_t count = elements.tet_count();
    Fields fields{std::vector<double>(count), std::vector<double>(count), std::vector<double>(count),
                  std::vector<double>(count)};
    parallel_for(count, 256, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            const double share = 1.0 / elements.points_per_tet();
            for (int q = 0; q < elements.points_per_tet(); ++q) {
                const linalg::Matrix3 F = elements.deformation_gradient(t, q, x);
                const double J = F.determinant();
                const linalg::Matrix3 cauchy = material::stress(elements.law(t), F) * F.transpose() / J;
                fields.J[t] += share * J;
                fields.von_mises_Pa[t] += share * von_mises(cauchy);
                fields.max_stretch[t] += share * largest_stretch(F);
                fields.energy_density_Pa[t] += share * material::energy(elements.law(t), F).value_or(0);
            }
        }
    });
    return fields;
}

std::vector<double> contact_nodes(const Model& model, std::span<const Vec3> positions, double time) {
    const contact::Contact* contact = model.contact(true);
    std::vector<double> x = contact->rest();
    for (std::size_t n = 0; n < positions.size(); ++n) {
        for (std::size_t c = 0; c < 3; ++c) x[3 * n + c] = positions[n][c];
    }
    std::vector<double> points;
    model.object_points().append({&positions.data()->x, 3 * positions.size()}, points);
    std::ranges::copy(points, x.begin() + 3 * static_cast<std::ptrdiff_t>(positions.size()));
    const auto& obstacles = model.description().contact->obstacles;
    for (std::size_t k = 0; k < obstacles.size(); ++k) {
        const Vec3 move = obstacles[k].share.at(time) * obstacles[k].move_m;
        for (int node = contact->first_node(k); node < contact->first_node(k + 1); ++node) {
            for (std::size_t c = 0; c < 3; ++c) x[3 * static_cast<std::size_t>(node) + c] += move[c];
        }
    }
    return x;
}

std::vector<double> contact_pressure(const Model& model, const Step& step) {
    if (model.contact(true) == nullptr) return {};
    const contact::Contact* contact = model.contact(step.met);
    if (contact == nullptr) return std::vector<double>(step.positions.size(), 0.0);
    const std::vector<double> x = contact_nodes(model, step.positions, step.time);
    std::vector<double> pressure = contact->forces(contact->find(x), x, nullptr).pressure_Pa;
    pressure.resize(step.positions.size());
    return pressure;
}

}  // namespace pliant::sim
