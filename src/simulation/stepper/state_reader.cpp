#include <algorithm>
#include <utility>

#include "simulation/contact/friction.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/stepper/cbor_numbers.hpp"
#include "simulation/stepper/state_digest.hpp"
#include "simulation/stepper/state_file.hpp"

namespace pliant::sim {
namespace {

using cbor::Json;
using cbor::Reader;

/// Sizes of the vectors of a model.
struct Sizes {
    Eigen::Index coordinates, free_coordinates, actuators, steered, object_coordinates, obstacle_coordinates;
    std::size_t supports;
};

Sizes sizes_of(const Stepper& stepper) {
    const Model& model = stepper.model();
    const Controls controls = stepper.system().controls(0);
    const Description& d = model.description();
    return {3 * model.node_count(),
            3 * model.free_count(),
            static_cast<Eigen::Index>(controls.drives.size()),
            static_cast<Eigen::Index>(d.steered_count()),
            3 * model.object_points().count(),
            controls.obstacles.size(),
            controls.support_share.size()};
}

/// Reads one map; on an error `status` describes it, and the rest is invalid.
class StateReader {
public:
    StateReader(const Stepper& stepper) : stepper_(stepper), sizes_(sizes_of(stepper)) {}

    [[nodiscard]] const Status& status() const { return status_; }

    RobotState robot(const Json& json) {
        Reader in(json);
        RobotState robot;
        robot.now = {in.number("along"), state(in.at("state"))};
        robot.inputs = inputs(in.at("inputs"));
        if (in.has("before")) robot.before = inputs(in.at("before"));
        robot.drives = drives(in.at("drives"), sizes_.actuators);
        robot.controls = controls(in.at("controls"), robot.now.state);
        for (const Json& past : list(in, "past")) {
            Reader one(past);
            robot.past.push_back({one.number("along"), std::make_shared<const State>(state(one.at("state")))});
            take(one);
        }
        if (robot.past.size() > RotatingStep::most_past) fail("more states of the past than there can be");
        if (stepper_.options().dynamics) robot.history = history(in.at("history"));
        if (in.has("memory")) robot.memory = memory(in.at("memory"));
        take(in);
        return robot;
    }

private:
    void fail(const std::string& why) {
        if (status_) status_ = input_error("damaged: {}", why);
    }
    void take(const Reader& in) {
        if (status_ && !in.status()) status_ = in.status();
    }
    [[nodiscard]] const Json& list(Reader& in, const char* key) {
        static const Json none = Json::array();
        const Json& value = in.at(key);
        if (value.is_array()) return value;
        in.fail(std::string(key) + " is not a list");
        return none;
    }

    State state(const Json& json) {
        Reader in(json);
        State state{in.vector("x", sizes_.coordinates), in.vector("multiplier", sizes_.actuators)};
        take(in);
        return state;
    }

    Inputs inputs(const Json& json) {
        Reader in(json);
        Inputs inputs{in.number("time"), drives(in.at("drives"), sizes_.steered), in.vector("force_N", 3)};
        take(in);
        return inputs;
    }

    std::vector<Drive> drives(const Json& json, Eigen::Index count) {
        Reader in(json);
        const std::vector<int> kinds = in.numbers<int>("kind");
        const Eigen::VectorXd values = in.vector("value", count);
        take(in);
        std::vector<Drive> drives;
        if (static_cast<Eigen::Index>(kinds.size()) != count) fail("kinds of drives are missing");
        for (std::size_t a = 0; status_ && a < kinds.size(); ++a) {
            if (kinds[a] < 0 || kinds[a] > static_cast<int>(Drive::Kind::gas)) fail("a drive of no kind");
            drives.push_back({static_cast<Drive::Kind>(kinds[a]), values[static_cast<Eigen::Index>(a)]});
        }
        return drives;
    }

    History history(const Json& json) {
        Reader in(json);
        const Eigen::Index n = sizes_.coordinates;
        History history{in.vector("x", n), in.vector("v", n), in.vector("x_before", n), in.vector("v_before", n),
                        in.number("dt_before")};
        if (!(history.dt_before >= 0)) in.fail("dt_before is negative");
        if (in.has("touching")) history.touching = in.integer("touching", 0, 1 << 30);
        if (in.has("next_dt")) history.next_dt = in.number("next_dt");
        if (!(history.next_dt >= 0)) in.fail("next_dt is negative");
        take(in);
        return history;
    }

    std::shared_ptr<const contact::Friction> friction(const Json& json) {
        constexpr std::size_t wholes = 8, reals = 13;
        Reader in(json);
        const std::vector<int> whole = in.numbers<int>("pairs");
        const Eigen::Index nodes = (sizes_.coordinates + sizes_.object_coordinates + sizes_.obstacle_coordinates) / 3;
        const std::size_t count = whole.size() / wholes;
        const Eigen::VectorXd real = in.vector("numbers", static_cast<Eigen::Index>(reals * count));
        const Eigen::VectorXd start = in.vector("start", 3 * nodes);
        const double slip_m = in.number("slip_m");
        if (whole.size() % wholes != 0 || !(slip_m > 0)) in.fail("friction");
        Eigen::VectorXd faces = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(count), -1);
        if (in.has("flat_faces")) faces = in.vector("flat_faces", static_cast<Eigen::Index>(count));
        if (!(faces.array().abs() < 1e15).all()) in.fail("friction on faces that do not exist");
        take(in);
        std::vector<contact::FrozenPair> pairs;
        for (std::size_t k = 0; status_ && k < count; ++k) {
            contact::FrozenPair pair;
            const int* i = whole.data() + wholes * k;
            const double* r = real.data() + reals * k;
            std::copy_n(i, 4, pair.nodes.begin());
            std::copy_n(r, 4, pair.weights.begin());
            pair.tangents = {Vec3{r[4], r[5], r[6]}, Vec3{r[7], r[8], r[9]}};
            pair.limit_N = r[10];
            pair.carried_m = {r[11], r[12]};
            pair.node_count = i[4];
            pair.first_count = i[5];
            pair.obstacle = i[6];
            pair.robot_first = i[7] != 0;
            pair.flat_face = static_cast<std::int64_t>(faces[static_cast<Eigen::Index>(k)]);
            if (!is_pair(pair, nodes)) fail("friction between nodes that do not exist");
            pairs.push_back(pair);
        }
        if (!status_) return nullptr;
        return std::make_shared<const contact::Friction>(
            std::move(pairs), std::vector<double>(start.data(), start.data() + start.size()), slip_m);
    }

    [[nodiscard]] bool is_pair(const contact::FrozenPair& pair, Eigen::Index nodes) const {
        const auto& contact = stepper_.model().description().contact;
        const int obstacles = contact ? static_cast<int>(contact->obstacles.size()) : 0;
        return std::all_of(pair.nodes.begin(), pair.nodes.end(), [&](int n) { return n >= 0 && n < nodes; }) &&
               pair.node_count >= 2 && pair.node_count <= 4 && pair.first_count >= 1 &&
               pair.first_count < pair.node_count && pair.obstacle >= -1 && pair.obstacle < obstacles;
    }

    /// The controls with which `at` was solved.
    Controls controls(const Json& json, const State& at) {
        Reader in(json);
        Controls controls;
        controls.time = in.number("time");
        controls.external_N = in.vector("external_N", sizes_.coordinates);
        const Eigen::VectorXd support = in.vector("support_share", static_cast<Eigen::Index>(sizes_.supports));
        controls.support_share.assign(support.begin(), support.end());
        controls.drives = drives(in.at("drives"), sizes_.actuators);
        controls.shares = shares(in);
        controls.obstacles = in.vector("obstacles", sizes_.obstacle_coordinates);
        controls.joint_wanted = in.numbers<double>("joint_wanted");
        controls.joint_start = in.numbers<double>("joint_start");
        const std::size_t joints = stepper_.system().joints().size();
        if (controls.joint_wanted.size() != joints ||
            !(controls.joint_start.empty() || controls.joint_start.size() == joints))
            in.fail("another number of joints");
        controls.met = in.boolean("met");
        if (const auto count = stepper_.model().description().torques.size(); count > 0) {
            const Eigen::VectorXd torques = in.vector("torque_Nm", 3 * static_cast<Eigen::Index>(count));
            for (std::size_t k = 0; k < count; ++k)
                controls.torque_Nm.emplace_back(torques.segment<3>(3 * static_cast<Eigen::Index>(k)));
        }
        if (in.has("friction")) controls.friction = friction(in.at("friction"));
        if (in.has("inertia")) {
            Reader inertia(in.at("inertia"));
            History start = history(inertia.at("start"));
            start.is_still = !stepper_.options().dynamics.has_value();
            const double dt = inertia.number("dt");
            if (!(dt > 0) || !stepper_.has_inertia()) inertia.fail("a step in time of no length");
            int scheme = 0;
            if (inertia.has("scheme")) scheme = inertia.integer("scheme", 0, static_cast<int>(Scheme::conserving));
            take(inertia);
            if (status_ && in.status()) controls.inertia = stepper_.inertia(start, dt, static_cast<Scheme>(scheme));
        }
        if (status_ && controls.of_means()) controls.object_stress = object_stress(in, controls, at);
        take(in);
        return controls;
    }

    /// Where it was not written, that at the end of the step, which it is up to the tolerance of the solver.
    std::vector<linalg::Matrix3> object_stress(Reader& in, const Controls& controls, const State& at) {
        if (!in.has("object_stress")) return stepper_.system().object_stress(controls.inertia->start().x, at.x);
        constexpr Eigen::Index entries = 9;
        const auto count = static_cast<Eigen::Index>(stepper_.model().objects().size());
        const Eigen::VectorXd numbers = in.vector("object_stress", entries * count);
        std::vector<linalg::Matrix3> stress;
        for (Eigen::Index k = 0; k < count; ++k) stress.emplace_back(numbers.data() + entries * k);
        return stress;
    }

    /// For each cable with friction one number per segment; for all others none.
    std::vector<std::vector<double>> shares(Reader& in) {
        std::vector<std::vector<double>> shares;
        const auto& cables = stepper_.model().description().cables;
        for (const Json& list : this->list(in, "shares")) {
            shares.push_back(in.numbers_of<double>("shares", list));
            const std::size_t a = shares.size() - 1;
            const std::size_t segments = a < cables.size() ? cables[a].points.size() - 1 : 0;
            if (!shares.back().empty() && shares.back().size() != segments) in.fail("shares of tension");
        }
        if (static_cast<Eigen::Index>(shares.size()) != sizes_.actuators) in.fail("shares of tension are missing");
        return shares;
    }

    std::shared_ptr<const StepPair> pair(const Json& json) {
        Reader in(json);
        StepPair pair{in.vector("step", sizes_.free_coordinates), in.vector("change", sizes_.free_coordinates),
                      in.number("rho"), in.number("scale")};
        take(in);
        return std::make_shared<const StepPair>(std::move(pair));
    }

    NewtonRates rates(const Json& json) {
        constexpr int most = 1 << 30;
        Reader in(json);
        NewtonRates r;
        r.share_ = in.number("share");
        r.cautious_ = in.boolean("cautious");
        r.share_wanted_ = in.number("share_wanted");
        r.usable_ = in.boolean("usable");
        r.hasty_ = in.boolean("hasty");
        r.reused_ = in.boolean("reused");
        r.left_ = in.number("left");
        r.left_at_first_ = in.number("left_at_first");
        r.left_by_last_ = in.number("left_by_last");
        r.left_by_new_ = in.number("left_by_new");
        r.uses_ = in.integer("uses", 0, most);
        r.age_ = in.integer("age", 0, most);
        r.tried_later_ = in.boolean("tried_later");
        r.two_levels_ = in.boolean("two_levels");
        if (!(r.share_ >= 0 && r.share_ <= 1 && r.share_wanted_ > 0 && r.share_wanted_ <= 1)) in.fail("share");
        if (!(r.left_ > 0 && r.left_ < 1 && r.left_at_first_ > 0 && r.left_at_first_ < 1)) in.fail("left");
        take(in);
        return r;
    }

    TangentInverse::Memory inverse(const Json& json) {
        constexpr int most = 1 << 30;
        Reader in(json);
        TangentInverse::Memory m;
        m.in_double = in.boolean("in_double");
        m.untried = in.boolean("untried");
        m.known_error = in.number("known_error");
        m.trusted = in.integer("trusted", 0, most);
        m.refusals = in.integer("refusals", 0, most);
        if (in.has("usual_gain")) m.usual_gain = in.number("usual_gain");
        take(in);
        return m;
    }

    std::shared_ptr<const SolverMemory::Tangent> tangent(const Json& json) {
        Reader in(json);
        State at = state(in.at("state"));
        Controls there = controls(in.at("controls"), at);
        take(in);
        return std::make_shared<const SolverMemory::Tangent>(SolverMemory::Tangent{std::move(at), std::move(there)});
    }

    std::shared_ptr<const SolverMemory::Cliques> touching(Reader& in) {
        auto cliques = std::make_shared<SolverMemory::Cliques>();
        const int free = static_cast<int>(sizes_.free_coordinates / 3);
        for (const Json& list : this->list(in, "touching")) {
            cliques->push_back(in.numbers_of<int>("touching", list));
            for (const int node : cliques->back()) {
                if (node < -1 || node >= free) in.fail("contact of nodes that do not exist");
            }
        }
        return cliques;
    }

    std::shared_ptr<const SolverMemory> memory(const Json& json) {
        Reader in(json);
        auto memory = std::make_shared<SolverMemory>();
        memory->rates = rates(in.at("rates"));
        memory->inverse = inverse(in.at("inverse"));
        memory->forgets_touching = in.boolean("forgets_touching");
        for (const Json& one : list(in, "pairs")) memory->pairs.push_back(pair(one));
        if (in.has("learnt")) memory->learnt = pair(in.at("learnt"));
        if (in.has("followed"))
            memory->followed = std::make_shared<const Eigen::VectorXd>(in.vector("followed", sizes_.coordinates));
        if (in.has("touching")) memory->touching = touching(in);
        if (in.has("tangent")) memory->tangent = tangent(in.at("tangent"));
        if (in.has("base")) {
            Reader base(in.at("base"));
            memory->base.share = base.number("share");
            memory->base.tangent = base.has("tangent") ? tangent(base.at("tangent")) : memory->tangent;
            if (!(memory->base.share >= 0 && memory->base.share <= 1)) base.fail("share");
            take(base);
        }
        if (memory->rates.usable_ && !memory->tangent) in.fail("a factor of nothing");
        take(in);
        return memory;
    }

    const Stepper& stepper_;
    Sizes sizes_;
    Status status_;
};

/// A tangent can only be computed if no tet is inverted.
Status check_possible(const Stepper& stepper, const RobotState& robot) {
    const auto possible = [&](const State& state) {
        return stepper.model()
                   .elements()
                   .evaluate({state.x.data(), static_cast<std::size_t>(state.x.size())}, {})
                   .min_J > 0;
    };
    bool all = stepper.system().evaluate(robot.now.state, robot.controls).possible();
    for (const PastMoment& past : robot.past) all = all && possible(*past.state);
    if (robot.memory) {
        for (const auto& tangent : {robot.memory->tangent, robot.memory->base.tangent}) {
            if (tangent) all = all && possible(tangent->state);
        }
    }
    return all ? Status{}
               : Status(input_error("damaged: a tetrahedron is turned inside out, or surfaces have passed "
                                    "through each other"));
}

}  // namespace

Result<RobotState> state_from_bytes(const Stepper& stepper, std::string_view bytes) {
    const Result<std::string_view> content = cbor::unsealed(bytes);
    const Json json = content ? cbor::parsed(*content) : Json();
    const auto text = [&](const char* key) {
        return json.is_object() && json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : "";
    };
    if (text("format") != state_format_name) return input_error("not a state that Pliant has written, or damaged");
    Reader head(json);
    const int version = head.integer("version", 0, 1 << 30);
    if (version != state_version)
        return input_error("a state of version {}; this Pliant reads version {}", version, state_version);
    if (text("mesh") != mesh_digest(stepper.model().mesh()))
        return input_error("a state of another robot, or of another mesh of it");
    if (json.contains("parts") && text("parts") != parts_digest(stepper.model().description()))
        return input_error("a state of another robot: its supports, cables, chambers, springs or joints are others");
    const bool in_time = stepper.options().dynamics.has_value();
    if (in_time != json.contains("history"))
        return input_error("a state of a robot with{} program.time_step, and this one has {}", in_time ? "out" : "",
                           in_time ? "it" : "none");
    StateReader reader(stepper);
    RobotState robot = reader.robot(json);
    if (!reader.status()) return tl::unexpected(reader.status().error());
    if (Status status = check_possible(stepper, robot); !status) return tl::unexpected(status.error());
    robot.evaluation = stepper.system().evaluate(robot.now.state, robot.controls);
    return robot;
}

}  // namespace pliant::sim
