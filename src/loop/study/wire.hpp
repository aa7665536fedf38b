// Messages between a study and its worker processes: a length, and JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "base/core/error.hpp"

namespace pliant::study {

/// Sends the whole message; false: the other end is closed.
[[nodiscard]] bool send_message(int file, const nlohmann::json& message);

/// Buffers received bytes until a message is complete.
class Inbox {
public:
    /// Reads available bytes, or waits for some; false: the other end is closed.
    [[nodiscard]] bool read_some(int file);
    /// The next complete message, if any. An invalid one, or one longer than 64 MB, ends the connection: failed() is
    /// true.
    [[nodiscard]] std::optional<nlohmann::json> take();
    [[nodiscard]] bool failed() const { return failed_; }

private:
    std::string come_;
    bool failed_ = false;
};

}  // namespace pliant::study
