#include "simulation/peers/calculix.hpp"

#include <fmt/format.h>
#include <stdlib.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "base/core/files.hpp"

namespace pliant::sim::calculix {
namespace {

namespace fs = std::filesystem;

/// A temporary folder that is deleted with the object.
class Scratch {
public:
    Scratch() {
        std::string pattern = (fs::temp_directory_path() / "pliant_ccx_XXXXXX").string();
        if (mkdtemp(pattern.data()) != nullptr) folder_ = pattern;
    }
    ~Scratch() {
        std::error_code ignored;
        if (!folder_.empty()) fs::remove_all(folder_, ignored);
    }
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;
    [[nodiscard]] const fs::path& folder() const { return folder_; }

private:
    fs::path folder_;
};

/// Reads the rows of one table of the .dat file, "node x y z" each; `in` is positioned after its heading.
Status read_table(std::istream& in, std::vector<Vec3>& values, double unit) {
    std::string line;
    std::size_t rows = 0;
    while (rows < values.size() && std::getline(in, line)) {
        std::istringstream row(line);
        std::size_t node = 0;
        Vec3 value;
        if (!(row >> node >> value.x >> value.y >> value.z)) {
            if (line.find_first_not_of(" \r") == std::string::npos) continue;
            break;
        }
        if (node < 1 || node > values.size()) continue;  // anchors of cables come after the mesh
        values[node - 1] = unit * value;
        ++rows;
    }
    if (rows != values.size()) return failure("ccx printed {} of {} nodes", rows, values.size());
    return {};
}

/// Displacements and forces at time 1.
Status read_dat(const std::string& text, Solution& solution) {
    std::istringstream in(text);
    int tables = 0;
    for (std::string line; std::getline(in, line);) {
        const auto time = line.find("and time");
        if (time == std::string::npos || std::fabs(std::stod(line.substr(time + 8)) - 1) > 1e-9) continue;
        const bool moves = line.find("displacements") != std::string::npos;
        if (!moves && line.find("forces") == std::string::npos) continue;
        const Status table =
            moves ? read_table(in, solution.displacement_m, 1e-3) : read_table(in, solution.force_N, 1e-6);
        if (!table) return table;
        ++tables;
    }
    if (tables != 2) return failure("ccx did not reach the end of the step");
    return {};
}

/// The .sta file: one line per increment, "step increment attempt iterations ...".
void read_effort(const std::string& text, Solution& solution) {
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) {
        std::istringstream row(line);
        int step = 0;
        int increment = 0;
        std::string attempt;  // "2U" if it did not converge
        int iterations = 0;
        if (!(row >> step >> increment >> attempt >> iterations)) continue;
        solution.increments = std::max(solution.increments, increment);
        solution.iterations += iterations;
    }
}

}  // namespace

bool installed() {
    return std::system("command -v ccx >/dev/null 2>&1") == 0;
}

Result<Solution> solve(const Description& description, const Effort& effort) {
    const Result<std::string> text = deck(description, 1, effort);
    if (!text) return tl::unexpected(text.error());
    const Scratch scratch;
    if (scratch.folder().empty()) return failure("no temporary folder for ccx");
    if (Status written = write_file(scratch.folder() / "robot.inp", *text); !written)
        return tl::unexpected(written.error());

    const auto start = std::chrono::steady_clock::now();
    const std::string command =
        fmt::format("cd '{}' && OMP_NUM_THREADS=1 ccx robot >robot.log 2>&1", scratch.folder().string());
    const int status = std::system(command.c_str());
    Solution solution;
    solution.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const auto dat = read_file(scratch.folder() / "robot.dat");
    if (status != 0 || !dat) {
        const auto log = read_file(scratch.folder() / "robot.log");
        const std::string tail = log ? log->substr(log->size() > 600 ? log->size() - 600 : 0) : "no log";
        return failure("ccx failed (status {}): {}", status, tail);
    }
    solution.displacement_m.resize(description.mesh.points.size());
    solution.force_N.resize(description.mesh.points.size());
    if (Status read = read_dat(*dat, solution); !read) return tl::unexpected(read.error());
    if (const auto sta = read_file(scratch.folder() / "robot.sta")) read_effort(*sta, solution);
    return solution;
}

Vec3 support_force(const Solution& solution, const Support& support) {
    Vec3 sum;
    for (const int n : support.nodes) sum += solution.force_N[static_cast<std::size_t>(n)];
    return sum;
}

Vec3 displacement(const Solution& solution, const Attachment& point) {
    Vec3 sum;
    for (std::size_t k = 0; k < point.nodes.size(); ++k)
        sum += point.weights[k] * solution.displacement_m[static_cast<std::size_t>(point.nodes[k])];
    return sum;
}

}  // namespace pliant::sim::calculix
