// Reads range, rate and price of actuators.
#include <fmt/format.h>

#include "robot/file/goal_file.hpp"

namespace pliant::robot {
namespace {

using config::Reader;

double read_price(Reader& price, std::string_view key) {
    const double value = price.number(key, 0);
    if (!(value >= 0 && value <= 1e6)) price.problem(key, "is a weight relative to other prices: 0 to 1000000");
    return value;
}

}  // namespace

std::optional<SteeringSpec> read_steering(Reader& actuator, const SteeredBy& by) {
    if (!actuator.has("range")) {
        for (const char* key : {"rate", "price"}) {
            if (actuator.raw(key) != nullptr)
                actuator.problem(key, "belongs to an actuator with a range, such as range = [0.7, 1.0]");
        }
        return (void)actuator.raw("range"), std::nullopt;
    }
    SteeringSpec steering;
    steering.line = actuator.line_of("range");
    const std::vector<double> range =
        by.dimension ? actuator.quantities("range", *by.dimension, 2) : actuator.numbers("range", 2);
    if (range.size() != 2) return std::nullopt;
    steering.low = range[0];
    steering.high = range[1];
    if (!(steering.low < steering.high))
        actuator.problem("range", "is empty: write the lower end first, and a higher one");
    else if (steering.low < by.low || steering.high > by.high)
        actuator.problem("range", fmt::format("is not possible; its ends are {}", by.possible));
    if (actuator.has("rate")) {
        steering.rate = by.dimension ? actuator.quantity("rate", *by.dimension) : actuator.number("rate");
        if (!(*steering.rate > 0)) actuator.problem("rate", "must be above zero: the largest change per waypoint");
    }
    (void)actuator.raw("rate");
    if (!actuator.has("price")) return (void)actuator.raw("price"), steering;
    Reader price = actuator.table("price");
    steering.effort_price = read_price(price, by.effort);
    steering.change_price = read_price(price, "change");
    price.finish();
    return steering;
}

std::optional<SteeringSpec> skip_steering(Reader& actuator, const std::string& name, Context& context) {
    context.unclear_targets.insert(name);
    if (!actuator.has("range")) return read_steering(actuator, {});
    for (const char* key : {"range", "rate", "price"}) (void)actuator.raw(key);
    SteeringSpec any;
    any.line = actuator.line_of("range");
    return any;
}

}  // namespace pliant::robot
