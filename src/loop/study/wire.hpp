// Messages between a study and the processes that run its rows: a length, and JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "base/core/error.hpp"

namespace pliant::study {

/// Sends all of it; false: the other end is gone.
[[nodiscard]] bool send_message(int file, const nlohmann::json& message);

/// Collects what comes on a file until there is a message.
class Inbox {
public:
    /// Reads what is there, or waits for something; false: the other end is gone.
    [[nodiscard]] bool read_some(int file);
    /// The next whole message, if it has come. One that is none, or longer than 64 MB, ends the talk: failed() is true.
    [[nodiscard]] std::optional<nlohmann::json> take();
    [[nodiscard]] bool failed() const { return failed_; }

private:
    std::string come_;
    bool failed_ = false;
};

}  // namespace pliant::study
