// The main function of every test program.
//
// With --reference the program holds Pliant against data that does not belong to the repository: without the folder
// that PLIANT_REFERENCE_DATA names it says so and exits 77, which CTest reports as "Skipped". --peer=PROGRAM likewise
// stands for tests that run another program beside Pliant.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

namespace {

constexpr int skipped = 77;

bool on_path(const std::string& program) {
    return std::system(("command -v " + program + " >/dev/null 2>&1").c_str()) == 0;
}

}  // namespace

int main(int argc, char** argv) {
    for (int i = 1; i < argc; ++i) {
        const std::string_view argument = argv[i];
        const std::string_view peer = "--peer=";
        if (argument.starts_with(peer) && !on_path(std::string(argument.substr(peer.size())))) {
            std::printf("skipped: %s is not installed\n", argv[i] + peer.size());
            return skipped;
        }
        if (argument != "--reference") continue;
        const char* folder = std::getenv("PLIANT_REFERENCE_DATA");
        if (folder == nullptr || *folder == '\0') {
            std::puts("skipped: PLIANT_REFERENCE_DATA is not set (the folder with the reference meshes and tables)");
            return skipped;
        }
    }
    return doctest::Context(argc, argv).run();
}
