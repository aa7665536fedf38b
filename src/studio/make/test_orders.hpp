// Orders to slice a small robot, for the tests of the studio's sessions.
#pragma once

#include "base/core/files.hpp"
#include "printing/machine/printer.hpp"
#include "studio/base/test_events.hpp"
#include "studio/make/make_session.hpp"

namespace pliant::studio::test {

/// Waits for the end of slicing and returns its error; "" on success.
inline std::string end_of_slicing(Events& events) {
    return events.wait_for([](const Json& e) { return e["type"] == "slicing" && e["stage"] == ""; })["error"];
}

/// An order to slice `robot` for a tower with few and large pixels, in layers of 50 um.
inline SliceOrder slice_order(const std::string& robot = bar) {
    SliceOrder order;
    order.robot_text = robot;
    order.robot_file = "bar.toml";
    order.printer.text = read_file("examples/printers/tower.toml").value();
    for (const auto& [key, value] : {std::pair("\nwidth = ", "96"), std::pair("\nheight = ", "64")}) {
        const std::size_t at = order.printer.text.find(key);
        REQUIRE(at != std::string::npos);
        order.printer.text.replace(at, order.printer.text.find('\n', at + 1) - at, std::string(key) + value);
    }
    order.printer.printer = machine::parse_printer(order.printer.text, "tower.toml").value();
    order.order.inputs = {"bar.toml"};
    order.order.layer = "50 um";  // thicker layers would not cure through
    return order;
}

}  // namespace pliant::studio::test
