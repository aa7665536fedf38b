#include "command.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "interrupt.hpp"

namespace pliant::app {
namespace {

class TerminalProgress final : public Progress {
public:
    explicit TerminalProgress(bool visible) : visible_(visible), start_(std::chrono::steady_clock::now()) {
        on_signal(OnSignal::ask);
    }
    ~TerminalProgress() override {
        if (shown_) std::fputs("\r\033[K", stderr);
        on_signal(OnSignal::end);
    }
    TerminalProgress(const TerminalProgress&) = delete;
    TerminalProgress& operator=(const TerminalProgress&) = delete;

    void advance(std::string_view stage, double fraction) override {
        using namespace std::chrono;
        const auto now = steady_clock::now();
        if (!visible_ || now - start_ < seconds(1) || now - last_ < milliseconds(100)) return;
        last_ = now;
        shown_ = true;
        const int filled = static_cast<int>(30 * std::clamp(fraction, 0.0, 1.0));
        fmt::print(stderr, "\r\033[K{:>9} [{:<30}] {:3.0f} %", stage,
                   std::string(static_cast<std::size_t>(filled), '='), 100 * fraction);
        std::fflush(stderr);
    }
    [[nodiscard]] bool cancelled() const override { return interrupted(); }

private:
    bool visible_;
    bool shown_ = false;
    std::chrono::steady_clock::time_point start_;
    std::chrono::steady_clock::time_point last_;
};

}  // namespace

void add_output_options(CLI::App& command, Output& output, bool with_json) {
    command.add_flag("-q,--quiet", output.quiet, "print errors only");
    if (with_json) command.add_flag("--json", output.json, "print the result as JSON");
}

int report(const Error& error) {
    fmt::print(stderr, "{}\n", error.message);
    return error.cause == Cause::input ? exit_bad_input : exit_failed;
}

std::unique_ptr<Progress> terminal_progress(const Output& output) {
    return std::make_unique<TerminalProgress>(!output.quiet && isatty(STDERR_FILENO) == 1);
}

}  // namespace pliant::app
