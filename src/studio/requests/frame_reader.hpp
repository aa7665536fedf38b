// What a page sends over its WebSocket, frame by frame, as RFC 6455 has it: texts put together from their fragments,
// pings to answer, and the code with which a connection that breaks the protocol is closed.
#pragma once

#include <string>
#include <string_view>

namespace pliant::studio {

/// Codes of RFC 6455, section 7.4.1.
enum class CloseCode : unsigned short {
    normal = 1000,
    going_away = 1001,
    protocol_error = 1002,
    not_text = 1003,
    not_utf8 = 1007,
    too_large = 1009,
};

/// What a frame asks for.
struct FrameDeed {
    enum class Kind { nothing, text, pong, close } kind = Kind::nothing;
    std::string bytes{};                 ///< the whole text, or what the pong carries
    CloseCode code = CloseCode::normal;  ///< of `close`
};

/// Reads the frames of one connection, in order.
class FrameReader {
public:
    /// `bits`: the first byte of the frame (FIN, RSV and opcode). `payload` is unmasked. After `close` it must not be
    /// called again.
    [[nodiscard]] FrameDeed take(int bits, std::string_view payload);

private:
    [[nodiscard]] static FrameDeed control(int opcode, bool last, std::string_view payload);
    std::string text_;      ///< so far
    bool is_open_ = false;  ///< a text has begun, and more of it must come
};

/// The two bytes that a close frame carries.
[[nodiscard]] std::string close_payload(CloseCode code);

}  // namespace pliant::studio
