// A controller of its own around `step`: it pulls a finger's cable until the tip is where it is wanted, looks ahead
// with a copy of the state, and goes on from a state that was kept in a file.
//   controller ROBOT.toml
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <pliant/simulation.hpp>

namespace {

double height_mm(const pliant::Stepper& stepper, const pliant::State& state) {
    return 1e3 * stepper.observe(state).markers.at(0).position_m[2];
}

}  // namespace

int main(int count, char** words) try {
    if (count != 2) {
        std::fprintf(stderr, "usage: controller ROBOT.toml, a robot with a cable and a marker\n");
        return 2;
    }
    const pliant::Robot robot = pliant::Robot::load(words[1], {"mesh.order=1"});
    const pliant::Model model(robot);
    pliant::Stepper stepper(model);
    pliant::State state = stepper.rest();
    pliant::Inputs inputs = state.inputs();

    // Secant steps towards a tip that is lifted by 10 mm.
    const double wanted_mm = height_mm(stepper, state) + 10;
    double pull_m = 0.001;
    double lifted_per_m = 0;
    for (int k = 0; k < 12 && std::fabs(wanted_mm - height_mm(stepper, state)) > 0.01; ++k) {
        const double before_mm = height_mm(stepper, state);
        inputs.cables[0].value -= pull_m;
        const pliant::StepResult result = stepper.step(state, inputs);
        if (!result.arrived) throw std::runtime_error(result.reason);
        lifted_per_m = (height_mm(stepper, state) - before_mm) / pull_m;
        std::printf("cable %.3f mm, tip at %.3f mm\n", 1e3 * inputs.cables[0].value, height_mm(stepper, state));
        pull_m = (wanted_mm - height_mm(stepper, state)) / lifted_per_m;
    }
    std::printf("off by %.4f mm\n", height_mm(stepper, state) - wanted_mm);

    // What a millimetre more would do, without doing it.
    pliant::State ahead = state;
    pliant::Inputs more = inputs;
    more.cables[0].value -= 0.001;
    stepper.step(ahead, more);
    std::printf("a millimetre more: %.3f mm higher\n", height_mm(stepper, ahead) - height_mm(stepper, state));

    // The same from a file, in another stepper: the same bits.
    const auto file = std::filesystem::temp_directory_path() / "pliant_controller.state";
    state.save(file);
    pliant::Stepper other(model);
    pliant::State again = other.load(file);
    std::filesystem::remove(file);
    other.step(again, more);
    std::printf("%s\n", again.bytes() == ahead.bytes() ? "the same bits" : "other bits");
    return again.bytes() == ahead.bytes() ? 0 : 1;
} catch (const std::exception& failure) {
    std::fprintf(stderr, "%s\n", failure.what());
    return 1;
}
