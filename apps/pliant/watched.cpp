#include "watched.hpp"

#include "interrupt.hpp"

namespace pliant::app {

Watch watch_of(Progress& progress) {
    return [&progress](std::string_view stage, double share) {
        progress.advance(stage, share);
        return !interrupted();
    };
}

Model load_model(const std::string& robot, const std::vector<std::string>& assignments, const Watch& watch) {
    on_signal(OnSignal::leave);
    Model model(Robot::load(robot, assignments), watch);
    on_signal(OnSignal::ask);
    return model;
}

}  // namespace pliant::app
