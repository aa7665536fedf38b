// The robot that is bent live: builds it from its file, follows what the page asks for, tells what came of it. All work
// is done on a thread of its own; the latest input wins.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "presentation/scene/scene.hpp"
#include "presentation/studio/live_robot.hpp"
#include "presentation/studio/message.hpp"
#include "presentation/studio/preview.hpp"
#include "robot/description/robot.hpp"
#include "simulation/scene/scene.hpp"

namespace pliant::studio {

/// How fine: linear tets answer at once and bend too little; quadratic ones are those of `pliant simulate`.
/// `automatic`: linear ones while a hand moves, where the quadratic ones are not quick enough for that, and quadratic
/// ones as soon as it rests.
enum class Accuracy { preview, automatic, fine };
[[nodiscard]] std::string_view name(Accuracy accuracy);
[[nodiscard]] std::optional<Accuracy> accuracy_named(std::string_view name);

/// Where a robot goes once it has been built: one that was only changed goes where the one before was wanted.
enum class After { from_rest, as_before };

/// What is wrong, as JSON: a list of {"line", "text"}; line 0 where it is about no line.
[[nodiscard]] std::string problem_lines(const Error& error);

/// A robot file as the studio has it.
struct RobotText {
    std::filesystem::path file;  ///< what messages call it, and what paths in it are relative to
    std::string text;
    Accuracy accuracy = Accuracy::automatic;
};

/// Everything that belongs to one robot; immutable once it has been made.
struct Built {
    Built(RobotText source_, robot::Scene scene_, int revision_);
    RobotText source;
    robot::Robot robot;
    sim::Model model;
    int revision;
    view::Scene scene;
    std::unique_ptr<const Preview> preview;  ///< null: there is one model, for everything
    double size_m;
    std::vector<std::string> warnings;  ///< at rest, see sim::warnings_at_rest()
};

/// Called from the session's thread.
struct SessionEvents {
    std::function<void(const std::string& json)> text;
    std::function<void(std::shared_ptr<const std::string> packet)> frame;
    std::function<std::set<std::string>()> fields;  ///< that some page wants to see
    bool beside = false;  ///< it is the robot beside the one that is edited, and its frames say so
};

class SimulationSession {
public:
    explicit SimulationSession(SessionEvents events);
    ~SimulationSession();
    SimulationSession(const SimulationSession&) = delete;
    SimulationSession& operator=(const SimulationSession&) = delete;

    /// Builds this robot; what is being built is given up. Nothing is heard of the old one once the new one is there.
    /// With other actuators than before it starts from rest in any case.
    void open(RobotText source, After after = After::from_rest);
    void drive(const DriveMessage& message);
    void follow(const Follow& message);
    void play(bool on);
    void rest();
    void pull(const PullMessage& message);
    void lead(const LeadMessage& message);
    /// Of what is pulled or led.
    void release();
    /// Sends the present state once more, as when a page wants to see another field.
    void show_again();

    /// Null before the first robot has been built.
    [[nodiscard]] std::shared_ptr<const Built> built() const;
    [[nodiscard]] std::shared_ptr<const std::string> scene() const;
    [[nodiscard]] std::shared_ptr<const std::string> last_frame() const;
    /// What is being done, or what was wrong with the last file: JSON events for a page that has just come.
    [[nodiscard]] std::vector<std::string> news() const;
    /// The converged states since rest, rest first; thinned out where there are too many.
    [[nodiscard]] sim::Trajectory history() const;
    /// Waits until a robot has been built or refused; for tests and programs.
    [[nodiscard]] bool wait_until_built() const;

private:
    class Watch;
    /// What the page wants; kept in its own units until the robot is at hand.
    struct Wanted {
        double tag = 0;
        double time = 0;
        double followed = 0;  ///< time to which the program itself was followed; of actuators that are not listed
        std::vector<ActuatorValue> actuators;
        std::vector<ActuatorValue> asked;  ///< since they were last looked at; some of it may be impossible
        std::optional<PullMessage> pull;
        std::optional<LeadMessage> lead;
        bool playing = false;
        bool changed = false;  ///< it is another wish than the last one
        bool to_rest = false;
        bool show_again = false;
        bool follow = false;
        bool let_go = false;  ///< of a marker that was led: everything stays where it is
        bool again = false;   ///< all of it, by a robot that has just been built
    };

    void work();
    /// Under the lock: something else is wanted.
    void take_input();
    /// Under the lock.
    void take_what_can_be();
    void build(RobotText source);
    void start(const std::shared_ptr<const Built>& built);
    [[nodiscard]] bool is_input_waiting() const;
    void want_as_before(const Built* before, const Built& now);
    void apply(const Wanted& wanted);
    void to_rest();
    void move_by_hand(const Wanted& wanted);
    [[nodiscard]] std::optional<Pulled> pulled(const std::optional<PullMessage>& message) const;
    void let_go_of_marker();
    void go_on_playing();
    void advance();
    [[nodiscard]] bool may_refine() const;
    void refine();
    void give_way();
    void publish(const sim::LiveProgress& progress, const LiveRobot& shown);
    void forget_history();
    void remember(const sim::Step& step);
    [[nodiscard]] std::string frame_head(const sim::Step& step, const sim::LiveProgress& progress,
                                         const LiveRobot& shown);
    [[nodiscard]] std::string wanted_json() const;
    void tell(const std::string& key, const std::string& json);

    SessionEvents events_;

    mutable std::mutex mutex_;  ///< guards what follows
    mutable std::condition_variable changed_;
    std::optional<RobotText> to_build_;
    Wanted wanted_;
    bool input_ = false;  ///< `wanted_` holds something new
    std::atomic<bool> stopping_ = false;
    bool built_once_ = false;
    std::shared_ptr<const Built> built_;
    std::shared_ptr<const std::string> scene_, frame_;
    std::vector<std::pair<std::string, std::string>> news_;
    sim::Trajectory history_;
    std::size_t history_stride_ = 1, history_seen_ = 0;

    // Of the thread alone.
    std::unique_ptr<LiveRobot> fine_;     ///< its answers are those of the robot that was built
    std::unique_ptr<LiveRobot> preview_;  ///< of Built::preview; null without one
    LiveRobot* hand_ = nullptr;           ///< the one of the two that follows the hand
    LiveRobot* shown_ = nullptr;          ///< the one of the two that was published last
    Wanted now_;                          ///< what was applied last
    double tag_ = 0;
    bool settled_ = true, playing_ = false;
    bool refining_ = false;     ///< the hand's robot has arrived, and the finer one has not
    bool catching_up_ = false;  ///< the hand's robot is behind what was shown
    int revision_ = 0;
    std::uint64_t sequence_ = 0;
    std::chrono::steady_clock::time_point last_frame_at_{};
    std::thread thread_;
};

}  // namespace pliant::studio
