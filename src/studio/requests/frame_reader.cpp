#include "studio/requests/frame_reader.hpp"

#include <utility>

#include "base/core/utf8.hpp"
#include "studio/requests/message.hpp"

namespace pliant::studio {
namespace {

enum Opcode { continued = 0, text = 1, binary = 2, close = 8, ping = 9, pong = 10 };

constexpr int last_bit = 0x80, reserved_bits = 0x70, opcode_bits = 0x0f;
constexpr std::size_t longest_control = 125;

FrameDeed closed(CloseCode code) {
    return {FrameDeed::Kind::close, {}, code};
}

}  // namespace

FrameDeed FrameReader::control(int opcode, bool last, std::string_view payload) {
    if (!last || payload.size() > longest_control) return closed(CloseCode::protocol_error);
    if (opcode == ping) return {FrameDeed::Kind::pong, std::string(payload)};
    if (opcode == pong) return {};
    // A code has two bytes, if there is one at all.
    return closed(opcode == close && payload.size() != 1 ? CloseCode::normal : CloseCode::protocol_error);
}

FrameDeed FrameReader::take(int bits, std::string_view payload) {
    const int opcode = bits & opcode_bits;
    const bool last = (bits & last_bit) != 0;
    if ((bits & reserved_bits) != 0) return closed(CloseCode::protocol_error);
    if (opcode >= close) return control(opcode, last, payload);
    if (opcode > binary || (opcode == continued) != is_open_) return closed(CloseCode::protocol_error);
    if (opcode == binary) return closed(CloseCode::not_text);
    if (payload.size() > longest_message - text_.size()) return closed(CloseCode::too_large);
    text_ += payload;
    is_open_ = !last;
    if (!last) return {};
    // Of the whole text: a character may lie in two fragments.
    if (!is_utf8(text_)) return closed(CloseCode::not_utf8);
    return {FrameDeed::Kind::text, std::exchange(text_, {})};
}

std::string close_payload(CloseCode code) {
    const auto number = static_cast<unsigned>(code);
    return {static_cast<char>(number >> 8U), static_cast<char>(number & 0xffU)};
}

}  // namespace pliant::studio
