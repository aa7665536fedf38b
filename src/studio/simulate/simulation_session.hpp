// The interactive robot: builds it from its file, follows the inputs of the page, and reports the results. All work is
// done on a thread of its own; the latest input wins.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
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

#include "studio/requests/message.hpp"
#include "studio/simulate/built_robot.hpp"
#include "studio/simulate/live_robot.hpp"
#include "studio/simulate/reduced_hand.hpp"
#include "studio/simulate/state_history.hpp"
#include "studio/simulate/wanted_inputs.hpp"

namespace pliant::studio {

/// Called from the session's thread.
struct SessionEvents {
    std::function<void(const std::string& json)> text;
    std::function<void(std::shared_ptr<const std::string> packet)> frame;
    std::function<std::set<std::string>()> fields;  ///< fields that some page shows
    bool beside = false;            ///< it is the second robot, compared with the edited one, and its frames say so
    std::int64_t numbers_from = 0;  ///< the first robot that is built has the revision after this
};

class SimulationSession {
public:
    explicit SimulationSession(SessionEvents events);
    ~SimulationSession();
    SimulationSession(const SimulationSession&) = delete;
    SimulationSession& operator=(const SimulationSession&) = delete;

    /// Builds this robot; a build in progress is cancelled. There are no events of the old robot once the new one is
    /// built. If its actuators differ from the old ones it starts from rest in any case.
    void open(RobotText source, After after = After::from_rest);
    /// An input that has no meaning for this robot: unknown actuators, kinds and markers, values and times out of
    /// range. While a robot is being built nothing is known of it, and what it cannot do has no effect.
    [[nodiscard]] Status check(const Message& message) const;
    void drive(const DriveMessage& message);
    void follow(const Follow& message);
    void play(bool on);
    void rest();
    void pull(const PullMessage& message);
    void lead(const LeadMessage& message);
    /// Releases a pulled point or dragged marker.
    void release();
    /// Sends the current state again, as when a page requests another field.
    void show_again();

    /// Null before the first robot has been built.
    [[nodiscard]] std::shared_ptr<const Built> built() const;
    [[nodiscard]] std::shared_ptr<const std::string> scene() const;
    [[nodiscard]] std::shared_ptr<const std::string> last_frame() const;
    /// The current activity, or the errors of the last file: JSON events for a newly connected page.
    [[nodiscard]] std::vector<std::string> news() const;
    /// The converged states since rest, rest first; thinned out if there are too many.
    [[nodiscard]] sim::Trajectory history() const;
    /// Waits until a robot has been built or rejected; for tests and programs.
    [[nodiscard]] bool wait_until_built() const;

private:
    class Watch;
    void work();
    void change(const std::function<void(WantedInputs&)>& how);
    void build(RobotText source);
    void show(const std::shared_ptr<const Built>& built);
    void start(const std::shared_ptr<const Built>& built);
    [[nodiscard]] bool is_input_waiting() const;
    void want_as_before(const Built* before, const Built& now);
    void apply(const WantedInputs& wanted);
    void to_rest();
    void move_by_hand(const WantedInputs& wanted);
    [[nodiscard]] std::optional<Pulled> pulled(const std::optional<PullMessage>& message) const;
    void let_go_of_marker();
    void go_on_playing();
    void advance();
    [[nodiscard]] bool advance_reduced();
    [[nodiscard]] bool may_refine() const;
    void refine();
    void give_way();
    void publish(const sim::LiveProgress& progress, const LiveRobot& shown);
    void publish(const ReducedHand::Shown& shown);
    void send(const sim::Step& step, const std::string& head);
    void forget_history();
    void remember(const sim::Step& step);
    /// What the page is told of a state.
    struct About {
        int order = 2;
        bool arrived = false;
        std::string stuck;
        int iterations = 0;
        std::vector<std::string> warnings;
        int pulled_vertex = -1;
        Vec3 pull_force_N{};
        std::optional<double> reduced_error_m{};  ///< of a reduced model: the estimate
    };
    [[nodiscard]] std::string frame_head(const sim::Step& step, const About& about);
    [[nodiscard]] std::string wanted_json() const;
    void tell(const std::string& key, const std::string& json);

    SessionEvents events_;

    mutable std::mutex mutex_;  ///< guards what follows
    mutable std::condition_variable changed_;
    std::optional<RobotText> to_build_;
    WantedInputs wanted_;
    bool input_ = false;  ///< `wanted_` has changed
    std::atomic<bool> stopping_ = false;
    bool built_once_ = false;
    std::shared_ptr<const Built> built_;
    std::vector<double> rest_measures_;  ///< of the actuators of `built_`
    std::shared_ptr<const std::string> scene_, frame_;
    std::vector<std::pair<std::string, std::string>> news_;
    StateHistory history_;

    // Used by the session's thread only.
    std::unique_ptr<LiveRobot> fine_;       ///< gives the final results, on the model as built
    std::unique_ptr<LiveRobot> preview_;    ///< on Built::preview; null without one
    std::unique_ptr<ReducedHand> reduced_;  ///< likewise: moves sliders in place of the preview, once it is ready
    LiveRobot* hand_ = nullptr;             ///< the one that follows the interaction
    LiveRobot* shown_ = nullptr;            ///< the one published last
    WantedInputs now_;                      ///< the inputs applied last
    double tag_ = 0;
    bool settled_ = true, playing_ = false;
    bool refining_ = false;     ///< the interactive robot has arrived, the fine one has not
    bool catching_up_ = false;  ///< the interactive robot is behind what was shown
    std::int64_t revision_ = events_.numbers_from;
    std::uint64_t sequence_ = 0;
    std::chrono::steady_clock::time_point last_frame_at_{};
    std::thread thread_;
};

}  // namespace pliant::studio
