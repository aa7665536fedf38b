// Derivatives of the force of damping by stiffness, against that force of slightly different robots and starts.
#include "simulation/linearisation/damping_stiffness.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"
#include "simulation/linearisation/element_derivatives.hpp"
#include "simulation/linearisation/test_robots.hpp"
#include "simulation/material/law_parameters.hpp"

using namespace pliant;
using namespace pliant::sim;
using namespace pliant::sim::testing;

namespace {

constexpr double damping_s = 0.01;

/// A block pressed together along its axis and disturbed: every point is deformed by another amount.
Eigen::VectorXd pressed(const Equilibrium& system) {
    Eigen::VectorXd x = disturbed(system, 0, 0).x;
    for (Eigen::Index node = 0; node < x.size() / 3; ++node) x[3 * node] *= 0.85;
    return x;
}

Eigen::VectorXd damping_force(const Description& d, const Eigen::VectorXd& start, const Eigen::VectorXd& velocity) {
    const auto model = Model::create(d);
    REQUIRE_MESSAGE(model, model.error().message);
    MotionInTime motion(*model, {0, damping_s});
    return damping_s * motion.inertia(MotionInTime::still(start), 1)->stiffness_times(velocity);
}

/// Relative error of a change against central differences of the damping force, for the best of several steps.
double error_of(const Eigen::VectorXd& change, double size, const std::function<Eigen::VectorXd(double step)>& force) {
    return best_error(size, [&](double h) {
        const double off = (change - (force(h) - force(-h)) / (2 * h)).norm();
        return off == 0 ? 0 : off / change.norm();  // the stiffness of the linear law is constant
    });
}

struct Damped {
    explicit Damped(const Description& description)
        : c(description),
          at{&c.model.elements(), pressed(c.system), noise.vector(c.system.rest().x.size()), damping_s} {}

    Case c;
    Noise noise{7};
    DampedStep at;
};

Description with_law(Description d, const material::Law& law) {
    d.materials[0].law = law;
    return d;
}

}  // namespace

TEST_CASE(
    "the damping force changes with the positions at which it is taken, the constants and the rest positions as told") {
    double worst = 0;
    for (const int order : {1, 2}) {
        for (const auto& [name, law] : laws) {
            CAPTURE(name);
            CAPTURE(order);
            const Description d = block(order, law);
            Damped damped(d);
            const DampedStep& step = damped.at;
            const Eigen::Index size = step.place.size();
            const Eigen::VectorXd motion = damped.noise.vector(size), weights = damped.noise.vector(size);
            const auto check = [&](const char* what, double error) {
                INFO(what);
                CHECK(error < 1e-6);
                worst = std::max(worst, error);
            };
            const auto is_transpose = [&](double forwards, double backwards, const Eigen::VectorXd& change) {
                CHECK(forwards ==
                      near(backwards, {.relative = 1e-6, .absolute = 1e-7 * weights.norm() * change.norm()}));
            };

            Eigen::VectorXd change = Eigen::VectorXd::Zero(size);
            add_damping_place_product(step, motion, change);
            check("place", error_of(change, 0.01 * edge, [&](double h) {
                      return damping_force(d, step.place + h * motion, step.velocity);
                  }));
            is_transpose(weights.dot(change), damping_place_weights(step, weights).dot(motion), change);

            const auto parameters = material::parameters(law);
            Eigen::MatrixXd products = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(parameters[0].direction.size()),
                                                             static_cast<Eigen::Index>(step.elements->tet_count()));
            add_damping_law_products(step, weights, products);
            for (std::size_t k = 0; k < parameters[0].direction.size(); ++k) {
                CAPTURE(parameters[k].name);
                change.setZero();
                add_damping_law_force(step, constants_of_tets(*step.elements, 0, parameters[k].direction), change);
                if (change.norm() == 0) continue;
                check("constant", error_of(change, 0.01 * std::fabs(parameters[k].value), [&](double h) {
                          const auto other = material::with_parameter(law, k, parameters[k].value + h);
                          return damping_force(with_law(d, other), step.place, step.velocity);
                      }));
                is_transpose(weights.dot(change), products.row(static_cast<Eigen::Index>(k)).sum(), change);
            }

            change.setZero();
            add_damping_rest_product(step, motion, change);
            check("rest positions", error_of(change, 0.01 * edge, [&](double h) {
                      Description other = d;
                      for (std::size_t n = 0; n < other.mesh.points.size(); ++n) {
                          for (std::size_t axis = 0; axis < 3; ++axis)
                              other.mesh.points[n][axis] += h * motion[static_cast<Eigen::Index>(3 * n + axis)];
                      }
                      return damping_force(other, step.place, step.velocity);
                  }));
            Eigen::VectorXd by_rest = Eigen::VectorXd::Zero(size);
            add_damping_rest_weights(step, weights, by_rest);
            is_transpose(weights.dot(change), by_rest.dot(motion), change);
        }
    }
    MESSAGE("largest relative error: ", worst);
}
