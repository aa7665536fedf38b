// Gradients of random robots, at states of their programs, against states that are converged anew.
//
// PLIANT_RANDOM_ROBOTS sets their number (default 4), PLIANT_RANDOM_FIRST the first seed (1).
#include <doctest/doctest.h>

#include <cstdlib>
#include <functional>
#include <string>

#include "simulation/gradient/test_reconverged.hpp"
#include "simulation/gradient/variation.hpp"
#include "simulation/linearisation/test_random_robots.hpp"

using namespace pliant;
using namespace pliant::sim;
using namespace pliant::sim::testing;

namespace {

/// An objective over all measures, weighted to similar magnitudes, so that one gradient tests them all.
struct Judged {
    std::vector<Measure> measures;
    Eigen::VectorXd weights;
    [[nodiscard]] double operator()(const Equilibrium& system, const Controls& controls, const State& state) const {
        double sum = 0;
        for (std::size_t k = 0; k < measures.size(); ++k)
            sum += weights[static_cast<Eigen::Index>(k)] * slope(system, state, controls, measures[k]).value;
        return sum;
    }
};

/// Converges another robot, or other controls, from a nearby converged state with its factor, so that each iteration
/// reduces the error by a factor proportional to the difference. False: it does not converge.
bool converge_nearby(Linearisation& at, const Equilibrium& system, const Controls& controls, State& state) {
    system.place_supports(controls, state.x);
    double least = 1e300;
    for (int k = 0; k < 40; ++k) {
        const auto step = at.solve(at.equations(system, state, controls));
        if (!step) return false;
        const Change change = at.change_of(*step);
        const double size = change.positions.norm() / state.x.norm();
        if (!(size < 1e-3)) return false;
        if (size > 0.5 * least && size < 1e-9) break;
        state.x -= change.positions;
        state.multiplier -= change.multipliers;
        least = std::min(least, size);
        if (size < 1e-16) break;
    }
    state.multiplier = system.evaluate(state, controls).multiplier;
    return least < 1e-9;
}

struct Found {
    double worst = 0;  ///< of what differences can tell
    std::string name;
    int tried = 0, told = 0;       ///< derivatives, and those that differences tell to 1e-6
    int measures = 0, hidden = 0;  ///< in all, and those that are left out because rounding hides them
};

/// (measures) their change when all positions are perturbed in about their last digit.
Eigen::VectorXd rounding_of(const Linearisation& at, const std::vector<Measure>& measures,
                            const std::vector<Slope>& now) {
    constexpr double last_digit = 1e-16;
    const double size = at.state().x.cwiseAbs().maxCoeff();
    Eigen::VectorXd worst = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(measures.size()));
    for (const unsigned k : {1, 2, 3, 4}) {
        Noise noise(k);
        State state = at.state();
        state.x += last_digit * size * noise.vector(state.x.size());
        for (std::size_t m = 0; m < measures.size(); ++m) {
            double& most = worst[static_cast<Eigen::Index>(m)];
            const double value = slope(at.system(), state, at.controls(), measures[m]).value;
            most = std::max(most, std::fabs(value - now[m].value));
        }
    }
    return worst;
}

/// Compares a derivative with differences of states that are converged anew, relative to its own size; allows for the
/// effect of rounding, measured on states that should be equal: converged from a slightly different start, or of a
/// robot that differs in the last digits.
void compare_with_differences(const std::string& name, double told, double size, Found& found,
                              const std::function<double(double change, unsigned perturbed)>& value_from) {
    double noise = 1e-15;
    for (const unsigned perturbed : {1, 2, 3, 4})
        noise = std::max(noise, std::fabs(value_from(0, perturbed) - value_from(0, 0)));
    for (const double digits : {1e-12, 3e-12, 1e-11}) {
        for (const double change : {digits * size, -digits * size})
            noise = std::max(noise, std::fabs(value_from(change, 0) - value_from(0, 0) - told * change));
    }
    const auto value = [&](double change) { return value_from(change, 0); };
    double strict = 1e300;
    const double error = best_error(0.02 * size, [&](double h) {
        const double by_difference = (8 * (value(h) - value(-h)) - (value(2 * h) - value(-2 * h))) / (12 * h);
        const double off = std::fabs(told - by_difference), beside = std::max(std::fabs(by_difference), 1e-300);
        strict = std::min(strict, off / beside);
        return std::max(0.0, off - 4 * noise / h) / beside;
    });
    INFO(name);
    INFO("noise ", noise);
    CHECK(error < 1e-6);
    ++found.tried;
    found.told += strict < 1e-6 ? 1 : 0;
    if (error > found.worst) {
        found.worst = error;
        found.name = name;
    }
}

/// Along one motion of all rest positions, if nothing lagged depends on them.
void try_shape(Linearisation& at, unsigned seed, const Slope& sum, const Judged& judged, Found& found) {
    const Description& d = at.system().model().description();
    if (d.contact || at.system().has_cable_friction()) return;
    const auto by = gradient(at, sum, {.inputs = false, .parameters = false, .rest = true});
    REQUIRE(by);
    Noise noise(seed);
    const Eigen::VectorXd motion = noise.vector(by->rest.size());
    const Parameter nothing{Parameter::Kind::gravity, 0, "", "", 1};
    compare_with_differences(
        "rest positions", by->rest.dot(motion), 0.05 * test::side, found, [&](double change, unsigned perturbed) {
            Description moved = d;
            for (std::size_t n = 0; n < moved.mesh.points.size(); ++n) {
                for (std::size_t c = 0; c < 3; ++c)
                    moved.mesh.points[n][c] += change * motion[static_cast<Eigen::Index>(3 * n + c)];
            }
            const Case other(std::move(moved));
            Controls controls = controls_with(at, other.system, nothing, 0);
            controls.drives = other.system.controls(at.controls().time).drives;
            State state = at.state();
            for (Eigen::Index a = 0; a < state.multiplier.size(); ++a) {
                if (controls.drives[static_cast<std::size_t>(a)].kind == Drive::Kind::multiplier)
                    state.multiplier[a] = controls.drives[static_cast<std::size_t>(a)].value;
            }
            Noise aside(perturbed);
            if (perturbed > 0) state.x += 1e-8 * test::side * aside.vector(state.x.size());
            return converge_nearby(at, other.system, controls, state) ? judged(other.system, controls, state)
                                                                      : std::nan("");
        });
}

/// By a few of all numbers, chosen at random, and along one motion of all rest positions.
void try_robot(Linearisation& at, unsigned seed, Found& found) {
    test::Dice dice(seed + 77);
    Noise noise(seed);
    const Description& d = at.system().model().description();
    Judged judged{all_measures(d), {}};
    std::vector<Slope> slopes;
    for (const Measure& m : judged.measures) slopes.push_back(slope(at, m));
    // Measures that change by more than this share of the sum of their terms when positions are rounded cannot be
    // tested by differences.
    constexpr double hidden = 1e-9;
    const Eigen::VectorXd sizes = sizes_of(at, slopes), rounding = rounding_of(at, judged.measures, slopes);
    judged.weights = noise.vector(sizes.size());
    for (Eigen::Index k = 0; k < sizes.size(); ++k) {
        const bool is_hidden = rounding[k] > hidden * sizes[k];
        judged.weights[k] = sizes[k] > 1e-9 && !is_hidden ? judged.weights[k] / sizes[k] : 0;
        ++found.measures;
        found.hidden += is_hidden ? 1 : 0;
    }
    Slope sum = no_slope(at.system());
    for (std::size_t k = 0; k < slopes.size(); ++k) add(slopes[k], judged.weights[static_cast<Eigen::Index>(k)], sum);
    const auto by = gradient(at, sum, {});
    REQUIRE_MESSAGE(by, by.error().message);
    const auto converged = [&](const Equilibrium& system, const Controls& controls, State state, unsigned perturbed) {
        Noise aside(perturbed);
        if (perturbed > 0) state.x += 1e-8 * test::side * aside.vector(state.x.size());
        return converge_nearby(at, system, controls, state) ? judged(system, controls, state) : std::nan("");
    };
    const std::vector<Parameter> wanted = inputs(at), made_of = parameters(at);
    for (std::size_t k = 0; k < wanted.size(); ++k) {
        if (wanted.size() > 3 && dice.chance(0.5)) continue;
        const double size = wanted[k].value != 0 ? std::fabs(wanted[k].value) : 1;
        compare_with_differences(wanted[k].name, by->inputs[static_cast<Eigen::Index>(k)], size, found,
                                 [&](double change, unsigned perturbed) {
                                     State state = at.state();
                                     const Controls controls = with_input(at, wanted[k], change, state);
                                     return converged(at.system(), controls, state, perturbed);
                                 });
    }
    for (std::size_t k = 0; k < made_of.size(); ++k) {
        if (dice.chance(0.6)) continue;
        const Parameter& p = made_of[k];
        compare_with_differences(p.name, by->parameters[static_cast<Eigen::Index>(k)], size_of(p), found,
                                 [&](double change, unsigned perturbed) {
                                     const Case other(with_value(d, p, p.value + change));
                                     return converged(other.system, controls_with(at, other.system, p, change),
                                                      at.state(), perturbed);
                                 });
    }
    try_shape(at, seed, sum, judged, found);
}

}  // namespace

namespace {

unsigned asked(const char* name, unsigned unless) {
    const char* text = std::getenv(name);
    return text != nullptr ? static_cast<unsigned>(std::strtoul(text, nullptr, 10)) : unless;
}

void try_robots(const std::function<test::RandomProgram(unsigned seed)>& made) {
    const unsigned count = asked("PLIANT_RANDOM_ROBOTS", 4), first = asked("PLIANT_RANDOM_FIRST", 1);
    Found found;
    unsigned tried = 0, seed = first, given_up = 0;
    for (; tried < count; ++seed) {
        const test::RandomProgram p = made(seed);
        const auto model = Model::create(p.robot);
        if (!model) continue;
        RandomState random(*model, p, seed);
        if (!random.moved) continue;
        CAPTURE(seed);
        const std::string robot = test::described(p);  // a capture is read only where a check fails
        CAPTURE(robot);
        if (!converge(random.system, random.controls, random.state)) {
            ++given_up;
            continue;
        }
        auto at = Linearisation::create(random.system, random.state, random.controls);
        REQUIRE_MESSAGE(at, at.error().message);
        ++tried;
        try_robot(*at, seed, found);
    }
    MESSAGE(tried, " robots of ", seed - first, ", ", given_up, " of which do not converge to the last digit; worst ",
            found.worst, ": ", found.name, "; ", found.told, " of ", found.tried,
            " derivatives to 1e-6 of themselves; ", found.hidden, " of ", found.measures,
            " measures left out, which rounding of positions hides");
    CHECK(found.told > 0.7 * found.tried);
}

}  // namespace

TEST_CASE("gradients of random robots, by their goals and by their parameters") {
    try_robots([](unsigned seed) {
        test::RandomProgram p = test::random_program(seed);
        p.robot = with_more(std::move(p.robot), seed);
        return p;
    });
}

TEST_CASE("gradients of random free bodies with objects over a ground, at rest and thrown") {
    try_robots([](unsigned seed) {
        test::RandomProgram p = test::random_free_program(seed);
        for (const FreeObject& object : p.robot.objects)
            p.robot.markers.push_back(
                {object.name, {{object.nodes.begin(), object.nodes.end()}, {0.25, 0.25, 0.25, 0.25}, {}}});
        p.robot.markers.push_back({"corner", {{p.robot.mesh.nodes.back()}, {1}, {}}});
        return p;
    });
}
