// Robot files: TOML, parameters and formulas, shapes, units; referenced files do not exist.
#include "input.hpp"
#include "robot/file/robot_file.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    (void)pliant::robot::parse_robot(as_text(data, size), "fuzz.toml", {"program.steps=2"});
    return 0;
}
