// What a host and the program that holds its panel (pliant-screen) say to each other: messages with a fixed head over
// a Unix socket. The socket's name tells the panel, so that one panel has one holder and the holder one host; when the
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
    hello,  ///< width_px and height_px of the images that will come; 0: any
    light,  ///< an image of that size, for `light.asked_s`; `bytes` are its pixels
    dark,   ///< black now
    leave,  ///< black, and give the panel back
    // panel to host
    ready,    ///< width_px, height_px, light.frame_s of the panel; `bytes` says what drives it
    lit,      ///< the first frame of a light is on the panel
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

/// One end of the connection; closes it at its end. Movable.
class ScreenSocket {
public:
    ScreenSocket() = default;
    explicit ScreenSocket(int file) : file_(file) {}

    /// Listens under a name that nobody else has; an error if somebody has.
    [[nodiscard]] static Result<ScreenSocket> listen(const std::string& name);
    /// An error if nobody listens.
    [[nodiscard]] static Result<ScreenSocket> connect(const std::string& name);
    /// The next host that waits; none: an empty socket. Other users' programs are turned away.
    [[nodiscard]] ScreenSocket accept() const;

    [[nodiscard]] bool is_open() const { return file_.is_open(); }
    void close() { file_.close(); }
    [[nodiscard]] Status send(const Message& message) const;
    /// Waits for a whole message. Errors: the time is over, the other end is gone, no message of ours.
    [[nodiscard]] Result<Message> receive(double timeout_s) const;
    /// The process that listened at the other end; 0: not known.
    [[nodiscard]] int peer_process() const;
    /// Whether something has come: a message, or the end.
    [[nodiscard]] bool has_news(double timeout_s) const;

private:
    /// Neither listens nor is connected yet.
    [[nodiscard]] static Result<ScreenSocket> make();

    FileHandle file_;
};

/// The name under which the holder of a panel listens; `panel` is a display's or a folder's.
[[nodiscard]] std::string screen_socket_name(std::string_view panel);

}  // namespace pliant::host
