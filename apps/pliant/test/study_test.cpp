// `pliant study` as used by people and on clusters: real simulations, a closed form, kills, ranks, errors.
#include <doctest/doctest.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "base/core/files.hpp"
#include "base/core/near.hpp"
#include "base/core/process.hpp"
#include "base/core/test_folder.hpp"
#include "base/core/test_variable.hpp"
#include "loop/study/folder.hpp"

using namespace pliant;
namespace fs = std::filesystem;

namespace {

/// A bar that is stretched by a tenth: the force is proportional to Young's modulus, whatever the mesh.
const std::string bar = R"(name = "bar"
length_unit = "mm"
material.soft = { youngs_modulus = "1 MPa", poisson_ratio = 0.45 }
body = [{ name = "bar", material = "soft", geometry = { box = [[0, 0, 0], [40, 10, 10]] } }]
mesh = { size = "10 mm", order = 1 }
marker = [{ name = "tip", point = [40, 5, 5] }]
fixed = [{ name = "clamp", box = [[0, 0, 0], [0, 10, 10]] }, { name = "end", box = [[40, 0, 0], [40, 10, 10]], move = [4, 0, 0] }]
program = { steps = 1 }
)";
const std::string modulus = "key.modulus = { set = \"material.soft.youngs_modulus\", range = [\"1 MPa\", \"4 MPa\"]";
const std::string force = "result.force = \"supports.end.force_N[0]\"\n";
const std::string head = "command = [\"simulate\", \"bar.toml\"]\n";

struct Ended {
    int status = 0;
    std::string output, errors;
};

class Place {
public:
    explicit Place(const std::string& study) {
        REQUIRE(write_file(folder_ / "bar.toml", bar));
        write(study);
    }
    void write(const std::string& study) const { REQUIRE(write_file(folder_ / "s.toml", study)); }
    [[nodiscard]] fs::path operator/(const std::string& name) const { return folder_ / name; }

    [[nodiscard]] pid_t start(const std::vector<std::string>& more, const std::string& name = "told") const {
        const int out = ::open((folder_ / (name + ".out")).c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0600);
        const int err = ::open((folder_ / (name + ".err")).c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0600);
        std::vector<std::string> words{"study"};
        words.insert(words.end(), more.begin(), more.end());
        const auto process = start_process(PLIANT_PROGRAM, words, {-1, out, err});
        ::close(out);
        ::close(err);
        REQUIRE(process);
        return *process;
    }
    [[nodiscard]] Ended wait(pid_t process, const std::string& name = "told") const {
        Ended ended;
        int status = 0;
        REQUIRE(::waitpid(process, &status, 0) == process);
        ended.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
        ended.output = read_file(folder_ / (name + ".out")).value();
        ended.errors = read_file(folder_ / (name + ".err")).value();
        return ended;
    }
    [[nodiscard]] Ended run(std::vector<std::string> more = {}) const {
        more.insert(more.begin(), {(folder_ / "s.toml").string(), "-o", (folder_ / "o").string()});
        return wait(start(more));
    }
    [[nodiscard]] nlohmann::json summary(const std::string& out = "o") const {
        return nlohmann::json::parse(read_file(folder_ / out / "summary.json").value());
    }

private:
    test::Folder folder_{"study"};
};

/// The column of numbers under a name in results.csv; "" cells are left out.
std::vector<double> column(const fs::path& file, const std::string& name) {
    std::istringstream text(read_file(file).value());
    std::string line, cell;
    std::getline(text, line);
    std::istringstream names(line);
    std::size_t wanted = 0;
    for (std::size_t k = 0; std::getline(names, cell, ','); ++k) wanted = cell == name ? k : wanted;
    std::vector<double> numbers;
    while (std::getline(text, line)) {
        std::istringstream cells(line);
        for (std::size_t k = 0; k <= wanted; ++k) std::getline(cells, cell, ',');
        if (!cell.empty()) numbers.push_back(std::stod(cell));
    }
    return numbers;
}

}  // namespace

TEST_CASE("an empty name of the output is an error, of a study as of other commands") {
    const Place place(head + "plan = \"grid\"\n" + modulus + ", levels = 2 }\n" + force);
    const Ended ended = place.wait(place.start({(place / "s.toml").string(), "-o", ""}));
    CHECK(ended.status == 2);
    CHECK(ended.errors.starts_with("pliant study: --output: the name is empty"));
}

TEST_CASE("a key of a material that the robot does not have fails every row, and says so") {
    const Place place(
        head + "plan = \"grid\"\n" +
        "key.modulus = { set = \"material.sotf.youngs_modulus\", range = [\"1 MPa\", \"4 MPa\"], levels = 2 "
        "}\n" +
        force);
    const Ended ended = place.run();
    CHECK(ended.status == 1);
    CHECK(ended.errors.find("2 of 2 rows failed; row 0: --set material.sotf: the file has no material \"sotf\", and "
                            "nothing would use it; did you mean \"soft\"?") != std::string::npos);
}

TEST_CASE("a study gives forces proportional to the modulus in every row, and the same on one core and on two") {
    const Place place(head + "plan = \"sobol\"\nsamples = 12\n" + modulus + " }\n" + force);
    const Ended ended = place.run({"--jobs", "2"});
    REQUIRE_MESSAGE(ended.status == 0, ended.errors);
    const auto moduli = column(place / "o/results.csv", "modulus (MPa)"),
               forces = column(place / "o/results.csv", "force");
    REQUIRE(moduli.size() == 12);
    REQUIRE(forces.size() == 12);
    for (std::size_t k = 0; k < 12; ++k) {
        CHECK((moduli[k] >= 1 && moduli[k] < 4));
        // 1e-6: the solver's tolerance.
        CHECK(forces[k] / moduli[k] == near(forces[0] / moduli[0], {.relative = 1e-6}));
    }
    REQUIRE(
        place.wait(place.start({(place / "s.toml").string(), "-o", (place / "one").string(), "--jobs", "1"})).status ==
        0);
    CHECK(read_file(place / "one/results.csv").value() == read_file(place / "o/results.csv").value());
    CHECK(fs::exists(place / "o/plots/force_over_modulus.png"));
    CHECK(fs::exists(place / "o/results.npz"));
}

TEST_CASE("Sobol indices of a simulated force: 1 for the modulus, 0 for the place of the marker") {
    const Place place(head + "plan = \"sensitivity\"\nsamples = 16\n" + modulus + " }\n" +
                      "key.mark = { set = \"marker.tip.point\", values = [\"[40, 5, 5]\", \"[40, 2, 2]\"] }\n" + force);
    const Ended ended = place.run({"--json"});
    REQUIRE_MESSAGE(ended.status == 0, ended.errors);
    const auto told = nlohmann::json::parse(ended.output);
    CHECK(told["rows"] == 64);
    const auto& keys = told["results"]["force"]["sensitivity"]["keys"];
    CHECK(keys["modulus"]["total"]["value"].get<double>() == near(1, {.absolute = 0.1}));
    CHECK(keys["modulus"]["first"]["value"].get<double>() == near(1, {.absolute = 0.1}));
    CHECK(keys["mark"]["total"]["value"].get<double>() == near(0, {.absolute = 1e-9}));
}

TEST_CASE("a row that fails is kept with its reason, and the other rows are run") {
    const Place place(
        head + "plan = \"grid\"\nkey.poisson = { set = \"material.soft.poisson_ratio\", values = [0.3, 0.7, 0.4] }\n" +
        force);
    const Ended ended = place.run();
    CHECK(ended.status == 1);
    CHECK(ended.errors.find("1 of 3 rows failed; row 1: ") != std::string::npos);
    CHECK(ended.errors.find("poisson_ratio") != std::string::npos);
    const auto summary = place.summary();
    CHECK(summary["done"] == 2);
    CHECK(summary["failed"] == 1);
    CHECK(summary["failures"][0]["row"] == 1);
}

TEST_CASE("a row of inverse that misses its goal says where and why, one with a wrong option what is wrong") {
    const Place place(
        "command = [\"inverse\", \"reach.toml\"]\nplan = \"grid\"\n"
        "key.starts = { option = \"--starts\", values = [0, 2000] }\n"
        "result.ratio = \"waypoints[-1].inputs.pull\"\n");
    REQUIRE(write_file(place / "reach.toml", R"(name = "reach"
length_unit = "mm"
material.soft = { youngs_modulus = "1 MPa", poisson_ratio = 0.45 }
body = [{ name = "bar", material = "soft", geometry = { box = [[0, 0, 0], [40, 10, 10]] } }]
mesh = { size = "10 mm", order = 1 }
marker = [{ name = "tip", point = [40, 5, 5] }]
fixed = [{ name = "clamp", box = [[0, 0, 0], [0, 10, 10]] }]
cable = [{ name = "pull", points = [[0, 5, 5], [40, 5, 5]], range = [0.95, 1.0] }]
goal = [{ name = "back", marker = "tip", point = [20, 5, 5] }]
)"));
    CHECK(place.run().status == 1);
    const auto failures = place.summary()["failures"];
    REQUIRE(failures.size() == 2);
    CHECK(failures[0]["reason"] == "waypoint 1 of 1 is not reached: pull is at the lower end of its range");
    CHECK(failures[1]["reason"].get<std::string>().starts_with("pliant inverse: --starts: write a whole number from "));
}

TEST_CASE("a study killed at any time resumes to the results of a study that was never stopped") {
    const Place place(head + "plan = \"sobol\"\nsamples = 60\n" + modulus + " }\n" + force);
    int kills = 0;
    for (int turn = 0; turn < 8; ++turn) {
        const pid_t process =
            place.start({(place / "s.toml").string(), "-o", (place / "o").string(), "--resume", "--jobs", "2"});
        ::usleep(static_cast<useconds_t>(150000 + 77777 * turn % 500000));
        if (::kill(process, SIGKILL) == 0) ++kills;
        (void)place.wait(process);
    }
    CHECK(kills == 8);
    REQUIRE(place.run({"--resume"}).status == 0);
    REQUIRE(place.wait(place.start({(place / "s.toml").string(), "-o", (place / "whole").string()})).status == 0);
    CHECK(read_file(place / "whole/results.csv").value() == read_file(place / "o/results.csv").value());
    const auto summary = place.summary();
    CHECK(summary["doubled_records"] == 0);
    CHECK(summary["damaged_records"] == 0);
}

TEST_CASE("Ctrl-C ends a study with status 1 and says how to continue") {
    const Place place(head + "plan = \"sobol\"\nsamples = 5000\n" + modulus + " }\n" + force);
    const pid_t process = place.start({(place / "s.toml").string(), "-o", (place / "o").string(), "--jobs", "2"});
    for (int look = 0; look < 6000 && !fs::exists(place / "o/records/00000.rows"); ++look) ::usleep(10000);
    ::kill(process, SIGINT);
    const Ended ended = place.wait(process);
    CHECK(ended.status == 1);
    CHECK(ended.errors.starts_with("cancelled: "));
    CHECK(ended.errors.find("of 5000 rows are in") != std::string::npos);
    CHECK(ended.errors.find("--resume continues") != std::string::npos);
}

TEST_CASE("the ranks that mpirun or srun would start share the rows") {
    const Place place(head + "plan = \"sobol\"\nsamples = 30\n" + modulus + " }\n" + force);
    std::vector<pid_t> ranks;
    for (int rank = 0; rank < 3; ++rank) {
        const test::Variable number("OMPI_COMM_WORLD_RANK", std::to_string(rank).c_str());
        const test::Variable size("OMPI_COMM_WORLD_SIZE", "3");
        ranks.push_back(place.start({(place / "s.toml").string(), "-o", (place / "o").string(), "--on", "mpi"},
                                    "rank" + std::to_string(rank)));
    }
    for (int rank = 0; rank < 3; ++rank) {
        const Ended ended = place.wait(ranks[static_cast<std::size_t>(rank)], "rank" + std::to_string(rank));
        CHECK_MESSAGE(ended.status == 0, ended.errors);
        CHECK(ended.output.empty() == (rank != 0));
    }
    CHECK(place.summary()["done"] == 30);
    const Ended alone = place.run({"--on", "mpi"});
    CHECK(alone.status == 2);
    CHECK(alone.errors.find("neither mpirun nor srun started this") != std::string::npos);
}

TEST_CASE("any scheduler may run the chunks of a planned study one by one") {
    const Place place(head + "plan = \"sobol\"\nsamples = 4\nslurm.rows_per_task = 2\n" + modulus + " }\n" + force);
    const Ended planned = place.run({"--plan-only"});
    CHECK(planned.status == 0);
    CHECK(planned.output.find("4 rows in 2 chunks") != std::string::npos);
    for (const char* chunk : {"0", "1"})
        CHECK(place.wait(place.start({(place / "o").string(), "--chunk", chunk})).status == 0);
    const Ended none = place.wait(place.start({(place / "o").string(), "--chunk", "2"}));
    CHECK(none.status == 2);
    CHECK(none.errors.find("the study has 2 chunks, from 0 on") != std::string::npos);
    REQUIRE(place.run({"--resume"}).status == 0);
    CHECK(place.summary()["accounts"]["this_run"]["rows"] == 0);
}

TEST_CASE("a study can run any command that has --json") {
    const Place place(
        "command = [\"mesh\", \"bar.toml\", \"-o\", \"{row}/bar.vtk\"]\nplan = \"grid\"\n"
        "key.size = { set = \"mesh.size\", values = [\"10 mm\", \"5 mm\"] }\nresult.tets = \"tets\"\n");
    const Ended ended = place.run();
    REQUIRE_MESSAGE(ended.status == 0, ended.errors);
    const auto tets = column(place / "o/results.csv", "tets");
    REQUIRE(tets.size() == 2);
    CHECK(tets[1] > 2 * tets[0]);  // of a bar as thin as the coarser tets are long
    CHECK(fs::exists(place / "o/rows/000001/bar.vtk"));
}

TEST_CASE("mistakes in a study end before anything runs, with one line") {
    const Place place(head + "plan = \"grid\"\n" + modulus +
                      ", levels = 2 }\nresult.force = \"supports.nd.force_N[0]\"\n");
    Ended ended = place.run();
    CHECK(ended.status == 2);
    CHECK(ended.errors.find("s.toml:4: result.force: steps[-1].supports has no \"nd\"; did you mean \"end\"?: there is "
                            "clamp and end\n") != std::string::npos);
    place.write("command = [\"studio\"]\nplan = \"grid\"\n" + modulus + ", levels = 2 }\n" + force);
    ended = place.run();
    CHECK(ended.status == 2);
    CHECK(ended.errors.find("a study cannot run \"studio\"") != std::string::npos);
    ended = place.wait(place.start({(place / "nothing.toml").string()}));
    CHECK(ended.status == 2);
}
