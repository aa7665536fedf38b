#include "simulation/run/warnings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "base/core/counted.hpp"
#include "base/linalg/small.hpp"

namespace pliant::sim {
namespace {

std::string near(const Vec3& place_m) {
    return fmt::format("near ({:.4g}, {:.4g}, {:.4g}) mm", 1e3 * place_m.x, 1e3 * place_m.y, 1e3 * place_m.z);
}

std::string crossing_text(const Vec3& place_m) {
    return fmt::format(
        "the robot passes through itself {}, and its shape and forces are wrong: self-contact is off; [contact] with "
        "self = true keeps surfaces apart",
        near(place_m));
}

/// For the robot's free pieces and then the objects: true if joints connect it to the world or to a supported part.
std::vector<bool> held_by_joints(const Model& model) {
    const auto& pieces = model.free_pieces();
    std::vector<bool> held(pieces.size() + model.description().objects.size(), false);
    constexpr std::size_t held_anyway = std::numeric_limits<std::size_t>::max();
    const auto thing = [&](int object, const Attachment& point) {
        if (object >= 0) return pieces.size() + static_cast<std::size_t>(object);
        for (std::size_t k = 0; k < pieces.size() && !point.nodes.empty(); ++k)
            if (std::ranges::binary_search(pieces[k], point.nodes[0])) return k;
        return held_anyway;
    };
    for (bool more = true; more;) {
        more = false;
        for (const Joint& joint : model.description().joints) {
            const std::array<std::size_t, 2> ends = {thing(joint.objects[0], joint.first[0]),
                                                     thing(joint.objects[1], joint.second[0])};
            for (std::size_t k = 0; k < 2; ++k) {
                const std::size_t here = ends[k], there = ends[1 - k];
                if (here == held_anyway || held[here] || (there != held_anyway && !held[there])) continue;
                held[here] = more = true;
            }
        }
    }
    return held;
}

/// rad, at most half a turn.
double angle_between(const ObjectState& before, const ObjectState& after) {
    const double product =
        std::inner_product(before.rotation.begin(), before.rotation.end(), after.rotation.begin(), 0.0);
    return 2 * std::acos(std::min(1.0, std::fabs(product)));
}

/// Objects that a load, a spring or a motor turns by a torque.
std::vector<bool> turned_objects(const Description& d) {
    std::vector<bool> turned(d.objects.size(), false);
    for (std::size_t k = 0; k < d.objects.size(); ++k) {
        const std::array<int, 4>& nodes = d.objects[k].nodes;
        turned[k] = std::ranges::any_of(d.torques, [&](const TorqueLoad& load) {
            return std::ranges::find(load.nodes, nodes[0]) != load.nodes.end();
        });
    }
    for (const Joint& joint : d.joints) {
        if (joint.law.stiffness == 0 && joint.law.drive != JointLaw::Drive::force) continue;
        for (const int object : joint.objects)
            if (object >= 0) turned[static_cast<std::size_t>(object)] = true;
    }
    return turned;
}

}  // namespace

std::vector<std::string> warnings_of(const Step& step) {
    std::vector<std::string> warnings;
    if (step.crossing_m) warnings.push_back(crossing_text(*step.crossing_m));
    if (!step.converged) warnings.push_back("accepted above the tolerance: " + step.reason);
    return warnings;
}

std::vector<std::string> warnings_at_rest(const Model& model) {
    std::vector<std::string> warnings = model.description().notes;
    if (const auto crossing = model.surfaces().crossing_at_rest())
        warnings.push_back(fmt::format(
            "the robot passes through itself already at rest, {}: {}", near(crossing->point_m),
            model.contact(true) != nullptr ? "what crosses there does not touch, and what is next to it may get stuck"
                                           : "self-contact is off"));
    return warnings;
}

std::string held_by_nothing(const Model& model) {
    const std::vector<bool> held = held_by_joints(model);
    const std::size_t pieces = model.free_pieces().size();
    const auto open_pieces = std::count(held.begin(), held.begin() + static_cast<std::ptrdiff_t>(pieces), false);
    std::vector<std::string> who;
    if (open_pieces > 0) who.push_back(counted(static_cast<std::size_t>(open_pieces), "piece") + " of the robot");
    for (std::size_t k = pieces; k < held.size(); ++k)
        if (!held[k]) who.push_back("object \"" + model.description().objects[k - pieces].name + "\"");
    if (who.empty()) return {};
    return fmt::format(
        "no support holds {}: where contact and friction leave their places open, they stay near where the "
        "step before has left them (program.time_step lets them move)",
        fmt::join(who, ", "));
}

std::vector<ClosedGap> closed_gaps(const Equilibrium& system, const Eigen::VectorXd& x) {
    std::vector<ClosedGap> gaps;
    const auto* contact = system.model().contact(true);
    if (contact != nullptr && contact->settings().self) return gaps;
    for (std::size_t c = 0; c < system.cable_count(); ++c) {
        const int segment =
            system.actuators()[c].cable().closed_segment({x.data(), static_cast<std::size_t>(x.size())});
        if (segment >= 0) gaps.push_back({c, segment});
    }
    return gaps;
}

std::string closed_gap_text(const Model& model, const ClosedGap& gap) {
    return fmt::format(
        "guide points {} and {} of cable \"{}\" have met: the gap between them is closed; without [contact] its flanks "
        "pass through each other",
        gap.segment + 1, gap.segment + 2, model.description().cables[gap.cable].name);
}

std::string braked_turns(const Model& model, const Program& program, const std::vector<Step>& steps) {
    constexpr double noticeable = 0.3;  // rad a step, where a ball that rolls down a slope comes some 2 % too short
    if (!program.dynamics) return {};
    const std::vector<bool> is_turned = turned_objects(model.description());
    double largest = noticeable;
    const ObjectState* fastest = nullptr;
    for (std::size_t k = 1; k < steps.size(); ++k) {
        for (std::size_t i = 0; i < steps[k].objects.size(); ++i) {
            const ObjectState& object = steps[k].objects[i];
            if (norm(object.force_N) == 0 && !is_turned[i]) continue;
            const double turn = angle_between(steps[k - 1].objects[i], object) / steps[k].substeps;
            if (turn <= largest) continue;
            largest = turn;
            fastest = &object;
        }
    }
    if (fastest == nullptr) return {};
    return fmt::format(
        "object \"{}\" turns by up to {:.2g} rad in a step of time: above {:g} rad the effect of contact and of "
        "torques "
        "on what turns is noticeably too small; give a smaller program.time_step",
        fastest->name, largest, noticeable);
}

std::vector<std::string> impossible_vacuums(const Model& model, const std::vector<Step>& steps) {
    constexpr double rounding = 1e-6;
    const double least_Pa = -model.description().ambient_pressure_Pa;
    std::vector<std::string> warnings;
    for (std::size_t c = 0; c < model.description().chambers.size(); ++c) {
        const Step *first = nullptr, *worst = nullptr;
        for (const Step& step : steps) {
            if (!(step.chambers[c].pressure_Pa < (1 + rounding) * least_Pa)) continue;
            if (first == nullptr) first = &step;
            if (worst == nullptr || step.chambers[c].pressure_Pa < worst->chambers[c].pressure_Pa) worst = &step;
        }
        if (worst == nullptr) continue;
        warnings.push_back(fmt::format(
            "from step {} on the pressure in chamber \"{}\" is below a vacuum, down to {:.4g} kPa in step {}: air "
            "cannot pull by more than {:.4g} kPa (program.ambient_pressure), so that no pump reaches such a volume",
            first->index, worst->chambers[c].name, 1e-3 * worst->chambers[c].pressure_Pa, worst->index,
            -1e-3 * least_Pa));
    }
    return warnings;
}

std::vector<std::string> squeezed_objects(const Model& model, const std::vector<Step>& steps) {
    constexpr double noticeable = 0.01;
    std::vector<std::string> warnings;
    for (std::size_t k = 0; k < model.objects().size(); ++k) {
        double largest = noticeable;
        const Step *first = nullptr, *worst = nullptr;
        for (const Step& step : steps) {
            const std::span<const double> x(&step.positions.data()->x, 3 * step.positions.size());
            const linalg::Vector3 stretches = linalg::signed_svd(model.objects()[k].deformation(x)).sigma;
            const double strain = (stretches.array() - 1).abs().maxCoeff();
            if (!(strain > noticeable)) continue;
            if (first == nullptr) first = &step;
            if (strain <= largest) continue;
            largest = strain;
            worst = &step;
        }
        if (worst == nullptr) continue;
        warnings.push_back(fmt::format(
            "from step {} on object \"{}\", which should be rigid, is deformed, by up to {:.2g} % in step "
            "{}: usually a motor, a joint or a wall asks for what cannot be, and the forces there tell nothing",
            first->index, model.description().objects[k].name, 100 * largest, worst->index));
    }
    return warnings;
}

void add_warnings(Trajectory& trajectory) {
    const auto& steps = trajectory.steps;
    const auto crossed = std::find_if(steps.begin(), steps.end(), [](const Step& s) { return bool(s.crossing_m); });
    if (crossed != steps.end())
        trajectory.warnings.push_back(
            fmt::format("from step {} on, {}", crossed->index, crossing_text(*crossed->crossing_m)));
    const auto loose = [](const Step& s) { return !s.converged; };
    const auto first = std::find_if(steps.begin(), steps.end(), loose);
    if (first == steps.end()) return;
    const auto worst = std::max_element(first, steps.end(), [&](const Step& a, const Step& b) {
        return (loose(a) ? a.residual : 0) < (loose(b) ? b.residual : 0);
    });
    trajectory.warnings.push_back(fmt::format(
        "{} of {} steps, the first of them step {}, were accepted above the tolerance. The "
        "worst is step {}: {}",
        std::count_if(first, steps.end(), loose), steps.size() - 1, first->index, worst->index, worst->reason));
}

}  // namespace pliant::sim
