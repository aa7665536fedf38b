// A pseudo-terminal: one end belongs to this program, the other is a device that any host can open like a serial port.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/core/error.hpp"
#include "base/core/file_handle.hpp"

namespace pliant::twin {

class Pty {
public:
    /// Opens a pseudo-terminal in raw mode; `link` makes a symbolic link of that name to the device (one that a
    /// twin has left behind is replaced). Errors: another file of that name, a link that another twin still serves.
    [[nodiscard]] static Result<Pty> open(const std::filesystem::path& link = {});
    Pty(Pty&& other) noexcept;
    Pty& operator=(Pty&&) = delete;
    ~Pty();  ///< removes the link, if it is still its own

    /// The device for hosts, such as /dev/pts/3.
    [[nodiscard]] const std::string& device() const { return device_; }
    /// Bytes from the host; waits up to `timeout_s` for the first. "" if none came, or while no host has the device
    /// open.
    [[nodiscard]] Result<std::string> read(double timeout_s);
    /// Never blocks: what no host reads is lost, as on a serial line.
    void write(std::string_view bytes);

private:
    Pty(FileHandle file, FileHandle other_end, std::string device);
    FileHandle file_;
    FileHandle other_end_;  ///< kept open, so that the device survives the disconnection of hosts
    std::string device_;
    std::filesystem::path link_;
};

}  // namespace pliant::twin
