// The clock of a virtual printer, shared with its host through a file: both measure exposures by it. The printer does
// not wait for the host: it moves the clock on by at most 0.1 s at once, also while the host is busy.
#pragma once

#include <filesystem>

#include "base/core/error.hpp"
#include "printing/wire/devices.hpp"

namespace pliant::operate {

class ClockFile final : public host::Clock {
public:
    /// For the printer: creates the file, in place of an older clock. Errors: the file is there and is no clock.
    [[nodiscard]] static Result<ClockFile> create(const std::filesystem::path& path);
    /// For the host. Errors: no such file, or not a clock.
    [[nodiscard]] static Result<ClockFile> open(const std::filesystem::path& path);
    ClockFile(ClockFile&& other) noexcept;
    ClockFile& operator=(ClockFile&&) = delete;
    ~ClockFile() override;

    void set(double seconds) const;
    [[nodiscard]] double now() const override;
    void sleep(double seconds) override;

private:
    explicit ClockFile(double* seconds) : seconds_(seconds) {}
    double* seconds_ = nullptr;
};

}  // namespace pliant::operate
