#include "presentation/studio/simulation_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "robot/file/robot_file.hpp"
#include "simulation/run/simulate.hpp"
#include "simulation/run/warnings.hpp"

namespace pliant::studio {
namespace {

using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;

constexpr double mm = 1e3;
constexpr std::size_t history_bytes = std::size_t{96} << 20;
constexpr std::chrono::milliseconds frame_gap{15};  // more than a screen shows is not worth sending
constexpr double patch_share = 0.04;                // of the robot's size: what a hand takes hold of

std::string dumped(const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json mm_json(const Vec3& p_m) {
    return Json::array({mm * p_m.x, mm * p_m.y, mm * p_m.z});
}

double diagonal(const std::vector<Vec3>& points) {
    Vec3 low = points.front(), high = points.front();
    for (const Vec3& p : points) {
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
        }
    }
    return norm(high - low);
}

/// What is wrong, and in which line; 0 where it is about no line.
Json problem_lines(const Error& error) {
    if (error.problems.empty()) return Json::array({{{"line", 0}, {"text", error.message}}});
    Json lines = Json::array();
    for (const Diagnostic& problem : error.problems)
        lines.push_back({{"line", problem.line}, {"text", shown({"", 0, problem.key, problem.text})}});
    return lines;
}

}  // namespace

Built::Built(RobotText source_, robot::Scene scene_, int revision_)
    : source(std::move(source_)),
      robot(std::move(scene_.robot)),
      model(std::move(scene_.model)),
      revision(revision_),
      scene(robot, model),
      attacher(model.mesh()),
      size_m(diagonal(model.mesh().points)),
      warnings(sim::warnings_at_rest(model)) {}

/// Reports building, and stops it when something else is to be built.
class SimulationSession::Watch final : public Progress {
public:
    explicit Watch(SimulationSession& session) : session_(session) {}
    void advance(std::string_view stage, double fraction) override {
        if (Clock::now() - last_ < std::chrono::milliseconds(100)) return;
        last_ = Clock::now();
        session_.tell("build", dumped({{"type", "build"}, {"stage", stage}, {"fraction", fraction}}));
    }
    [[nodiscard]] bool cancelled() const override {
        if (session_.stopping_) return true;
        const std::lock_guard lock(session_.mutex_);
        return session_.to_build_.has_value();
    }

private:
    SimulationSession& session_;
    Clock::time_point last_{};
};

SimulationSession::SimulationSession(SessionEvents events) : events_(std::move(events)), thread_([this] { work(); }) {}

SimulationSession::~SimulationSession() {
    stopping_ = true;
    { const std::lock_guard lock(mutex_); }
    changed_.notify_all();
    thread_.join();
}

void SimulationSession::open(RobotText source, After after) {
    const std::lock_guard lock(mutex_);
    to_build_ = std::move(source);
    built_once_ = false;
    if (after == After::from_rest) wanted_ = {};
    wanted_.pull.reset();
    wanted_.lead.reset();
    wanted_.playing = wanted_.to_rest = false;
    wanted_.again = after == After::as_before;
    input_ = wanted_.again;
    changed_.notify_all();
}

void SimulationSession::drive(const DriveMessage& message) {
    const std::lock_guard lock(mutex_);
    wanted_.tag = message.tag;
    if (message.time >= 0) wanted_.time = message.time;
    if (message.time >= 0) wanted_.follow = false;
    for (const ActuatorValue& value : message.actuators) {
        std::erase_if(wanted_.actuators, [&](const ActuatorValue& v) { return v.name == value.name; });
        wanted_.actuators.push_back(value);
    }
    wanted_.playing = false;
    wanted_.lead.reset();
    wanted_.let_go = false;
    input_ = true;
    changed_.notify_all();
}

void SimulationSession::follow(const Follow& message) {
    const std::lock_guard lock(mutex_);
    wanted_.tag = message.tag;
    wanted_.time = wanted_.followed = std::max(message.time, 0.0);
    wanted_.actuators.clear();
    wanted_.follow = true;
    wanted_.playing = false;
    wanted_.lead.reset();
    input_ = true;
    changed_.notify_all();
}

void SimulationSession::play(bool on) {
    const std::lock_guard lock(mutex_);
    wanted_.playing = on;
    if (on) wanted_.actuators.clear();
    if (on) wanted_.lead.reset();
    input_ = true;
    changed_.notify_all();
}

void SimulationSession::rest() {
    const std::lock_guard lock(mutex_);
    wanted_ = {};
    wanted_.to_rest = true;
    input_ = true;
    changed_.notify_all();
}

void SimulationSession::pull(const PullMessage& message) {
    const std::lock_guard lock(mutex_);
    wanted_.pull = message;
    wanted_.tag = message.tag;
    input_ = true;
    changed_.notify_all();
}

void SimulationSession::lead(const LeadMessage& message) {
    const std::lock_guard lock(mutex_);
    wanted_.lead = message;
    wanted_.pull.reset();
    wanted_.playing = false;
    wanted_.tag = message.tag;
    input_ = true;
    changed_.notify_all();
}

void SimulationSession::release() {
    const std::lock_guard lock(mutex_);
    wanted_.pull.reset();
    wanted_.let_go = wanted_.lead.has_value();
    wanted_.lead.reset();
    input_ = true;
    changed_.notify_all();
}

void SimulationSession::show_again() {
    const std::lock_guard lock(mutex_);
    wanted_.show_again = true;
    input_ = true;
    changed_.notify_all();
}

std::shared_ptr<const Built> SimulationSession::built() const {
    const std::lock_guard lock(mutex_);
    return built_;
}
std::shared_ptr<const std::string> SimulationSession::scene() const {
    const std::lock_guard lock(mutex_);
    return scene_;
}
std::shared_ptr<const std::string> SimulationSession::last_frame() const {
    const std::lock_guard lock(mutex_);
    return frame_;
}
std::vector<std::string> SimulationSession::news() const {
    const std::lock_guard lock(mutex_);
    std::vector<std::string> news;
    for (const auto& [key, json] : news_) news.push_back(json);
    return news;
}
sim::Trajectory SimulationSession::history() const {
    const std::lock_guard lock(mutex_);
    return history_;
}
bool SimulationSession::wait_until_built() const {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return built_once_ || stopping_; });
    return built_ != nullptr;
}

void SimulationSession::tell(const std::string& key, const std::string& json) {
    {
        const std::lock_guard lock(mutex_);
        std::erase_if(news_, [&](const auto& entry) { return entry.first == key; });
        if (!json.empty()) news_.emplace_back(key, json);
    }
    if (!json.empty()) events_.text(json);
}

void SimulationSession::work() {
    for (;;) {
        std::optional<RobotText> source;
        std::optional<Wanted> wanted;
        {
            std::unique_lock lock(mutex_);
            changed_.wait(lock, [&] { return stopping_ || to_build_ || input_ || !settled_ || playing_; });
            if (stopping_) return;
            if (to_build_) {
                source = *to_build_;
                to_build_.reset();
            } else if (input_) {
                wanted = wanted_;
                wanted_.to_rest = wanted_.show_again = wanted_.follow = wanted_.again = wanted_.let_go = false;
                input_ = false;
            }
        }
        if (source) build(std::move(*source));
        if (!live_) continue;
        if (wanted) apply(*wanted);
        if (playing_ && settled_) go_on_playing();
        if (!settled_) advance();
    }
}

void SimulationSession::build(RobotText source) {
    settled_ = true;
    playing_ = false;
    Watch watch(*this);
    tell("problem", "");
    tell("build", dumped({{"type", "build"}, {"stage", "read"}, {"fraction", 0}}));
    const auto finished = [&](const std::string& problem) {
        tell("build", "");
        events_.text(R"({"type":"build","stage":"","fraction":1})");
        if (!problem.empty()) tell("problem", problem);
        const std::lock_guard lock(mutex_);
        built_once_ = !to_build_;  // who waits, waits for the last
        changed_.notify_all();
    };
    const auto refuse = [&](const Error& error) {
        finished(error.cause == Cause::cancelled ? "" : dumped({{"type", "problem"}, {"lines", problem_lines(error)}}));
    };
    std::vector<std::string> assignments;
    if (source.accuracy == Accuracy::preview) assignments.emplace_back("mesh.order=1");
    Result<robot::Robot> robot = robot::parse_robot(source.text, source.file, assignments);
    if (!robot) return refuse(robot.error());
    Result<robot::Scene> scene = robot::build_scene(std::move(*robot), watch);
    if (!scene) return refuse(scene.error());
    const std::shared_ptr<const Built> before = this->built();
    auto built = std::make_shared<const Built>(std::move(source), std::move(*scene), ++revision_);
    led_.reset();
    live_.reset();
    live_.emplace(built->model, built->robot.program);
    target_ = live_->target_at(0);
    driven_.clear();
    pulled_vertex_ = -1;
    want_as_before(before.get(), *built);
    {
        const std::lock_guard lock(mutex_);
        built_ = built;
        scene_ = std::make_shared<const std::string>(
            built->scene.packet(fmt::format(R"(,"revision":{},"accuracy":"{}")", built->revision,
                                            built->source.accuracy == Accuracy::preview ? "preview" : "fine")));
        history_ = {};
        history_stride_ = 1;
        history_seen_ = 0;
    }
    tell("scene", dumped({{"type", "scene"}, {"revision", built->revision}}));
    publish({true, true, 0, 0, ""});
    finished("");
}

/// Names tell whether what was wanted of the robot before still says something.
void SimulationSession::want_as_before(const Built* before, const Built& now) {
    const auto names = [](const Built& b) {
        const sim::Description& d = b.model.description();
        std::vector<std::string> all;
        for (const auto& cable : d.cables) all.push_back("cable " + cable.name);
        for (const auto& chamber : d.chambers) all.push_back("chamber " + chamber.name);
        return all;
    };
    const std::lock_guard lock(mutex_);
    if (!wanted_.again || (before != nullptr && names(*before) == names(now))) return;
    wanted_ = {};
    input_ = false;
}

void SimulationSession::apply(const Wanted& wanted) {
    if (wanted.to_rest) {
        led_.reset();
        live_->return_to_rest();
        target_ = live_->target_at(0);
        driven_.clear();
        pulled_vertex_ = -1;
        playing_ = false;
        settled_ = true;
        const std::lock_guard lock(mutex_);
        history_ = {};
        history_stride_ = 1;
        history_seen_ = 0;
    }
    tag_ = wanted.tag;
    if (wanted.to_rest || wanted.show_again) publish({false, settled_, 0, 0, ""});
    if (wanted.to_rest) return;
    if (playing_ != wanted.playing) {
        playing_ = wanted.playing;
        const double end = built_->robot.program.duration;
        if (playing_ && target_.time >= end * (1 - 1e-9)) target_ = live_->target_at(0);
        if (!playing_) publish({false, settled_, 0, 0, ""});
    }
    settled_ = false;
    if (set_lead(wanted.lead)) return;
    if (led_ && wanted.let_go) return let_go_of_marker();
    led_.reset();
    set_target(wanted);
    set_pull(wanted.pull);
}

bool SimulationSession::set_lead(const std::optional<LeadMessage>& message) {
    const auto& markers = built_->model.description().markers;
    const auto named = [&](const sim::Marker& marker) { return message && marker.name == message->marker; };
    const auto marker = static_cast<std::size_t>(std::ranges::find_if(markers, named) - markers.begin());
    if (marker == markers.size()) return false;
    if (!led_ || led_->marker() != marker) {
        auto inputs = led_inputs(built_->robot, built_->model, live_->rest_measures());
        if (inputs.empty()) return false;
        led_.emplace(*live_, built_->model, std::move(inputs), marker);
    }
    led_to_m_ = 1 / mm * Vec3{message->to_mm[0], message->to_mm[1], message->to_mm[2]};
    return true;
}

/// The sliders stay where the hand has led the actuators.
void SimulationSession::let_go_of_marker() {
    driven_ = led_->actuators();
    led_.reset();
    target_.time = live_->state().inputs.time;
    target_.drives = live_->state().inputs.drives;
    target_.pull.reset();
    {
        const std::lock_guard lock(mutex_);
        wanted_.actuators = driven_;
        wanted_.time = target_.time;
    }
    settled_ = true;
    publish({false, true, 0, 0, ""});
}

void SimulationSession::set_target(const Wanted& wanted) {
    const double end = built_->robot.program.duration;
    if (wanted.follow || wanted.again) {
        auto pull = std::move(target_.pull);
        target_ = live_->target_at(std::min(wanted.followed, end));
        target_.pull = std::move(pull);
    }
    driven_.clear();
    if (playing_ || wanted.follow) return;
    target_.time = std::min(wanted.time, end);
    for (const ActuatorValue& value : wanted.actuators) {
        if (set_actuator(value)) driven_.push_back(value);
    }
}

bool SimulationSession::set_actuator(const ActuatorValue& value) {
    using Kind = sim::Drive::Kind;
    const sim::Description& d = built_->model.description();
    const std::vector<double> rest = live_->rest_measures();
    const double v = value.value;
    bool possible = false;
    // The thesis' elements know lengths and volumes only.
    const auto by_elements = [&](std::size_t a) {
        return std::any_of(d.growths.begin(), d.growths.end(),
                           [&](const sim::Growth& growth) { return growth.actuator == static_cast<int>(a); });
    };
    const auto set = [&](sim::Drive& drive, const char* kind, bool can_be, const sim::Drive& next) {
        if (value.kind != kind || !can_be) return;
        drive = next;
        possible = true;
    };
    for (std::size_t c = 0; c < d.cables.size(); ++c) {
        if (d.cables[c].name != value.name) continue;
        sim::Drive& drive = target_.drives[c];
        set(drive, "length_ratio", v > 0, {Kind::measure, v * rest[c]});
        set(drive, "shortening_mm", v / mm < rest[c], {Kind::measure, rest[c] - v / mm});
        set(drive, "tension_N", !by_elements(c), {Kind::multiplier, std::max(v, 0.0)});
    }
    for (std::size_t k = 0; k < d.chambers.size(); ++k) {
        if (d.chambers[k].name != value.name) continue;
        const std::size_t a = d.cables.size() + k;
        sim::Drive& drive = target_.drives[a];
        set(drive, "volume_ratio", v > 0, {Kind::measure, v * rest[a]});
        set(drive, "volume_change_mm3", rest[a] + 1e-9 * v > 0, {Kind::measure, rest[a] + 1e-9 * v});
        set(drive, "pressure_kPa", !by_elements(a), {Kind::multiplier, 0 - 1e3 * v});
        set(drive, "gas_ratio", v > 0 && !by_elements(a), {Kind::gas, v * d.ambient_pressure_Pa * rest[a]});
    }
    return possible;
}

void SimulationSession::set_pull(const std::optional<PullMessage>& message) {
    if (!message || message->vertex >= static_cast<int>(built_->scene.vertex_count())) {
        target_.pull.reset();
        pulled_vertex_ = -1;
        return;
    }
    const Vec3 to = 1 / mm * Vec3{message->to_mm[0], message->to_mm[1], message->to_mm[2]};
    if (target_.pull && pulled_vertex_ == message->vertex) {
        target_.pull->handle_m = to;
        return;
    }
    pulled_vertex_ = message->vertex;
    const int node = built_->scene.node_of_vertex(static_cast<std::size_t>(message->vertex));
    const Vec3& rest = built_->model.mesh().points[static_cast<std::size_t>(node)];
    Result<sim::Attachment> patch = built_->attacher.spread(rest, patch_share * built_->size_m, 1e-3 * built_->size_m);
    target_.pull = sim::Pull{patch ? std::move(*patch) : sim::Attachment{{node}, {1.0}, {}}, to};
}

void SimulationSession::go_on_playing() {
    const sim::Program& program = built_->robot.program;
    const double step = program.duration / program.steps;
    if (target_.time >= program.duration * (1 - 1e-9)) {
        playing_ = false;
        {
            const std::lock_guard lock(mutex_);
            wanted_.playing = false;
            wanted_.time = wanted_.followed = target_.time;
        }
        publish({false, true, 0, 0, ""});
        return;
    }
    const auto pull = target_.pull;
    target_ = live_->target_at(std::min(target_.time + step, program.duration));
    target_.pull = pull;
    settled_ = false;
    const std::lock_guard lock(mutex_);
    wanted_.time = wanted_.followed = target_.time;
}

void SimulationSession::advance() {
    Watch watch(*this);
    const sim::LiveProgress progress = led_ ? led_->lead(led_to_m_, watch) : live_->advance(target_, watch);
    if (led_) driven_ = led_->actuators();
    if (!progress.reason.empty()) playing_ = false;
    settled_ = progress.arrived || !progress.reason.empty();
    const bool due = Clock::now() - last_frame_at_ >= frame_gap;
    if (due || settled_) publish(progress);
}

void SimulationSession::publish(const sim::LiveProgress& progress) {
    last_frame_at_ = Clock::now();
    const sim::Step step = live_->describe();
    if (progress.moved) remember(step);
    auto frame =
        std::make_shared<const std::string>(built_->scene.frame(step, events_.fields(), frame_head(step, progress)));
    {
        const std::lock_guard lock(mutex_);
        frame_ = frame;
    }
    events_.frame(std::move(frame));
}

void SimulationSession::remember(const sim::Step& step) {
    const std::lock_guard lock(mutex_);
    if (history_seen_++ % history_stride_ != 0) return;
    history_.steps.push_back(step);
    history_.steps.back().index = static_cast<int>(history_seen_) - 1;
    if (history_.steps.size() * step.positions.size() * sizeof(Vec3) < history_bytes) return;
    std::vector<sim::Step> kept;  // every other one, rest always among them
    for (std::size_t k = 0; k < history_.steps.size(); k += 2) kept.push_back(std::move(history_.steps[k]));
    history_.steps = std::move(kept);
    history_stride_ *= 2;
}

std::string SimulationSession::frame_head(const sim::Step& step, const sim::LiveProgress& progress) {
    Json cables = Json::array(), chambers = Json::array(), markers = Json::array(), supports = Json::array();
    for (const auto& c : step.cables)
        cables.push_back({{"ratio", c.length_ratio}, {"length_mm", mm * c.length_m}, {"tension_N", c.tension_N}});
    for (const auto& c : step.chambers)
        chambers.push_back(
            {{"ratio", c.volume_ratio}, {"volume_mm3", 1e9 * c.volume_m3}, {"pressure_kPa", 1e-3 * c.pressure_Pa}});
    for (const auto& m : step.markers) markers.push_back(mm_json(m.position_m));
    for (const auto& s : step.supports) supports.push_back(Json::array({s.force_N.x, s.force_N.y, s.force_N.z}));
    std::vector<std::string> warnings = live_->warnings(step);
    warnings.insert(warnings.begin(), built_->warnings.begin(), built_->warnings.end());
    Json json = {{"type", "frame"},
                 {"revision", built_->revision},
                 {"sequence", sequence_++},
                 {"tag", tag_},
                 {"time", step.time},
                 {"arrived", progress.arrived},
                 {"stuck", progress.reason},
                 {"warnings", warnings},
                 {"playing", playing_},
                 {"residual", step.residual},
                 {"min_J", step.min_J},
                 {"energy_mJ", 1e3 * step.energy_J},
                 {"iterations", progress.iterations},
                 {"solve_ms", 1e3 * step.wall_s},
                 {"cables", cables},
                 {"chambers", chambers},
                 {"markers", markers},
                 {"supports", supports},
                 {"self_contact_N", step.self_contact_N}};
    if (pulled_vertex_ >= 0) {
        const Vec3 force = live_->pull_force_N();
        json["pull"] = {{"vertex", pulled_vertex_}, {"force_N", Json::array({force.x, force.y, force.z})}};
    }
    if (led_) json["lead"] = Json::parse(led_->json());
    std::string text = dumped(json);
    text.insert(text.size() - 1, fmt::format(R"(,"wanted":{},"obstacles":{})", wanted_json(),
                                             built_->scene.obstacle_offsets(step.time)));
    return text;
}

/// Where the robot is led, so that every page shows that and not what it has asked for itself.
std::string SimulationSession::wanted_json() const {
    Json actuators = Json::array();
    for (const ActuatorValue& v : driven_)
        actuators.push_back({{"name", v.name}, {"kind", v.kind}, {"value", v.value}});
    return dumped({{"time", target_.time}, {"actuators", actuators}});
}

}  // namespace pliant::studio
