#include "geometry/mesher/mesh_worker.hpp"

#include <doctest/doctest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "base/core/files.hpp"
#include "base/core/test_folder.hpp"
#include "base/core/test_processes.hpp"
#include "base/core/test_variable.hpp"
#include "geometry/mesh/test_shapes.hpp"
#include "geometry/mesher/mesher.hpp"

using namespace pliant;
using namespace pliant::mesh;
using namespace pliant::mesh::test;
using pliant::test::Variable;

namespace {

/// Running pliant-mesh child processes.
std::vector<pid_t> meshers() {
    return pliant::test::children_of(::getpid(), "pliant-mesh");
}

void kill_all() {
    for (const pid_t process : meshers()) ::kill(process, SIGKILL);
    while (!meshers().empty()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

const std::vector<BodyGeometry> cube{{"cube", box({0, 0, 0}, {10, 10, 10})}};

Result<TetMesh> mesh_cube(double size, Progress& progress) {
    return mesh_bodies(cube, {.size = size, .order = 1}, progress);
}

/// Cancels the work after a while.
class CancelledAfter300ms : public Progress {
public:
    [[nodiscard]] bool cancelled() const override { return std::chrono::steady_clock::now() > until_; }

private:
    std::chrono::steady_clock::time_point until_ = std::chrono::steady_clock::now() + std::chrono::milliseconds(300);
};

}  // namespace

TEST_CASE("one process serves all requests, and a killed one is replaced") {
    kill_all();
    Progress silent;
    const Result<TetMesh> first = mesh_cube(5, silent);
    REQUIRE_MESSAGE(first, (first ? "" : first.error().message));
    const std::vector<pid_t> before = meshers();
    REQUIRE(before.size() == 1);
    const Result<TetMesh> second = mesh_cube(5, silent);
    REQUIRE(second);
    CHECK(meshers() == before);
    CHECK(second->points == first->points);
    CHECK(second->nodes == first->nodes);

    kill_all();
    const Result<TetMesh> third = mesh_cube(5, silent);
    REQUIRE_MESSAGE(third, (third ? "" : third.error().message));
    CHECK(third->points == first->points);
    CHECK(meshers() != before);
}

TEST_CASE("simultaneous requests have separate processes and get the same answers") {
    Progress silent;
    const Result<TetMesh> expected = mesh_cube(2, silent);
    REQUIRE(expected);
    std::vector<std::optional<Result<TetMesh>>> found(3);
    std::vector<std::thread> threads;
    for (auto& result : found) {
        threads.emplace_back([&result] {
            Progress own;
            result = mesh_cube(2, own);
        });
    }
    for (std::thread& thread : threads) thread.join();
    for (const auto& result : found) {
        REQUIRE(result->has_value());
        CHECK((*result)->points == expected->points);
    }
}

TEST_CASE("a forked program starts a process of its own, and leaves its parent's alone") {
    kill_all();
    Progress silent;
    const Result<TetMesh> coarse = mesh_cube(5, silent);
    REQUIRE(coarse);
    const std::vector<pid_t> before = meshers();
    REQUIRE(before.size() == 1);
    const pid_t fork = ::fork();
    REQUIRE(fork >= 0);
    if (fork == 0) {
        const Result<TetMesh> mesh = mesh_cube(5, silent);
        const bool good = mesh && mesh->points == coarse->points && meshers().size() == 1;
        kill_all();
        ::_exit(good ? 0 : 1);
    }
    int status = -1;
    REQUIRE(::waitpid(fork, &status, 0) == fork);
    CHECK(status == 0);
    CHECK(meshers() == before);
    const Result<TetMesh> after = mesh_cube(5, silent);
    REQUIRE(after);
    CHECK(after->points == coarse->points);
    CHECK(meshers() == before);
}

TEST_CASE("a mesher that is killed at work gives one error, and the next request is served") {
    std::thread killer([] {
        std::this_thread::sleep_for(std::chrono::milliseconds(500));
        kill_all();
    });
    Progress silent;
    const Result<TetMesh> mesh = mesh_cube(0.1, silent);  // a million tets: longer than half a second
    killer.join();
    REQUIRE_FALSE(mesh);
    CHECK(mesh.error().cause == Cause::failed);
    CHECK(mesh.error().message ==
          "pliant-mesh was killed, as happens when memory runs out; take a larger mesh size, or end other programs "
          "(signal 9: Killed)");
    CHECK(mesh_cube(5, silent));
}

TEST_CASE("cancelling ends the mesher at once") {
    CancelledAfter300ms impatient;
    const auto begin = std::chrono::steady_clock::now();
    const Result<TetMesh> mesh = mesh_cube(0.1, impatient);
    REQUIRE_FALSE(mesh);
    CHECK(mesh.error().cause == Cause::cancelled);
    CHECK(std::chrono::steady_clock::now() - begin < std::chrono::seconds(5));
}

TEST_CASE("time and memory limits are reported") {
    Progress silent;
    {
        kill_all();
        const Variable seconds("PLIANT_MESH_SECONDS", "0.5");
        const Result<TetMesh> mesh = mesh_cube(0.1, silent);
        REQUIRE_FALSE(mesh);
        CHECK(mesh.error().message ==
              "meshing took longer than 0.5 s and was ended; take a larger mesh size, or more time "
              "(PLIANT_MESH_SECONDS)");
    }
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    const Variable memory("PLIANT_MESH_GIGABYTES", "0.3");
    const Result<TetMesh> mesh = mesh_cube(0.15, silent);
    REQUIRE_FALSE(mesh);
    INFO(mesh.error().message);
    const bool told = mesh.error().message.find("memory") != std::string::npos ||
                      mesh.error().message.find("the mesher crashed") == 0;
    CHECK(told);
    kill_all();
#endif
}

TEST_CASE("limits that are no positive numbers are refused, and huge ones are as good as none") {
    kill_all();
    Progress silent;
    for (const char* name : {"PLIANT_MESH_SECONDS", "PLIANT_MESH_GIGABYTES"}) {
        for (const char* wrong : {"abc", "-1", "0", "nan", "inf", "", "1 h"}) {
            const Variable set(name, wrong);
            const Result<TetMesh> mesh = mesh_cube(5, silent);
            REQUIRE_FALSE(mesh);
            CHECK(mesh.error().cause == Cause::input);
            CHECK(mesh.error().message == std::string(name) + " is \"" + wrong + "\"; it must be a number over 0");
        }
        const Variable huge(name, "1e300");
        const Result<TetMesh> mesh = mesh_cube(5, silent);
        CHECK_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
        kill_all();
    }
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    const Variable little("PLIANT_MESH_GIGABYTES", "0.0001");
    const Result<TetMesh> mesh = mesh_cube(5, silent);
    REQUIRE_FALSE(mesh);
    CHECK(mesh.error().message.find("pliant-mesh does not start; PLIANT_MESH_GIGABYTES is 0.0001") == 0);
#endif
}

TEST_CASE("a program that talks without end, or says nothing, is not taken for the mesher") {
    kill_all();
    const pliant::test::Folder folder("talker");
    const std::filesystem::path talker = folder / "talker";
    REQUIRE(write_file(talker, "#!/bin/sh\nexec yes >&0\n"));  // its input leads back to who started it
    std::filesystem::permissions(talker, std::filesystem::perms::owner_all);
    const auto begin = std::chrono::steady_clock::now();
    {
        Progress silent;
        const Variable other("PLIANT_MESH", talker.c_str());
        const Result<TetMesh> mesh = mesh_cube(5, silent);
        REQUIRE_FALSE(mesh);
        CHECK(mesh.error().message.find("what PLIANT_MESH names is another program") != std::string::npos);
    }
    CancelledAfter300ms impatient;
    const Variable other("PLIANT_MESH", "/usr/bin/yes");
    const Result<TetMesh> mesh = mesh_cube(5, impatient);
    REQUIRE_FALSE(mesh);
    CHECK(mesh.error().cause == Cause::cancelled);
    CHECK(std::chrono::steady_clock::now() - begin < std::chrono::seconds(10));
}

TEST_CASE("a missing or invalid mesher is reported by name") {
    kill_all();
    Progress silent;
    {
        const Variable nowhere("PLIANT_MESH", "/nowhere/pliant-mesh");
        CHECK(mesh_cube(5, silent).error().message ==
              "PLIANT_MESH names \"/nowhere/pliant-mesh\", which is not a file; it must be the program pliant-mesh");
    }
    const Variable other("PLIANT_MESH", "/bin/true");
    const Result<TetMesh> mesh = mesh_cube(5, silent);
    REQUIRE_FALSE(mesh);
    CHECK(mesh.error().message.find("pliant-mesh does not start") == 0);
}

TEST_CASE("a mesher is found with an installation that PATH names") {
    const pliant::test::Folder folder("path");
    std::filesystem::create_directories(folder / "empty/bin");
    std::filesystem::create_directories(folder / "usr/bin");
    std::filesystem::create_directories(folder / "usr/libexec/pliant/pliant-mesh");  // a folder is not a program
    const std::string path = (folder / "empty/bin").string() + ":relative::" + (folder / "usr/bin").string();
    CHECK(mesher_on(path).empty());
    CHECK(mesher_on("").empty());
    std::filesystem::remove(folder / "usr/libexec/pliant/pliant-mesh");
    REQUIRE(write_file(folder / "usr/libexec/pliant/pliant-mesh", "program"));
    const auto found = mesher_on(path);
    REQUIRE(!found.empty());
    CHECK(std::filesystem::equivalent(found, folder / "usr/libexec/pliant/pliant-mesh"));
    CHECK(mesher_on((folder / "empty/bin").string()).empty());
}

TEST_CASE("a mesher is found from where a program or library is, or in the build tree around it") {
    namespace fs = std::filesystem;
    const pliant::test::Folder folder("places");
    const auto put = [&](const fs::path& file) {
        fs::create_directories((folder / file).parent_path());
        REQUIRE(write_file(folder / file, "program"));
    };
    const auto from = [&](std::vector<fs::path> places) {
        for (fs::path& place : places) place = folder / place;
        return mesher_from(places);
    };
    const auto is = [&](const fs::path& found, const char* file) {
        REQUIRE(!found.empty());
        CHECK(fs::equivalent(found, folder / file));
    };
    put("usr/bin/program");
    put("usr/lib/x86_64-linux-gnu/libpliant.so");
    put("build/python/pliant/module.so");
    put("build/apps/pliant/pliant-mesh");
    CHECK(from({"usr/bin", "usr/lib/x86_64-linux-gnu"}).empty());
    CHECK(from({"build/python/pliant"}).empty());  // no build tree: it was not configured by cmake
    put("build/CMakeCache.txt");
    is(from({"build/python/pliant"}), "build/apps/pliant/pliant-mesh");
    is(from({"build"}), "build/apps/pliant/pliant-mesh");
    CHECK(from({"usr/bin"}).empty());
    put("usr/libexec/pliant/pliant-mesh");
    is(from({"usr/bin"}), "usr/libexec/pliant/pliant-mesh");
    is(from({"usr/lib/x86_64-linux-gnu"}), "usr/libexec/pliant/pliant-mesh");
    // The first folder decides, which is the library's: a module of the build tree takes no mesher of its interpreter.
    is(from({"build/python/pliant", "usr/bin"}), "build/apps/pliant/pliant-mesh");
    is(from({"usr/lib/x86_64-linux-gnu", "build/python/pliant"}), "usr/libexec/pliant/pliant-mesh");
    put("usr/bin/pliant-mesh");
    is(from({"usr/bin"}), "usr/bin/pliant-mesh");
    CHECK(mesher_from({}).empty());
    CHECK(mesher_from(std::vector<fs::path>{"", "relative"}).empty());
}

TEST_CASE("cached answers need no mesher, are identical, and are removed when the cache is full") {
    Progress silent;
    const Result<TetMesh> first = mesh_cube(5, silent);
    REQUIRE(first);
    remember_answers(std::size_t{1} << 20);
    REQUIRE(mesh_cube(5, silent));
    {
        const Variable nowhere("PLIANT_MESH", "/nowhere");
        kill_all();
        const Result<TetMesh> known = mesh_cube(5, silent);
        REQUIRE_MESSAGE(known, (known ? "" : known.error().message));
        CHECK(known->points == first->points);
        CHECK(known->nodes == first->nodes);
        CHECK_FALSE(mesh_cube(4, silent));  // a different request
        remember_answers(0);
        CHECK_FALSE(mesh_cube(5, silent));
    }
    remember_answers(1000);  // too small for any mesh
    REQUIRE(mesh_cube(5, silent));
    const Variable nowhere("PLIANT_MESH", "/nowhere");
    kill_all();
    CHECK_FALSE(mesh_cube(5, silent));
    remember_answers(0);
}
