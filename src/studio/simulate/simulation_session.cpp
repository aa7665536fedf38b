#include "studio/simulate/simulation_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <new>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>
#include <variant>

#include "base/core/json.hpp"
#include "presentation/report/units.hpp"
#include "robot/file/robot_file.hpp"
#include "simulation/run/simulate.hpp"
#include "simulation/run/warnings.hpp"
#include "studio/base/dumped.hpp"
#include "studio/simulate/message_check.hpp"
#include "studio/simulate/state_json.hpp"

namespace pliant::studio {
namespace {

using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds frame_gap{15};  // sending faster than the display rate is useless
constexpr std::chrono::milliseconds pause{80};      // after the last input before refining; during interaction inputs
                                                    // come faster
constexpr double quick_s = 0.05;                    // per increment: fast enough for interaction
constexpr double slow_s = 0.15;

Result<std::shared_ptr<const Built>> made(RobotText source, std::int64_t revision, Progress& watch) {
    std::vector<std::string> assignments;
    if (source.accuracy == Accuracy::preview) assignments.emplace_back("mesh.order=1");
    Result<robot::Robot> robot = robot::parse_robot(source.text, source.file, assignments);
    if (!robot) return tl::unexpected(robot.error());
    Result<robot::Scene> scene = robot::build_scene(std::move(*robot), watch);
    if (!scene) return tl::unexpected(scene.error());
    return std::make_shared<const Built>(std::move(source), std::move(*scene), revision);
}

}  // namespace

/// Reports progress of building, and cancels it if something else is to be built.
class SimulationSession::Watch final : public Progress {
public:
    /// `any_input`: any new input cancels it too.
    explicit Watch(SimulationSession& session, bool any_input = false) : session_(session), any_input_(any_input) {}
    void advance(std::string_view stage, double fraction) override {
        if (Clock::now() - last_ < std::chrono::milliseconds(100)) return;
        last_ = Clock::now();
        session_.tell("build", dumped({{"type", "build"}, {"stage", stage}, {"fraction", fraction}}));
    }
    [[nodiscard]] bool cancelled() const override {
        if (session_.stopping_) return true;
        const std::lock_guard lock(session_.mutex_);
        return session_.to_build_.has_value() || (any_input_ && session_.input_);
    }

private:
    SimulationSession& session_;
    bool any_input_;
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
    input_ = wanted_.changed = wanted_.again;
    changed_.notify_all();
}

void SimulationSession::change(const std::function<void(WantedInputs&)>& how) {
    const std::lock_guard lock(mutex_);
    how(wanted_);
    input_ = true;
    changed_.notify_all();
}

Status SimulationSession::check(const Message& message) const {
    std::shared_ptr<const Built> built;
    std::vector<double> rest_measures;
    {
        const std::lock_guard lock(mutex_);
        if (to_build_ || !built_once_ || !built_) return {};
        built = built_;
        rest_measures = rest_measures_;
    }
    return check_message(*built, rest_measures, message);
}

void SimulationSession::drive(const DriveMessage& message) {
    change([&](WantedInputs& wanted) { wanted.drive(message); });
}

void SimulationSession::follow(const Follow& message) {
    change([&](WantedInputs& wanted) { wanted.follow_program(message); });
}

void SimulationSession::play(bool on) {
    change([&](WantedInputs& wanted) { wanted.play(on); });
}

void SimulationSession::rest() {
    change([](WantedInputs& wanted) { wanted.go_to_rest(); });
}

void SimulationSession::pull(const PullMessage& message) {
    change([&](WantedInputs& wanted) { wanted.pull_at(message); });
}

void SimulationSession::lead(const LeadMessage& message) {
    change([&](WantedInputs& wanted) { wanted.lead_marker(message); });
}

void SimulationSession::release() {
    change([](WantedInputs& wanted) { wanted.release(); });
}

void SimulationSession::show_again() {
    change([](WantedInputs& wanted) { wanted.show_again = true; });
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
    return history_.states();
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
        std::optional<WantedInputs> wanted;
        {
            std::unique_lock lock(mutex_);
            const auto called = [&] { return stopping_ || to_build_ || input_; };
            const auto busy = [&] { return called() || !settled_ || playing_ || may_refine(); };
            changed_.wait(lock, busy);
            if (settled_ && !playing_) changed_.wait_for(lock, pause, called);  // or there is something to refine
            if (stopping_) return;
            if (to_build_) {
                source = *to_build_;
                to_build_.reset();
            } else if (input_) {
                // An actuator that cannot be where it is asked to be keeps its last target.
                if (hand_) wanted_.take_asked([&](const ActuatorValue& value) { return hand_->can_be(value); });
                wanted = wanted_;
                wanted_.forget_requests();
                input_ = false;
            }
        }
        if (source) build(std::move(*source));
        if (hand_ == nullptr) continue;
        if (wanted) apply(*wanted);
        if (playing_ && settled_) go_on_playing();
        if (!settled_) {
            advance();
        } else if (!source && !wanted && may_refine()) {
            refine();
        }
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
        built_once_ = !to_build_;  // waiting callers wait for the last build
        changed_.notify_all();
    };
    const auto refuse = [&](const Error& error) {
        finished(error.cause == Cause::cancelled
                     ? ""
                     : fmt::format(R"({{"type":"problem","lines":{}}})", problem_lines(error)));
    };
    bool replaced = false;
    const auto stopped_by = [&](const std::string& what) {
        if (replaced) hand_ = shown_ = nullptr;  // half made; else the old robot goes on
        refuse({Cause::failed, "the robot could not be built: " + what});
    };
    try {
        const auto built = made(std::move(source), revision_ + 1, watch);
        if (!built) return refuse(built.error());
        ++revision_;
        replaced = true;
        show(*built);
        finished("");
    } catch (const std::bad_alloc&) {  // thrown out of a thread, either would end the studio
        stopped_by("it needs more memory than there is");
    } catch (const std::exception& error) {
        stopped_by(error.what());
    }
}

void SimulationSession::show(const std::shared_ptr<const Built>& built) {
    const std::shared_ptr<const Built> before = this->built();
    start(built);
    want_as_before(before.get(), *built);
    {
        const std::lock_guard lock(mutex_);
        built_ = built;
        rest_measures_ = fine_->live().rest_measures();
        scene_ = std::make_shared<const std::string>(
            built->scene.packet(fmt::format(R"(,"revision":{},"opened":{},"accuracy":"{}")", built->revision,
                                            built->source.opened, name(built->source.accuracy))));
    }
    forget_history();
    tell("scene", dumped({{"type", "scene"}, {"revision", built->revision}}));
    publish({true, !is_input_waiting(), 0, 0, ""}, *fine_);  // rest is not the target of a robot that was elsewhere
}

bool SimulationSession::is_input_waiting() const {
    const std::lock_guard lock(mutex_);
    return input_;
}

void SimulationSession::start(const std::shared_ptr<const Built>& built) {
    hand_ = shown_ = nullptr;
    reduced_.reset();
    preview_.reset();
    fine_ = std::make_unique<LiveRobot>(built->robot, built->model, built->size_m);
    hand_ = fine_.get();
    if (built->preview) {
        preview_ = std::make_unique<LiveRobot>(built->preview->robot(), built->preview->model(), built->size_m);
        hand_ = preview_.get();
    }
    now_ = {};
    refining_ = catching_up_ = false;
}

/// The previous targets still apply if the actuators have the same names.
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

void SimulationSession::apply(const WantedInputs& wanted) {
    tag_ = wanted.tag;
    now_ = wanted;
    if (wanted.to_rest) return to_rest();
    if (wanted.show_again && shown_ != nullptr) publish({false, settled_ && !refining_, 0, 0, ""}, *shown_);
    if (!wanted.changed) return;
    if (playing_ != wanted.playing) {
        playing_ = wanted.playing;
        const double end = built_->robot.program.duration;
        if (playing_ && hand_->target().time >= end * (1 - 1e-9)) hand_->follow(0);
        if (!playing_) publish({false, settled_ && !refining_, 0, 0, ""}, *shown_);
    }
    settled_ = false;
    refining_ = false;
    if (wanted.lead && hand_->lead(*wanted.lead)) return;
    if (hand_->is_led() && wanted.let_go) return let_go_of_marker();
    hand_->stop_leading();
    move_by_hand(wanted);
}

void SimulationSession::to_rest() {
    fine_->to_rest();
    if (preview_) preview_->to_rest();
    playing_ = refining_ = catching_up_ = false;
    settled_ = true;
    forget_history();
    publish({false, true, 0, 0, ""}, *fine_);
}

void SimulationSession::move_by_hand(const WantedInputs& wanted) {
    if (wanted.follow || wanted.again) hand_->follow(wanted.followed);
    if (!playing_ && !wanted.follow) hand_->drive(wanted.time, wanted.actuators);
    hand_->pull(pulled(wanted.pull));
}

/// The sliders keep the positions to which dragging moved the actuators.
void SimulationSession::let_go_of_marker() {
    hand_->let_go();
    {
        const std::lock_guard lock(mutex_);
        wanted_.actuators = now_.actuators = hand_->driven();
        wanted_.time = now_.time = hand_->target().time;
    }
    settled_ = true;
    refining_ = hand_ != fine_.get();
    publish({false, !refining_, 0, 0, ""}, *hand_);
}

std::optional<Pulled> SimulationSession::pulled(const std::optional<PullMessage>& message) const {
    if (!message || message->vertex >= static_cast<int>(built_->scene.vertex_count())) return std::nullopt;
    const int node = built_->scene.node_of_vertex(static_cast<std::size_t>(message->vertex));
    return Pulled{message->vertex, built_->model.mesh().points[static_cast<std::size_t>(node)],
                  1 / report::mm_per_m * Vec3{message->to_mm[0], message->to_mm[1], message->to_mm[2]}};
}

void SimulationSession::go_on_playing() {
    const sim::Program& program = built_->robot.program;
    const double step = program.duration / program.steps;
    const double time = hand_->target().time;
    const bool over = time >= program.duration * (1 - 1e-9);
    if (!over) hand_->follow(std::min(time + step, program.duration));
    {
        const std::lock_guard lock(mutex_);
        now_.time = now_.followed = hand_->target().time;
        now_.actuators.clear();
        now_.playing = !over;
        if (!wanted_.changed) {
            wanted_.time = wanted_.followed = now_.time;
            wanted_.playing = now_.playing;
        }
    }
    settled_ = over;
    if (!over) return;
    playing_ = false;
    refining_ = hand_ != fine_.get();
    publish({false, !refining_, 0, 0, ""}, *hand_);
}

void SimulationSession::advance() {
    if (advance_reduced()) return;
    Watch watch(*this);
    sim::LiveProgress progress = hand_->advance(watch);
    if (!progress.reason.empty()) playing_ = false;
    settled_ = progress.arrived || !progress.reason.empty();
    catching_up_ = catching_up_ && !settled_;
    if (hand_ != fine_.get()) {
        refining_ = settled_ && !playing_ && !hand_->is_led();
        progress.arrived = false;  // only the fine robot can tell whether there is an equilibrium
        progress.reason.clear();
    }
    const bool slow = progress.wall_s > slow_s;
    const bool due = Clock::now() - last_frame_at_ >= frame_gap;
    if ((due || settled_) && !catching_up_) publish(progress, *hand_);
    if (preview_ && hand_ == fine_.get() && slow && !settled_ && !hand_->is_led()) give_way();
}

/// Jumps to the target with the reduced model; the preview, which falls behind, catches up when it is needed. False:
/// the reduced model does not cover it.
bool SimulationSession::advance_reduced() {
    if (!preview_ || hand_ != preview_.get() || hand_->is_led()) return false;
    // Made when something first moves: a robot that is only looked at costs nothing.
    if (!reduced_) {
        auto inputs = led_inputs(built_->robot, built_->model, fine_->live().rest_measures());
        reduced_ = std::make_unique<ReducedHand>(built_->robot, built_->model, std::move(inputs), built_->size_m);
    }
    const std::optional<ReducedHand::Shown> shown = reduced_->at(hand_->target());
    if (!shown) return false;
    settled_ = catching_up_ = true;
    refining_ = !playing_;
    publish(*shown);
    return true;
}

/// True if nothing moves and no marker is dragged.
bool SimulationSession::may_refine() const {
    return refining_ && settled_ && !playing_ && hand_ != nullptr && !hand_->is_led();
}

/// Solves the fine robot for the current target, unless a new input arrives.
void SimulationSession::refine() {
    Watch watch(*this, true);
    fine_->follow(now_.followed);
    if (!now_.actuators.empty() || now_.time != now_.followed) fine_->drive(now_.time, now_.actuators);
    fine_->pull(pulled(now_.pull));
    double slowest_s = 0;
    for (;;) {
        const sim::LiveProgress progress = fine_->advance(watch);
        if (watch.cancelled()) return;
        if (progress.moved) slowest_s = std::max(slowest_s, progress.wall_s);
        if (progress.arrived || !progress.reason.empty()) {
            refining_ = false;
            publish(progress, *fine_);
            break;
        }
        if (progress.moved) remember(fine_->live().describe());
    }
    if (slowest_s > 0 && slowest_s < quick_s) hand_ = fine_.get();
}

/// The fine robot is too slow for this interaction: switch to the preview.
void SimulationSession::give_way() {
    hand_ = preview_.get();
    catching_up_ = true;
    hand_->follow(now_.followed);
    if (!playing_) hand_->drive(now_.time, now_.actuators);
    hand_->pull(pulled(now_.pull));
}

void SimulationSession::publish(const sim::LiveProgress& progress, const LiveRobot& shown) {
    shown_ = &shown == fine_.get() ? fine_.get() : preview_.get();
    sim::Step step = shown.live().describe();
    About about;
    about.order = shown.model().mesh().order;
    about.arrived = progress.arrived;
    about.stuck = progress.reason;
    about.iterations = progress.iterations;
    about.warnings = shown.live().warnings(step);
    about.pulled_vertex = shown.pulled_vertex();
    if (about.pulled_vertex >= 0) about.pull_force_N = shown.live().pull_force_N();
    const std::string head = frame_head(step, about);
    // With a preview, exported states are only those of the fine robot.
    if (progress.moved && shown_ == fine_.get() && !refining_) remember(step);
    if (shown_ == preview_.get()) step.positions = built_->preview->lifted(step.positions);
    send(step, head);
}

void SimulationSession::publish(const ReducedHand::Shown& shown) {
    shown_ = preview_.get();
    About about;
    about.warnings = sim::warnings_of(shown.step);
    about.reduced_error_m = shown.error_m;
    send(shown.step, frame_head(shown.step, about));
}

void SimulationSession::send(const sim::Step& step, const std::string& head) {
    last_frame_at_ = Clock::now();
    auto frame = std::make_shared<const std::string>(built_->scene.frame(step, events_.fields(), head));
    {
        const std::lock_guard lock(mutex_);
        frame_ = frame;
    }
    events_.frame(std::move(frame));
}

void SimulationSession::forget_history() {
    const std::lock_guard lock(mutex_);
    history_ = {};
}

void SimulationSession::remember(const sim::Step& step) {
    const std::lock_guard lock(mutex_);
    history_.add(step);
}

std::string SimulationSession::frame_head(const sim::Step& step, const About& about) {
    std::vector<std::string> warnings = about.warnings;
    warnings.insert(warnings.begin(), built_->warnings.begin(), built_->warnings.end());
    Json json = state_json(step);
    json.update({{"type", "frame"},
                 {"revision", built_->revision},
                 {"sequence", sequence_++},
                 {"tag", tag_},
                 {"order", about.order},
                 {"refining", refining_},
                 {"arrived", about.arrived},
                 {"stuck", about.stuck},
                 {"warnings", warnings},
                 {"playing", playing_},
                 {"iterations", about.iterations},
                 {"solve_ms", 1e3 * step.wall_s}});
    if (about.reduced_error_m) json["reduced_error_mm"] = report::mm_per_m * *about.reduced_error_m;
    if (events_.beside) json["beside"] = true;
    if (about.pulled_vertex >= 0) {
        const Vec3 force = about.pull_force_N;
        json["pull"] = {{"vertex", about.pulled_vertex}, {"force_N", Json::array({force.x, force.y, force.z})}};
    }
    if (hand_->led()) json["lead"] = parse_json(hand_->led()->json());
    std::string text = dumped(json);
    text.insert(text.size() - 1, fmt::format(R"(,"wanted":{},"obstacles":{})", wanted_json(),
                                             built_->scene.obstacle_offsets(step.time, step.positions)));
    return text;
}

/// The current target, so that every page shows it rather than its own last request.
std::string SimulationSession::wanted_json() const {
    Json actuators = Json::array();
    for (const ActuatorValue& v : hand_->driven())
        actuators.push_back({{"name", v.name}, {"kind", v.kind}, {"value", v.value}});
    return dumped({{"time", hand_->target().time}, {"actuators", actuators}});
}

}  // namespace pliant::studio
