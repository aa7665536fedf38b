// `--set KEY=VALUE`, one per line, applied to a valid robot file.
#include <string>
#include <vector>

#include "input.hpp"
#include "robot/file/robot_file.hpp"

namespace {

constexpr std::string_view good = R"(name = "bar"
length_unit = "mm"
[parameter]
length = 40
[material.soft]
youngs_modulus = "1 MPa"
poisson_ratio = 0.4
[[body]]
name = "bar"
geometry = { box = [[0, 0, 0], ["length", 10, 10]] }
material = "soft"
[[fixed]]
name = "clamp"
box = [[0, 0, 0], [0, 10, 10]]
[[cable]]
name = "flexor"
points = [[0, 5, 8], [40, 5, 8]]
target = { length_ratio = 0.9 }
)";

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::vector<std::string> assignments;
    for (std::string_view text = as_text(data, size); !text.empty() && assignments.size() < 8;) {
        const std::string_view line = text.substr(0, text.find('\n'));
        text.remove_prefix(std::min(text.size(), line.size() + 1));
        assignments.emplace_back(line);
    }
    (void)pliant::robot::parse_robot(good, "bar.toml", assignments);
    return 0;
}
