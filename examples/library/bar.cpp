// The bar of the README: a cable along its upper side is pulled by 5 mm in ten steps.
#include <cstdio>
#include <pliant/pliant.hpp>

int main() try {
    const pliant::Robot robot = pliant::Robot::parse(R"(
        name = "bar"
        length_unit = "mm"
        material.soft = { youngs_modulus = "1 MPa", poisson_ratio = 0.45 }
        body = [{ name = "bar", material = "soft", geometry = { box = [[0, 0, 0], [100, 10, 10]] } }]
        fixed = [{ name = "clamp", box = [[0, 0, 0], [0, 10, 10]] }]
        marker = [{ name = "tip", point = [100, 5, 5] }]
        [[cable]]
        name = "flexor"
        points = [[0, 5, 9], [25, 5, 9], [50, 5, 9], [75, 5, 9], [100, 5, 9]]
        target.shortening = "5 mm"
    )");
    const pliant::Model model(robot);
    pliant::Stepper stepper(model);
    pliant::State state = stepper.rest();
    for (int k = 1; k <= 10; ++k) {
        stepper.step(state, {.cables = {{pliant::Drive::By::length, 0.1 - 0.0005 * k}}});
        const pliant::Observation seen = stepper.observe(state);
        const pliant::Point tip = seen.markers[0].position_m;
        std::printf("%.1f mm: tension %.3f N, tip (%.2f, %.2f) mm\n", 0.5 * k, seen.cables[0].tension_N, 1e3 * tip[0],
                    1e3 * tip[2]);
    }
} catch (const pliant::Failure& failure) {
    std::fprintf(stderr, "%s\n", failure.what());
    return 1;
}
