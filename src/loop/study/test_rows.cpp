// A program that serves rows for tests, in place of pliant: the words of a row say what it does.
#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <charconv>
#include <cmath>
#include <cstdlib>

#include "loop/study/worker.hpp"

namespace {

/// `--set x=VALUE` of a row.
double value_of(const std::vector<std::string>& words, const std::string& key) {
    for (const std::string& word : words) {
        if (word.starts_with(key + "=")) return std::strtod(word.c_str() + key.size() + 1, nullptr);
    }
    return std::nan("");
}

/// The square of x, or a failure chosen by the command's second word.
int work(const std::vector<std::string>& words) {
    const double x = value_of(words, "x");
    const std::string& kind = words.at(1);
    if (kind == "slow") ::usleep(20000);
    if (kind == "crash" && x == 3) ::raise(SIGSEGV);
    if (kind == "killed" && x == 3) ::raise(SIGKILL);
    if (kind == "hang" && x == 3) ::sleep(1000);
    if (kind == "end" && x == 3) std::exit(7);
    if (kind == "fail" && x == 3) {
        fmt::print(stderr, "finger.toml: step 4: no equilibrium\n");
        fmt::print("{{\"error\": \"finger.toml: step 4: no equilibrium\"}}\n");
        return 1;
    }
    if (kind == "wrong" || (kind == "wrong-first" && x < 2)) {
        fmt::print(stderr, "finger.toml:3: stepps: unknown key\n");
        return 2;
    }
    if (kind == "silent" && x == 3) return 0;
    const char* const more = kind == "warn" && x == 3 ? R"(, "warnings": ["below a vacuum", "no balance"])" : "";
    fmt::print("{{\"square\": {}, \"pid\": {}{}}}\n", x * x, ::getpid(), more);
    return 0;
}

}  // namespace

int main() {
    return pliant::study::serve_rows(STDIN_FILENO, [](const std::vector<std::string>& words) {
        return pliant::study::captured([&] { return work(words); });
    });
}
