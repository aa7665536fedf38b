// Which pull brings a finger's tip where it is wanted? Newton's method with the exact derivative of the state, and then
// what the materials do to the place that was reached.
//   gradient ROBOT.toml
#include <cmath>
#include <cstdio>
#include <pliant/linearisation.hpp>

int main(int count, char** words) try {
    if (count != 2) {
        std::fprintf(stderr, "usage: gradient ROBOT.toml, a robot with a cable and a marker\n");
        return 2;
    }
    const pliant::Model model(pliant::Robot::load(words[1], {"mesh.order=1"}));
    pliant::Stepper stepper(model, {.tolerance = 1e-9});
    pliant::State state = stepper.rest();
    pliant::Inputs inputs = state.inputs();
    inputs.cables.at(0).value -= 0.002;
    stepper.step(state, inputs);

    const auto height_m = [&] { return stepper.observe(state).markers.at(0).position_m[2]; };
    const double wanted_m = height_m() + 0.01;
    for (int k = 0; k < 10 && std::fabs(wanted_m - height_m()) > 1e-8; ++k) {
        pliant::Linearisation at(state);
        const auto gradient = at.gradient(at.marker_coordinate(0, {0, 0, 1}));
        inputs.cables[0].value += (wanted_m - height_m()) / gradient.inputs.at(0);
        if (const auto result = stepper.step(state, inputs); !result.arrived)
            throw pliant::Failure(pliant::Failure::Kind::failed, result.reason);
        std::printf("cable %.4f mm, off by %.6f mm\n", 1e3 * inputs.cables[0].value, 1e3 * (height_m() - wanted_m));
    }

    pliant::Linearisation at(state);
    pliant::Quantity tension;
    tension.by_tensions.resize(inputs.cables.size());
    tension.by_tensions[0] = 1;
    const auto gradient = at.gradient(tension);
    for (std::size_t p = 0; p < at.parameters().size(); ++p)
        if (const pliant::Parameter& of = at.parameters()[p]; of.value != 0 && gradient.parameters[p] != 0)
            std::printf("one percent more of %s: %+.4f N of tension\n", of.name.c_str(),
                        0.01 * of.value * gradient.parameters[p]);
    return std::fabs(wanted_m - height_m()) <= 1e-8 ? 0 : 1;
} catch (const std::exception& failure) {
    std::fprintf(stderr, "%s\n", failure.what());
    return 1;
}
