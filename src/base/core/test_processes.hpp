// Child processes of a program, for tests.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace pliant::test {

/// Running child processes of `parent` with the name `name` (at most 15 letters).
inline std::vector<pid_t> children_of(pid_t parent, const std::string& name) {
    namespace fs = std::filesystem;
    std::vector<pid_t> found;
    for (const auto& entry : fs::directory_iterator("/proc")) {
        const std::string number = entry.path().filename();
        if (number.find_first_not_of("0123456789") != std::string::npos) continue;
        std::ifstream file(entry.path() / "stat");
        std::string stat;
        std::getline(file, stat, '\0');  // the process may end meanwhile: then nothing is read
        const std::size_t name_end = stat.rfind(')');
        if (stat.find("(" + name + ")") == std::string::npos || name_end == std::string::npos) continue;
        std::istringstream rest(stat.substr(name_end + 1));
        char state = 0;
        pid_t of = 0;
        rest >> state >> of;
        if (of != parent) continue;
        // The main thread may have ended while others, and their open files, still exist.
        std::error_code gone;
        int threads = 0;
        for (fs::directory_iterator thread(entry.path() / "task", gone); !gone && thread != fs::directory_iterator();
             thread.increment(gone))
            ++threads;
        if (state != 'Z' || threads > 1) found.push_back(static_cast<pid_t>(std::stol(number)));
    }
    return found;
}

}  // namespace pliant::test
