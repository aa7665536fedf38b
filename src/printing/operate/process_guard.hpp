// The guard as a process: it waits at the end of a pipe whose other end is the host's, and when that falls silent it
// takes away the projector's picture and writes down for how long the last light was on.
#pragma once

#include <filesystem>
#include <optional>

#include "base/core/error.hpp"
#include "base/core/file_handle.hpp"
#include "printing/wire/devices.hpp"
#include "printing/wire/guard.hpp"

namespace pliant::operate {

/// What a host tells its guard.
enum class GuardWord : long { announced, lit, dark, farewell };

class ProcessGuard final : public host::Guard {
public:
    struct Options {
        std::filesystem::path witness;       ///< file for what it has seen, beside the journal
        std::filesystem::path shown;         ///< picture that a projector shows as long as it is there; "": none
        double clock_speed = 1;              ///< seconds of the devices' clock in one of CLOCK_MONOTONIC
        const host::Clock* clock = nullptr;  ///< or that clock itself; must outlive the guard
    };
    /// Starts the process; nothing that the program has open stays open in it.
    [[nodiscard]] static Result<ProcessGuard> start(const Options& options);
    ProcessGuard(ProcessGuard&& other) noexcept = default;
    ProcessGuard& operator=(ProcessGuard&&) = delete;
    ~ProcessGuard() override;  ///< the process ends in peace

    void announced(long light) override;
    void lit(double now_s) override;
    void dark(double now_s) override;
    [[nodiscard]] std::optional<double> lit_s(long light) override;

private:
    ProcessGuard(FileHandle pipe, int process, Options options)
        : pipe_(std::move(pipe)), process_(process), options_(std::move(options)) {}
    void tell(GuardWord word, long light = 0, double at_s = 0) const;

    FileHandle pipe_;  ///< none where the guard has been moved from
    int process_ = -1;
    Options options_;
};

}  // namespace pliant::operate
