// The processes that a program has started, for tests.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

namespace pliant::test {

/// Those of the program `name` (of at most 15 letters) that `parent` has started and that have not ended.
inline std::vector<pid_t> children_of(pid_t parent, const std::string& name) {
    namespace fs = std::filesystem;
    std::vector<pid_t> found;
    for (const auto& entry : fs::directory_iterator("/proc")) {
        const std::string number = entry.path().filename();
        if (number.find_first_not_of("0123456789") != std::string::npos) continue;
        std::ifstream file(entry.path() / "stat");
        const std::string stat{std::istreambuf_iterator<char>(file), {}};
        const std::size_t name_end = stat.rfind(')');
        if (stat.find("(" + name + ")") == std::string::npos || name_end == std::string::npos) continue;
        std::istringstream rest(stat.substr(name_end + 1));
        char state = 0;
        pid_t of = 0;
        rest >> state >> of;
        if (of != parent) continue;
        // Its first thread may have ended while others, and what they have open, are still there.
        std::error_code gone;
        const auto threads =
            std::distance(fs::directory_iterator(entry.path() / "task", gone), fs::directory_iterator());
        if (state != 'Z' || threads > 1) found.push_back(static_cast<pid_t>(std::stol(number)));
    }
    return found;
}

}  // namespace pliant::test
