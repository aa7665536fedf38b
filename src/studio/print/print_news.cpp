#include "studio/print/print_news.hpp"

#include <sys/wait.h>

#include <thread>

#include "base/core/process.hpp"

namespace pliant::studio {
namespace {

std::string layers_text(const host::Snapshot& now) {
    return now.layer < 0 ? "" : fmt::format(", layer {} of {}", now.layer + 1, now.layers);
}

std::string with(const std::string& text, const std::string& message) {
    return message.empty() ? text : text + ": " + message;
}

}  // namespace

std::optional<PrintNews> news_between(const host::Snapshot& before, const host::Snapshot& now) {
    using host::State;
    if (now.finished && !before.finished) return PrintNews{"finished", now.job + " is printed"};
    if (now.state == State::halted && before.state != State::halted)
        return PrintNews{"stopped", with(now.job + ": the machine has stopped" + layers_text(now), now.message)};
    if (now.failed && !before.failed)
        return PrintNews{"failed", with(now.job + ": the print has failed" + layers_text(now), now.message)};
    const bool asks = now.state == State::paused && !now.prompt.empty();
    if (asks && (before.state != State::paused || before.prompt != now.prompt))
        return PrintNews{"waiting", with(now.job + " waits for you" + layers_text(now), now.prompt)};
    return std::nullopt;
}

Status tell_by_command(const std::string& command, const PrintNews& news, const std::string& job) {
    const Result<pid_t> process = start_process(
        "/usr/bin/env",
        {"PLIANT_EVENT=" + news.event, "PLIANT_TEXT=" + news.text, "PLIANT_JOB=" + job, "sh", "-c", command}, {});
    if (!process) return tl::unexpected(process.error());
    std::thread([id = *process] { ::waitpid(id, nullptr, 0); }).detach();
    return {};
}

}  // namespace pliant::studio
