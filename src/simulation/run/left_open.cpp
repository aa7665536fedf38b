#include "simulation/run/left_open.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "base/core/boxes.hpp"
#include "base/core/counted.hpp"
#include "base/linalg/dense.hpp"
#include "base/linalg/sparse.hpp"
#include "base/linalg/vectors.hpp"
#include "simulation/elements/elements.hpp"

namespace pliant::sim {
namespace {

using linalg::view;

/// A motion counts as held if its stiffness exceeds this many tethers: a hundredth of the weight for a displacement of
/// the robot's size.
constexpr double held_stiffness = 10;
/// With more bodies than this, the matrix of all their motions is too large to be worthwhile.
constexpr std::size_t most_bodies = 100;

/// A piece or an object, moving as a whole.
struct Body {
    std::string name;
    std::vector<int> nodes;
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< of mass
    double mass_kg = 0, radius_m = 0;                  ///< of gyration
};

class Bodies {
public:
    Bodies(const Equilibrium& system, const State& state, const Controls& controls)
        : system_(system), state_(state), controls_(controls) {
        const Model& model = system.model();
        for (const std::vector<int>& piece : model.free_pieces()) add(piece_name(piece), piece);
        for (std::size_t k = 0; k < model.objects().size(); ++k) {
            const auto& nodes = model.objects()[k].nodes();
            add("object \"" + model.description().objects[k].name + "\"", {nodes.begin(), nodes.end()});
        }
    }

    [[nodiscard]] std::string describe() const {
        if (bodies_.empty() || bodies_.size() > most_bodies || !controls_.inertia) return {};
        const Eigen::MatrixXd open = open_motions();
        std::vector<std::string> texts;
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            if (std::string text = say(open.middleRows(row(b), 6)); !text.empty())
                texts.push_back(bodies_[b].name + " can " + text);
        }
        return fmt::format("{}", fmt::join(texts, ", "));
    }

    /// The first body that its weight and loads have moved very far since the positions `before` (3n) in a direction
    /// that nothing but the tether resists; null: none.
    [[nodiscard]] const Body* falling(const Eigen::VectorXd& before) const {
        if (!controls_.inertia) return nullptr;
        const std::vector<Eigen::Vector3d> ways = ways_since(before);
        // What lands on a floor went as far as what falls for ever, but is held there. This costs more to find out.
        return first_far(ways) == nullptr ? nullptr : first_far(left_to_tether(ways));
    }

private:
    /// (bodies) of the centres of mass.
    [[nodiscard]] std::vector<Eigen::Vector3d> ways_since(const Eigen::VectorXd& before) const {
        const auto& masses = system_.model().elements().node_mass_kg();
        std::vector<Eigen::Vector3d> ways;
        for (const Body& body : bodies_) {
            Eigen::Vector3d way = Eigen::Vector3d::Zero();
            for (const int node : body.nodes)
                way += masses[static_cast<std::size_t>(node)] / body.mass_kg *
                       (state_.x.segment<3>(3 * node) - before.segment<3>(3 * node));
            ways.push_back(way);
        }
        return ways;
    }

    [[nodiscard]] Eigen::Vector3d load(const Body& body) const {
        Eigen::Vector3d load = Eigen::Vector3d::Zero();
        for (const int node : body.nodes) load += controls_.external_N.segment<3>(3 * node);
        return load;
    }

    /// The first body that one of these ways (bodies) leads far along its load, or against it: what something pushes is
    /// moved across its load, and buoyancy lifts against it. Null: none.
    [[nodiscard]] const Body* first_far(const std::vector<Eigen::Vector3d>& ways) const {
        constexpr double far = 10;  // robot sizes, for which the tether takes a hundredth of the weight
        const double far_m = far * bounds_of(system_.model().mesh().points).diagonal();
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            const Eigen::Vector3d load = this->load(bodies_[b]);
            if (std::fabs(ways[b].dot(load)) > far_m * load.norm()) return &bodies_[b];
        }
        return nullptr;
    }

    /// The parts of these ways that nothing but the tether resists. With too many bodies for their open motions: those
    /// ways for which it takes most of the load.
    [[nodiscard]] std::vector<Eigen::Vector3d> left_to_tether(std::vector<Eigen::Vector3d> ways) const {
        if (bodies_.size() > most_bodies) {
            for (std::size_t b = 0; b < bodies_.size(); ++b) {
                const Body& body = bodies_[b];
                if (body.mass_kg * tether() * ways[b].norm() < 0.5 * load(body).norm()) ways[b].setZero();
            }
            return ways;
        }
        Eigen::VectorXd all = Eigen::VectorXd::Zero(row(bodies_.size()));
        for (std::size_t b = 0; b < bodies_.size(); ++b)
            all.segment<3>(row(b)) = std::sqrt(bodies_[b].mass_kg) * ways[b];
        const Eigen::MatrixXd open = open_motions();
        const Eigen::VectorXd left = open * (open.transpose() * all);
        for (std::size_t b = 0; b < bodies_.size(); ++b)
            ways[b] = left.segment<3>(row(b)) / std::sqrt(bodies_[b].mass_kg);
        return ways;
    }

    [[nodiscard]] static Eigen::Index row(std::size_t body) { return 6 * static_cast<Eigen::Index>(body); }

    [[nodiscard]] std::string piece_name(const std::vector<int>& piece) const {
        const mesh::TetMesh& mesh = system_.model().mesh();
        std::set<int> regions;
        for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
            if (std::ranges::binary_search(piece, mesh.tet(t)[0])) regions.insert(mesh.region[t]);
        }
        std::vector<std::string> names;
        for (const int region : regions) {
            if (static_cast<std::size_t>(region) < mesh.region_names.size())
                names.push_back("\"" + mesh.region_names[static_cast<std::size_t>(region)] + "\"");
        }
        return fmt::format("the piece of {}", fmt::join(names, ", "));
    }

    void add(std::string name, std::vector<int> nodes) {
        Body body{std::move(name), std::move(nodes)};
        const auto& masses = system_.model().elements().node_mass_kg();
        const auto mass = [&](int node) { return masses[static_cast<std::size_t>(node)]; };
        for (const int node : body.nodes) {
            body.mass_kg += mass(node);
            body.centre += mass(node) * state_.x.segment<3>(3 * node);
        }
        body.centre /= body.mass_kg;
        double inertia = 0;
        for (const int node : body.nodes)
            inertia += mass(node) * (state_.x.segment<3>(3 * node) - body.centre).squaredNorm();
        body.radius_m = std::sqrt(inertia / body.mass_kg);
        bodies_.push_back(std::move(body));
    }

    /// A unit motion of a body, (3n): three translations, and three rotations scaled by its radius of gyration.
    [[nodiscard]] Eigen::VectorXd motion(const Body& body, int way) const {
        Eigen::VectorXd motion = Eigen::VectorXd::Zero(state_.x.size());
        const Eigen::Vector3d axis = Eigen::Vector3d::Unit(way % 3);
        for (const int node : body.nodes) {
            const Eigen::Vector3d arm = (state_.x.segment<3>(3 * node) - body.centre) / body.radius_m;
            motion.segment<3>(3 * node) = way < 3 ? axis : axis.cross(arm);
        }
        return motion;
    }

    /// Second derivative, along all these motions, of every energy that can change in a rigid motion: contact, springs,
    /// cables and gravity.
    [[nodiscard]] Eigen::MatrixXd stiffness() const {
        Controls still = controls_;
        still.inertia = nullptr;
        const TangentLayout layout =
            system_.lay_out_tangent_beside_tets(system_.contact_cliques(state_, still, TangentNodes::all));
        std::vector<double> values(layout.pattern.entries(), 0.0);
        system_.add_tangent_beside_tets(state_, still, layout, values, false);
        const Eigen::Index size = row(bodies_.size());
        Eigen::MatrixXd ways(state_.x.size(), size), resistance(state_.x.size(), size);
        for (Eigen::Index k = 0; k < size; ++k) {
            const Eigen::VectorXd way = motion(bodies_[static_cast<std::size_t>(k / 6)], static_cast<int>(k % 6));
            Eigen::VectorXd resists = Eigen::VectorXd::Zero(way.size());
            linalg::add_product(layout.pattern, values, view(way), 1, view(resists));
            hold_by_cables(way, resists);
            ways.col(k) = way;
            resistance.col(k) = resists;
        }
        Eigen::MatrixXd stiffness = ways.transpose() * resistance;
        add_turning_forces(stiffness);
        return stiffness;
    }

    /// A cable or chamber with prescribed length or volume is stiffer than everything else here.
    void hold_by_cables(const Eigen::VectorXd& way, Eigen::VectorXd& resists) const {
        constexpr double stiff = 1e6;  // tethers
        for (std::size_t a = 0; a < system_.actuators().size(); ++a) {
            const Actuator& actuator = system_.actuators()[a];
            const bool slack = actuator.only_pulls() && !(state_.multiplier[static_cast<Eigen::Index>(a)] > 0);
            if (controls_.drives[a].kind != Drive::Kind::measure || slack) continue;
            Eigen::VectorXd gradient = Eigen::VectorXd::Zero(way.size());
            actuator.add_gradient(view(state_.x), 1, view(gradient), controls_.shares[a]);
            const double squared = gradient.squaredNorm();
            if (squared > 0)
                resists += stiff * bodies_.front().mass_kg * tether() * gradient.dot(way) / squared * gradient;
        }
    }

    /// In a rotation, points move on arcs rather than straight lines: second-order displacements towards the axis,
    /// along which forces do work. External forces balance the body's own elastic ones. Those of objects, whose own
    /// stiffness is part of the tangent, are in it already: their energy does not change in a rotation.
    void add_turning_forces(Eigen::MatrixXd& stiffness) const {
        Eigen::VectorXd own = Eigen::VectorXd::Zero(state_.x.size());
        system_.model().elements().evaluate(view(state_.x), view(own));
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            const Body& body = bodies_[b];
            Eigen::Matrix3d virial = Eigen::Matrix3d::Zero();
            for (const int node : body.nodes)
                virial -= own.segment<3>(3 * node) * (state_.x.segment<3>(3 * node) - body.centre).transpose();
            // d2/dt2 of f . exp(t [w]) r at t = 0 is f . [w]^2 r = w . (f r^T) w - (f . r) |w|^2.
            const Eigen::Matrix3d turning =
                0.5 * (virial + virial.transpose()) - virial.trace() * Eigen::Matrix3d::Identity();
            stiffness.block<3, 3>(row(b) + 3, row(b) + 3) += turning / (body.radius_m * body.radius_m);
        }
    }

    /// 1/s^2
    [[nodiscard]] double tether() const { return controls_.inertia->rate() * controls_.inertia->rate(); }

    /// (6 bodies, ways) orthonormal in the masses.
    [[nodiscard]] Eigen::MatrixXd open_motions() const {
        Eigen::VectorXd scale(row(bodies_.size()));
        for (std::size_t b = 0; b < bodies_.size(); ++b)
            scale.segment<6>(row(b)).setConstant(1 / std::sqrt(bodies_[b].mass_kg * tether()));
        const Eigen::MatrixXd relative = scale.asDiagonal() * stiffness() * scale.asDiagonal();
        const auto [values, vectors] = linalg::symmetric_eigenpairs(0.5 * (relative + relative.transpose()));
        Eigen::Index count = 0;
        while (count < values.size() && values[count] < held_stiffness) ++count;
        return vectors.leftCols(count);
    }

    /// A description of a body's part in these motions, (6, ways).
    [[nodiscard]] static std::string say(const Eigen::MatrixXd& ways) {
        constexpr double none = 1e-3;
        const Eigen::Index all = rank(ways, none), turns = rank(ways.bottomRows(3), none);
        if (all == 0) return {};
        const auto slides = static_cast<std::size_t>(all - turns);
        std::vector<std::string> texts;
        if (slides > 0) texts.push_back("slide in " + counted(slides, "direction"));
        if (turns > 0) texts.push_back("turn or roll in " + counted(static_cast<std::size_t>(turns), "way"));
        return fmt::format("{}", fmt::join(texts, " and "));
    }
    [[nodiscard]] static Eigen::Index rank(const Eigen::MatrixXd& ways, double none) {
        if (ways.cols() == 0) return 0;
        const Eigen::VectorXd sizes = linalg::svd(ways, linalg::SvdParts::values).sigma;
        return (sizes.array() > none).count();
    }

    const Equilibrium& system_;
    const State& state_;
    const Controls& controls_;
    std::vector<Body> bodies_;
};

}  // namespace

bool can_tell_left_open(const Model& model) {
    return model.free_pieces().size() + model.objects().size() <= most_bodies;
}

std::string left_open(const Equilibrium& system, const State& state, const Controls& controls) {
    return Bodies(system, state, controls).describe();
}

std::string falling(const Equilibrium& system, const State& state, const Controls& controls,
                    const Eigen::VectorXd& before) {
    const Bodies bodies(system, state, controls);
    const Body* body = bodies.falling(before);
    if (body == nullptr) return {};
    return fmt::format(
        "nothing carries {}: it moves on under its weight and loads without end, and there is no equilibrium. Support "
        "it, or give program.time_step, with which its motion is computed",
        body->name);
}

}  // namespace pliant::sim
