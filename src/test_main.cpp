// The main function of every test program.
//
// With --reference the program holds Pliant against data that does not belong to the repository: without the folder
// that PLIANT_REFERENCE_DATA names it says so and exits 77, which CTest reports as "Skipped".
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>

int main(int argc, char** argv) {
    for (int i = 1; i < argc; ++i) {
        if (std::strcmp(argv[i], "--reference") != 0) continue;
        const char* folder = std::getenv("PLIANT_REFERENCE_DATA");
        if (folder == nullptr || *folder == '\0') {
            std::puts("skipped: PLIANT_REFERENCE_DATA is not set (the folder with the reference meshes and tables)");
            return 77;
        }
    }
    return doctest::Context(argc, argv).run();
}
