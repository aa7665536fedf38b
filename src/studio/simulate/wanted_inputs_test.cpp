#include "studio/simulate/wanted_inputs.hpp"

#include <doctest/doctest.h>

using namespace pliant::studio;

namespace {

DriveMessage slider(const char* name, double value) {
    DriveMessage message;
    message.actuators = {{name, "length_ratio", value}};
    return message;
}

const auto possible = [](const ActuatorValue& value) { return value.value > 0.5; };

}  // namespace

TEST_CASE("of the positions of a slider the last possible one counts") {
    WantedInputs wanted;
    for (const double value : {0.9, 0.8, 0.2}) {
        wanted.drive(slider("flexor", value));
        wanted.take_asked(possible);
    }
    wanted.drive(slider("other", 0.7));
    wanted.take_asked(possible);
    REQUIRE(wanted.actuators.size() == 2);
    CHECK(wanted.actuators[0].value == 0.8);
    CHECK(wanted.actuators[1].name == "other");
}

TEST_CASE("a slider that is moved ends playing and dragging; playing forgets the sliders") {
    WantedInputs wanted;
    wanted.lead_marker({});
    wanted.play(true);
    CHECK_FALSE(wanted.lead);
    CHECK(wanted.playing);
    wanted.drive(slider("flexor", 0.9));
    CHECK_FALSE(wanted.playing);
    wanted.take_asked(possible);
    wanted.play(true);
    CHECK(wanted.actuators.empty());
}

TEST_CASE("a marker that is let go of is told once") {
    WantedInputs wanted;
    wanted.pull_at({});
    wanted.release();
    CHECK_FALSE(wanted.let_go);
    wanted.lead_marker({});
    wanted.release();
    CHECK(wanted.let_go);
    CHECK(wanted.changed);
    wanted.forget_requests();
    CHECK_FALSE(wanted.let_go);
    CHECK_FALSE(wanted.changed);
}
