#include "pliant/view.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <cstring>

#include "library/simulation/test_bar.hpp"

using namespace pliant;
using test::bar;

namespace {

/// The JSON of a packet.
std::string head_of(const std::string& packet) {
    REQUIRE(packet.substr(0, 4) == "PLN1");
    std::uint32_t length = 0;
    std::memcpy(&length, packet.data() + 4, 4);
    return packet.substr(8, length);
}

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("a viewer gets the constant data once, and a packet for each state") {
    const Model model(bar());
    const View view(model);
    const std::string scene = head_of(view.scene());
    for (const char* part : {R"("robot":"bar")", R"("revision":1)", R"("name":"tip")", R"("name":"triangles")"})
        CHECK_MESSAGE(has(scene, part), part);
    Stepper stepper(model);
    State state = stepper.rest();
    const std::string still = head_of(view.frame(state));
    CHECK(has(still, R"("markers":[[)"));
    Inputs inputs = state.inputs();
    inputs.cables[0].value -= 0.004;
    (void)stepper.step(state, inputs);
    const std::string moved = head_of(view.frame(state));
    CHECK(moved != still);
    for (const char* field : {"positions", "cables", "von_mises", "stretch", "energy", "\"J\""})
        CHECK_MESSAGE(has(moved, field), field);
    CHECK(view.frame(state.positions(), state.inputs().time) == view.frame(state));
    CHECK_THROWS_WITH_AS((void)view.frame(std::vector<Point>(3), 0), "3 positions for 126 nodes", Failure);
    CHECK_THROWS_WITH_AS((void)view.frame(state.positions(), NAN), "the time is not finite", Failure);
    CHECK_THROWS_WITH_AS((void)View(Model(bar())).frame(state), "the state is one of another model", Failure);
}
