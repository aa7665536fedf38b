#include "command.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "base/core/files.hpp"
#include "interrupt.hpp"
#include "printed.hpp"
#include "progress_text.hpp"

namespace pliant::app {
namespace {

class TerminalProgress final : public Progress {
public:
    explicit TerminalProgress(bool visible) : visible_(visible), start_(Clock::now()) { on_signal(OnSignal::ask); }
    ~TerminalProgress() override {
        if (shown_) std::fputs("\r\033[K", stderr);
        on_signal(OnSignal::end);
    }
    TerminalProgress(const TerminalProgress&) = delete;
    TerminalProgress& operator=(const TerminalProgress&) = delete;

    void advance(std::string_view stage, double fraction) override {
        const auto now = Clock::now();
        if (stage != stage_) {
            stage_ = stage;
            stage_start_ = now;
        }
        if (!visible_ || now - start_ < std::chrono::seconds(1) || now - last_ < std::chrono::milliseconds(100)) return;
        last_ = now;
        shown_ = true;
        const double elapsed_s = std::chrono::duration<double>(now - stage_start_).count();
        fmt::print(stderr, "\r\033[K{}", progress_line(stage_, fraction, elapsed_s));
        std::fflush(stderr);
    }
    [[nodiscard]] bool cancelled() const override { return interrupted(); }

private:
    using Clock = std::chrono::steady_clock;

    bool visible_;
    bool shown_ = false;
    std::string stage_;
    Clock::time_point start_, stage_start_, last_;
};

/// One line for each problem; a text without problems is one line.
std::string error_text(const Error& error) {
    if (error.problems.empty()) return one_line(error.message);
    // Whoever passed it on may have added to the message.
    if (error_of(error.cause, error.problems).message != error.message) return visible_lines(error.message);
    std::string text;
    for (const Diagnostic& problem : error.problems) text += (text.empty() ? "" : "\n") + one_line(shown(problem));
    return text;
}

void tell_error(const std::string& message, const std::string& text, bool json) {
    fmt::print(stderr, "{}\n", text);
    if (json) print_json(nlohmann::json{{"error", message}}, -1);
}

}  // namespace

void add_output_options(CLI::App& command, Output& output, bool with_json) {
    command.add_flag("-q,--quiet", output.quiet, "print errors only");
    if (with_json) command.add_flag("--json", output.json, "print the result as JSON");
}

int report(const Error& error, bool json) {
    tell_error(error.message, error_text(error), json);
    return error.cause == Cause::input ? exit_bad_input : exit_failed;
}

int report(const Failure& failure, bool json) {
    tell_error(failure.what(), visible_lines(failure.what()), json);
    return failure.kind() == Failure::Kind::input ? exit_bad_input : exit_failed;
}

bool asks_for_json(const CLI::App& command) {
    const CLI::Option* option = command.get_option_no_throw("--json");
    return option != nullptr && option->count() > 0;
}

Status check_file_places(std::initializer_list<std::string> files) {
    for (const std::string& file : files) {
        if (file.empty()) continue;
        if (Status place = check_file_place(file); !place) return place;
    }
    return {};
}

std::unique_ptr<Progress> terminal_progress(const Output& output) {
    return std::make_unique<TerminalProgress>(!output.quiet && isatty(STDERR_FILENO) == 1);
}

}  // namespace pliant::app
