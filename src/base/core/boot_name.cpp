#include "base/core/boot_name.hpp"

#include <fstream>

namespace pliant {

std::optional<std::string> boot_name() {
    std::ifstream file("/proc/sys/kernel/random/boot_id");
    std::string name;
    if (!std::getline(file, name) || name.empty()) return std::nullopt;
    return name;
}

}  // namespace pliant
