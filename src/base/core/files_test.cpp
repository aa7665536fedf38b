#include "base/core/files.hpp"

#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/core/test_folder.hpp"
#include "base/core/test_text.hpp"
#include "base/core/test_variable.hpp"

using namespace pliant;
using test::holds;
namespace fs = std::filesystem;

TEST_CASE("a file is written whole and read back") {
    const test::Folder scratch("files");
    const fs::path file = scratch / "a.bin";
    const std::string bytes("a\0b\n", 4);
    REQUIRE(write_file(file, bytes));
    CHECK(*read_file(file) == bytes);
    CHECK_FALSE(fs::exists(file.string() + ".partial"));
    CHECK(read_file(file, 3).error().message.find("more than") != std::string::npos);
    CHECK(read_file(scratch.path()).error().message.find("folder") != std::string::npos);
    CHECK(read_file(scratch / "none").error().message.find("no such file") != std::string::npos);
    CHECK(read_file("").error().message == "the name of a file is empty");
    fs::create_symlink("loop", scratch / "loop");  // of what the system does not tell the kind
    CHECK(holds(read_file(scratch / "loop").error().message, "loop: Too many levels of symbolic links"));
    CHECK(holds(check_file_place(scratch / "loop").error().message, "loop: Too many levels of symbolic links"));
    CHECK_FALSE(write_file(scratch / "no" / "folder", bytes));
}

TEST_CASE("a file that is replaced keeps who may read and write it") {
    const test::Folder scratch("files");
    const auto mode_of = [](const fs::path& file) { return static_cast<int>(fs::status(file).permissions()); };
    const mode_t before = ::umask(022);
    REQUIRE(write_file(scratch / "new.txt", "1"));
    CHECK(mode_of(scratch / "new.txt") == 0644);
    for (const int mode : {0600, 0664, 0755, 0444}) {
        const fs::path file = scratch / "old.txt";
        REQUIRE(write_file(file, "old"));
        REQUIRE(::chmod(file.c_str(), static_cast<mode_t>(mode)) == 0);
        REQUIRE(write_file(file, "new"));
        CHECK(*read_file(file) == "new");
        CHECK(mode_of(file) == mode);
    }
    ::umask(before);
}

TEST_CASE("what one program writes under a temporary name no other gets, until it is done") {
    using namespace std::chrono_literals;
    const test::Folder scratch("files");
    const fs::path target = scratch / "a.zip", aside = scratch / "a.zip.partial";
    REQUIRE(write_file(aside, "left by a program that was killed"));
    auto first = open_aside(aside, AsideKind::file, target, 0ms);
    REQUIRE(first);
    CHECK(fs::file_size(aside) == 0);
    CHECK(holds(open_aside(aside, AsideKind::file, target, 30ms).error().message, "another program is writing it"));
    CHECK(holds(open_aside(aside, AsideKind::file, target, 0ms).error().message, target.string()));
    fs::rename(aside, target);
    auto second = open_aside(aside, AsideKind::file, target, 0ms);
    REQUIRE(second);  // another file now
    first->close();
    second->close();
    CHECK(open_aside(aside, AsideKind::file, target, 0ms));
    const fs::path results = scratch / "out", filled = scratch / "out.partial";
    fs::create_directory(filled);
    REQUIRE(write_file(filled / "old", "1"));
    CHECK(holds(open_aside(filled, AsideKind::folder, results, 0ms).error().message, "out.partial is in the way"));
    CHECK(fs::exists(filled / "old"));
    REQUIRE(write_file(filled / ".begun", ""));  // as a program that was killed leaves it
    fs::create_symlink(scratch / "nowhere", scratch / "dangling");
    CHECK_FALSE(open_aside(scratch / "dangling" / "x", AsideKind::folder, results, 10min));
    const auto folder = open_aside(filled, AsideKind::folder, results, 0ms);
    REQUIRE(folder);
    CHECK_FALSE(fs::exists(filled / "old"));
    CHECK_FALSE(open_aside(filled, AsideKind::folder, results, 0ms));
}

TEST_CASE("it is told before the work where nothing can be written") {
    const test::Folder scratch("files");
    REQUIRE(write_file(scratch / "file", "1"));
    fs::create_directory(scratch / "mine");
    REQUIRE(write_file(scratch / "mine" / "notes", "1"));
    CHECK(check_file_place(scratch / "new"));
    CHECK(check_file_place(scratch / "file"));
    CHECK(check_file_place("/dev/null"));
    CHECK(holds(check_file_place(scratch / "none" / "new").error().message, "there is no folder"));
    CHECK(holds(check_file_place(scratch / "file" / "new").error().message, "is a file, a folder is needed"));
    CHECK(holds(check_file_place(scratch / "mine").error().message, "is a folder, a file is needed"));
    CHECK(holds(check_file_place(scratch / std::string(255, 'x')).error().message, "the name is too long"));
    CHECK(check_folder_place(scratch / "new" / "deeper", "summary.json"));
    CHECK(holds(check_folder_place(scratch / "file", "summary.json").error().message, "is a file"));
    CHECK(holds(check_folder_place(scratch / "file" / "new", "summary.json").error().message, "is a file"));
    CHECK(holds(check_folder_place(scratch / "mine", "summary.json").error().message, "holds other files"));
    CHECK(check_folder_place(scratch / "mine", "notes"));
    fs::create_symlink("nowhere", scratch / "dangling");
    for (const fs::path& to : {scratch / "dangling", scratch / "dangling" / "deeper"})
        CHECK(holds(check_folder_place(to, "notes").error().message, "is a link to nowhere, which does not exist"));
    fs::create_symlink("mine", scratch / "link");
    CHECK(check_folder_place(scratch / "link", "notes"));
    CHECK(holds(check_folder_place(scratch / "a" / std::string(300, 'x'), "notes").error().message, "too long"));
}

TEST_CASE("a current folder that was deleted is named") {
    const test::Folder scratch("files");
    const fs::path before = fs::current_path();
    fs::create_directory(scratch / "gone");
    fs::current_path(scratch / "gone");
    fs::remove(scratch / "gone");
    const Status file = check_file_place("x.txt"), folder = check_folder_place("x", "notes");
    const Status written = write_file("x.txt", "1"), elsewhere = check_file_place(scratch / "x.txt");
    fs::current_path(before);
    CHECK(holds(file.error().message, "x.txt: the current folder no longer exists"));
    CHECK(holds(folder.error().message, "x: the current folder no longer exists"));
    CHECK_FALSE(written);
    CHECK(elsewhere);
}

TEST_CASE("a symbolic link keeps pointing to the file that is written; devices and pipes are not replaced") {
    const test::Folder scratch("files");
    REQUIRE(write_file(scratch / "real.txt", "old"));
    fs::create_symlink("real.txt", scratch / "link.txt");
    REQUIRE(write_file(scratch / "link.txt", "new"));
    CHECK(fs::is_symlink(scratch / "link.txt"));
    CHECK(*read_file(scratch / "real.txt") == "new");
    CHECK(*replaceable_file(scratch / "link.txt") == fs::canonical(scratch / "real.txt"));
    CHECK(*replaceable_file(scratch / "new.txt") == scratch / "new.txt");

    const fs::path pipe = scratch / "pipe";
    REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
    CHECK(holds(replaceable_file(pipe).error().message, "is not a regular file"));
    // Nobody reads: opening it would wait for ever.
    CHECK(holds(write_file(pipe, "said").error().message, "is not a regular file"));
    CHECK(holds(check_file_place(pipe).error().message, "is not a regular file"));
    fs::create_symlink("pipe", scratch / "to_pipe");
    CHECK(holds(check_file_place(scratch / "to_pipe").error().message, "is not a regular file"));
    CHECK(holds(write_file(scratch / "to_pipe", "said").error().message, "is not a regular file"));
    CHECK(fs::is_fifo(pipe));
    REQUIRE(::mkfifo((scratch / "left.txt.partial").c_str(), 0600) == 0);
    CHECK(holds(write_file(scratch / "left.txt", "said").error().message, "left.txt.partial is in the way"));

    int ends[2] = {-1, -1};  // a pipe that is open, as /dev/stdout may be
    REQUIRE(::pipe(ends) == 0);
    const std::string open_pipe = "/dev/fd/" + std::to_string(ends[1]);
    fs::create_symlink(open_pipe, scratch / "to_open_pipe");
    CHECK(check_file_place(open_pipe));
    CHECK(write_file(open_pipe, "said"));
    CHECK(check_file_place(scratch / "to_open_pipe"));
    CHECK(write_file(scratch / "to_open_pipe", "more"));
    char heard[16] = {};
    CHECK(::read(ends[0], heard, sizeof heard) == 8);
    ::close(ends[0]);
    ::close(ends[1]);
    CHECK(std::string(heard) == "saidmore");

    CHECK(holds(replaceable_file("/dev/null").error().message, "is not a regular file"));
    CHECK(holds(replaceable_file(scratch.path()).error().message, "is a folder"));
    fs::create_symlink("/dev/full", scratch / "full");
    CHECK_FALSE(write_file(scratch / "full", "too much"));
    CHECK(fs::is_symlink(scratch / "full"));
}

TEST_CASE("a file in /dev/shm is replaced as a whole, like any other; one that is open is written to") {
    if (!fs::is_directory("/dev/shm")) return;
    const test::Variable memory("TMPDIR", "/dev/shm");
    const test::Folder scratch("files");
    REQUIRE(scratch.path().string().starts_with("/dev/shm/"));
    REQUIRE(write_file(scratch / "a.txt", "old"));
    fs::create_hard_link(scratch / "a.txt", scratch / "kept.txt");
    REQUIRE(write_file(scratch / "a.txt", "new"));
    CHECK(*read_file(scratch / "a.txt") == "new");
    CHECK(*read_file(scratch / "kept.txt") == "old");  // written to directly, it would be "new"
    CHECK(*replaceable_file("/dev/shm/../shm/x.zip") == "/dev/shm/../shm/x.zip");

    const int file = ::open((scratch / "open.txt").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    REQUIRE(file >= 0);
    CHECK(write_file("/dev/fd/" + std::to_string(file), "through"));
    char there[8] = {};
    CHECK(::pread(file, there, sizeof there, 0) == 7);
    ::close(file);
    CHECK(std::string(there) == "through");
}

TEST_CASE("a mount point is refused before the work; a folder that cannot be replaced keeps its old results") {
    if (::geteuid() != 0) return;  // only root can bind a mount
    const test::Folder scratch("files");
    const fs::path folder = scratch / "out";
    fs::create_directories(folder);
    REQUIRE(write_file(folder / "summary.json", "old"));
    const auto mount = [&] { return ::mount(folder.c_str(), folder.c_str(), nullptr, MS_BIND, nullptr) == 0; };
    if (!mount()) return;
    const Status place = check_folder_place(folder, "summary.json");
    ::umount(folder.c_str());
    CHECK(holds(place.error().message, "is a mount point, which cannot be replaced; name a folder in it"));

    bool is_mounted = false;
    const auto fill = [&](const fs::path& aside) {
        is_mounted = mount();  // somebody does it meanwhile
        return write_file(aside / "summary.json", "new");
    };
    const Status status = write_folder(folder, "summary.json", fill);
    if (is_mounted) ::umount(folder.c_str());
    REQUIRE(is_mounted);
    REQUIRE_FALSE(status);
    CHECK(holds(status.error().message, "the new results are in " + folder.string() + ".partial"));
    CHECK(*read_file(folder / "summary.json") == "old");
    CHECK(*read_file(folder.string() + ".partial/summary.json") == "new");
    CHECK(holds(check_folder_place(folder, "summary.json").error().message, "out.partial is in the way"));
}

TEST_CASE("a folder is written whole or not at all, and folders with other files are not changed") {
    const test::Folder scratch("files");
    const fs::path folder = scratch / "out";
    const auto good = [](const fs::path& aside) { return write_file(aside / "summary.json", "{}"); };
    REQUIRE(write_folder(folder, "summary.json", good));
    REQUIRE(fs::exists(folder / "summary.json"));
    CHECK(write_folder(folder, "summary.json", good));
    CHECK_FALSE(write_folder(folder, "summary.json", [](const fs::path&) -> Status { return failure("no"); }));
    CHECK(fs::exists(folder / "summary.json"));
    CHECK_FALSE(fs::exists(folder.string() + ".partial"));
    CHECK_FALSE(fs::exists(folder.string() + ".replaced"));

    const fs::path foreign = scratch / "foreign";
    fs::create_directories(foreign);
    REQUIRE(write_file(foreign / "thesis.txt", "years of work"));
    CHECK(write_folder(foreign, "summary.json", good).error().cause == Cause::input);
    CHECK(*read_file(foreign / "thesis.txt") == "years of work");
}

TEST_CASE("a link to a folder stays, and what others call as the program would is kept") {
    const test::Folder scratch("files");
    const auto good = [](const fs::path& aside) { return write_file(aside / "summary.json", "{}"); };
    fs::create_directories(scratch / "results");
    fs::create_symlink("results", scratch / "out");
    fs::create_directories(scratch / "results.replaced");
    REQUIRE(write_file(scratch / "results.replaced" / "thesis.txt", "years of work"));
    for (int k = 0; k < 2; ++k) {
        REQUIRE(write_folder(scratch / "out", "summary.json", good));
        CHECK(fs::is_symlink(scratch / "out"));
        CHECK(fs::exists(scratch / "results" / "summary.json"));
        CHECK_FALSE(fs::exists(scratch / "results" / ".begun"));
        CHECK_FALSE(fs::exists(scratch / "results.partial"));
        CHECK_FALSE(fs::exists(scratch / "results.replaced2"));
        CHECK(fs::exists(scratch / "results.replaced" / "thesis.txt"));
    }
    fs::rename(scratch / "results.replaced", scratch / "results.partial");
    CHECK(holds(check_folder_place(scratch / "out", "summary.json").error().message, "results.partial is in the way"));
    CHECK_FALSE(write_folder(scratch / "out", "summary.json", good));
    CHECK(fs::exists(scratch / "results.partial" / "thesis.txt"));
}

TEST_CASE("results of others and what is read are not replaced") {
    const test::Folder scratch("files");
    const fs::path folder = scratch / "out", robot = folder / "robot.toml";
    fs::create_directories(folder);
    REQUIRE(write_file(folder / "summary.json", "{}"));
    REQUIRE(write_file(robot, "a"));
    REQUIRE(write_file(scratch / "out.toml", "a"));
    constexpr std::string_view others[] = {"plan.json", "inverse.json"};
    const FolderMark mark("summary.json", others);
    CHECK(check_folder_place(folder, mark));
    REQUIRE(write_file(folder / "inverse.json", "{}"));
    CHECK(holds(check_folder_place(folder, mark).error().message, "holds other results (inverse.json)"));
    CHECK_FALSE(may_replace_folder(folder, mark));
    CHECK(may_replace_folder(folder, "summary.json"));

    fs::create_symlink("out", scratch / "link");
    fs::create_symlink("out/robot.toml", scratch / "robot.toml");
    for (const fs::path& input : {robot, scratch / "robot.toml", scratch / "link" / "robot.toml"})
        for (const fs::path& to : {folder, scratch / "link", folder / ""})
            CHECK(holds(check_outside(input, to).error().message, "robot.toml: lies in"));
    CHECK(check_outside(scratch / "out.toml", folder));
    CHECK(check_outside(robot, scratch / "new"));
    CHECK(check_outside(folder / "none.toml", folder));
    CHECK(check_outside("", folder));
}

TEST_CASE("what is kept beside a folder lies outside it, however the folder is named") {
    for (const char* name : {"out", "out/", "out//"})
        CHECK(beside_folder(name, ".checkpoint").string() == "out.checkpoint");
    CHECK(beside_folder("/some/out/", ".checkpoint").string() == "/some/out.checkpoint");
    const fs::path here = fs::current_path();
    for (const char* name : {".", "./", "here/.."})
        CHECK(beside_folder(name, ".checkpoint").string() == here.string() + ".checkpoint");
}
