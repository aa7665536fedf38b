// The guard as a process: it hears the host through a socket and, when the host dies, removes the projector's image and
// records how long the last exposure was on.
#pragma once

#include <filesystem>
#include <optional>

#include "base/core/error.hpp"
#include "base/core/file_handle.hpp"
#include "printing/wire/devices.hpp"
#include "printing/wire/guard.hpp"

namespace pliant::operate {

/// Messages from a host to its guard.
enum class GuardWord : long { announced, lit, dark, farewell };

class ProcessGuard final : public host::Guard {
public:
    struct Options {
        std::filesystem::path witness;       ///< file for its observations, beside the journal
        std::filesystem::path shown;         ///< image that a projector shows while the file exists; "": none
        double clock_speed = 1;              ///< seconds of the devices' clock per second of CLOCK_MONOTONIC
        const host::Clock* clock = nullptr;  ///< the devices' clock itself, if given; must outlive the guard
    };
    /// Starts the process; it inherits no open files of this program.
    [[nodiscard]] static Result<ProcessGuard> start(const Options& options);
    ProcessGuard(ProcessGuard&& other) noexcept = default;
    ProcessGuard& operator=(ProcessGuard&&) = delete;
    ~ProcessGuard() override;  ///< the process ends normally

    [[nodiscard]] Status announced(long light) override;
    void lit(double now_s) override;
    void dark(double now_s) override;
    [[nodiscard]] std::optional<double> lit_s(long light) override;
    void forget() override;

private:
    ProcessGuard(FileHandle line, int process, Options options)
        : line_(std::move(line)), process_(process), options_(std::move(options)) {}
    /// Errors: the process has ended.
    [[nodiscard]] Status tell(GuardWord word, long light = 0, double at_s = 0) const;

    FileHandle line_;  ///< closed in a moved-from guard
    int process_ = -1;
    Options options_;
};

}  // namespace pliant::operate
