// Protocol between a host and the program that holds its panel (pliant-screen): messages with a fixed header over a
// Unix socket. The socket's name identifies the panel, so one panel has one holder and the holder one host; when the
// connection ends, for whatever reason, the panel goes black.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "base/core/error.hpp"
#include "base/core/file_handle.hpp"
#include "printing/wire/devices.hpp"

namespace pliant::host {

enum class Say : std::uint32_t {
    // host to panel
    hello,  ///< width_px and height_px of the images to come; 0: any
    light,  ///< an image of that size, for `light.asked_s`; `bytes` are its pixels
    dark,   ///< black at once
    leave,  ///< black, and release the panel
    // panel to host
    ready,    ///< width_px, height_px, light.frame_s of the panel; `bytes` names its driver
    lit,      ///< the first frame of an exposure is on the panel
    ended,    ///< `light` is over, by itself or by `dark`
    is_dark,  ///< answer to `dark` and `leave`
    refused,  ///< `bytes` say why; the connection ends
};

struct Message {
    Say say = Say::hello;
    int width_px = 0, height_px = 0;
    Light light;
    std::string bytes;
};

/// One end of the connection, closed by the destructor. Movable.
class ScreenSocket {
public:
    ScreenSocket() = default;
    explicit ScreenSocket(int file) : file_(file) {}

    /// Listens under a unique name; an error if it is taken.
    [[nodiscard]] static Result<ScreenSocket> listen(const std::string& name);
    /// An error if nothing listens there.
    [[nodiscard]] static Result<ScreenSocket> connect(const std::string& name);
    /// The next waiting host; if none, an empty socket. Programs of other users are rejected.
    [[nodiscard]] ScreenSocket accept() const;

    [[nodiscard]] bool is_open() const { return file_.is_open(); }
    void close() { file_.close(); }
    [[nodiscard]] Status send(const Message& message) const;
    /// Waits for a whole message. Errors: timeout, connection closed, not a message of this protocol.
    [[nodiscard]] Result<Message> receive(double timeout_s) const;
    /// The process listening at the other end; 0: unknown.
    [[nodiscard]] int peer_process() const;
    /// Whether anything has arrived: a message, or the end of the connection.
    [[nodiscard]] bool has_news(double timeout_s) const;

private:
    /// Not yet listening or connected.
    [[nodiscard]] static Result<ScreenSocket> make();

    FileHandle file_;
};

/// The name under which the holder of a panel listens; `panel` is a display's or a folder's.
[[nodiscard]] std::string screen_socket_name(std::string_view panel);

}  // namespace pliant::host
