// The socket between a host and the program that holds its panel: raw bytes, and messages of any kind; the panel must
// be dark at the end.
#include "printing/screen/screen_wire.hpp"

#include <fmt/format.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>

#include "bytes.hpp"
#include "printing/screen/screen_server.hpp"

namespace {

using namespace pliant;

void receive_raw(std::string_view bytes) {
    std::array<int, 2> ends{};
    if (::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()) != 0) __builtin_trap();
    const host::ScreenSocket here(ends[0]);
    (void)::send(ends[1], bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    ::close(ends[1]);
    for (int i = 0; i < 8 && here.receive(1); ++i) {
    }
}

/// Four by three pixels, frames without delay.
class SmallPanel final : public host::Panel {
public:
    [[nodiscard]] int width_px() const override { return 4; }
    [[nodiscard]] int height_px() const override { return 3; }
    [[nodiscard]] double frame_s() const override { return 1.0 / 60; }
    [[nodiscard]] Result<double> present(const job::Image* image) override {
        lit = image != nullptr;
        return at_s_ += frame_s();
    }
    bool lit = true;

private:
    double at_s_ = 0;
};

host::Message message_of(Bytes& bytes) {
    host::Message message;
    message.say = static_cast<host::Say>(bytes.up_to(8));
    message.width_px = bytes.chance() ? 4 : bytes.signed_byte();
    message.height_px = bytes.chance() ? 3 : bytes.signed_byte();
    message.light.asked_s = bytes.chance() ? 0.1 * bytes.byte() : bytes.any_double();
    message.bytes = bytes.text(bytes.chance() ? 12 : static_cast<std::size_t>(bytes.byte()));
    return message;
}

void serve(Bytes& bytes) {
    static const std::string name = fmt::format("pliant-fuzz-{}", ::getpid());
    auto listener = host::ScreenSocket::listen(name);
    auto host = host::ScreenSocket::connect(name);
    if (!listener || !host) __builtin_trap();
    for (int i = 0; i < 16 && !bytes.empty(); ++i) {
        if (!host->send(message_of(bytes))) __builtin_trap();
    }
    host->close();
    SmallPanel panel;
    (void)host::serve_screen(panel, *listener, {true, 1, "fuzz", [] { return false; }});
    if (panel.lit) __builtin_trap();
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    Bytes bytes(data, size);
    if (bytes.chance())
        receive_raw(bytes.rest());
    else
        serve(bytes);
    return 0;
}
