// Frames of RFC 6455: the examples of its section 5.7, and what a server must refuse.
#include "studio/requests/frame_reader.hpp"

#include <doctest/doctest.h>

#include <string>

#include "studio/requests/message.hpp"

using namespace pliant::studio;
using Kind = FrameDeed::Kind;

TEST_CASE("a text in one frame and one in fragments are read, with a ping between them") {
    FrameReader reader;
    FrameDeed deed = reader.take(0x81, "Hello");
    CHECK(deed.kind == Kind::text);
    CHECK(deed.bytes == "Hello");
    CHECK(reader.take(0x01, "Hel").kind == Kind::nothing);
    deed = reader.take(0x89, "there?");
    CHECK(deed.kind == Kind::pong);
    CHECK(deed.bytes == "there?");
    CHECK(reader.take(0x8a, "").kind == Kind::nothing);
    CHECK(reader.take(0x00, "").kind == Kind::nothing);
    deed = reader.take(0x80, "lo");
    CHECK(deed.kind == Kind::text);
    CHECK(deed.bytes == "Hello");
    deed = reader.take(0x81, "");
    CHECK(deed.kind == Kind::text);
    CHECK(deed.bytes.empty());
    deed = reader.take(0x88, "\x03\xe8");
    CHECK(deed.kind == Kind::close);
    CHECK(deed.code == CloseCode::normal);
}

TEST_CASE("what breaks the protocol closes the connection, and the code tells why") {
    const std::string long_control(126, 'x');
    struct Wrong {
        int bits;
        std::string payload;
        CloseCode code;
    };
    const Wrong alone[] = {
        {0xc1, "x", CloseCode::protocol_error},           // reserved bits
        {0xa1, "x", CloseCode::protocol_error},           //
        {0x91, "x", CloseCode::protocol_error},           //
        {0x80, "x", CloseCode::protocol_error},           // goes on with nothing
        {0x83, "x", CloseCode::protocol_error},           // opcodes without meaning
        {0x8b, "x", CloseCode::protocol_error},           //
        {0x09, "x", CloseCode::protocol_error},           // control frames in fragments
        {0x08, "", CloseCode::protocol_error},            //
        {0x89, long_control, CloseCode::protocol_error},  //
        {0x8a, long_control, CloseCode::protocol_error},  //
        {0x88, "\x03", CloseCode::protocol_error},        // half a code
        {0x82, "x", CloseCode::not_text},                 //
        {0x02, "x", CloseCode::not_text},                 //
        {0x81, "\xe2\x82", CloseCode::not_utf8},          // breaks off in a character
        {0x81, "\xed\xa0\x80", CloseCode::not_utf8},      // a surrogate
        {0x81, std::string(longest_message + 1, ' '), CloseCode::too_large},
    };
    for (const Wrong& wrong : alone) {
        FrameReader reader;
        const FrameDeed deed = reader.take(wrong.bits, wrong.payload);
        INFO("bits " << wrong.bits << ", " << wrong.payload.size() << " bytes");
        CHECK(deed.kind == Kind::close);
        CHECK(deed.code == wrong.code);
    }
    FrameReader begun;
    REQUIRE(begun.take(0x01, "x").kind == Kind::nothing);
    CHECK(begun.take(0x81, "y").code == CloseCode::protocol_error);  // another text before the end of the first
    FrameReader divided;
    REQUIRE(divided.take(0x01, "\xe2\x82").kind == Kind::nothing);
    CHECK(divided.take(0x80, "\xac").bytes == "\xe2\x82\xac");  // a character in two fragments
    FrameReader growing;
    REQUIRE(growing.take(0x01, std::string(longest_message, ' ')).kind == Kind::nothing);
    CHECK(growing.take(0x80, " ").code == CloseCode::too_large);
    FrameReader full;
    CHECK(full.take(0x81, std::string(longest_message, ' ')).bytes.size() == longest_message);
}

TEST_CASE("a close frame carries its code with the high byte first") {
    CHECK(close_payload(CloseCode::going_away) == "\x03\xe9");
}
