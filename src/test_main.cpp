// The main function of every test program.
//
// With --reference the program holds Pliant against data that does not belong to the repository: without the folder
// that PLIANT_REFERENCE_DATA names it says so and exits 77, which CTest reports as "Skipped". --peer=PROGRAM likewise
// stands for tests that run another program beside Pliant. With PLIANT_NO_SKIPS=1 in the environment a test that would
// be skipped fails instead: for machines that should have everything.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

namespace {

bool is_set(const char* variable) {
    const char* value = std::getenv(variable);
    return value != nullptr && *value != '\0';
}

/// The exit status of a test that cannot run, whose reason it prints.
int skip(const std::string& reason) {
    const bool fails = is_set("PLIANT_NO_SKIPS");
    std::printf("%s: %s\n", fails ? "failed, because PLIANT_NO_SKIPS is set" : "skipped", reason.c_str());
    return fails ? 1 : 77;
}

bool on_path(const std::string& program) {
    return std::system(("command -v " + program + " >/dev/null 2>&1").c_str()) == 0;
}

}  // namespace

int main(int argc, char** argv) {
    for (int i = 1; i < argc; ++i) {
        const std::string_view argument = argv[i];
        const std::string_view peer = "--peer=";
        if (argument.starts_with(peer)) {
            const std::string program(argument.substr(peer.size()));
            if (!on_path(program)) return skip(program + " is not installed");
        }
        if (argument != "--reference") continue;
        if (!is_set("PLIANT_REFERENCE_DATA")) {
            return skip("PLIANT_REFERENCE_DATA is not set (the folder with the reference meshes and tables)");
        }
    }
    return doctest::Context(argc, argv).run();
}
