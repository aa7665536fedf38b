#include "printing/screen/screen_server.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <utility>

#include "printing/screen/screen_light.hpp"
#include "printing/wire/steady_clock.hpp"

namespace pliant::host {
namespace {

constexpr double idle_s = 0.02;  // interval of checks for the panel's own events
constexpr double message_s = 2;  // timeout for the rest of a message
constexpr double longest_s = 1e6;

class Server {
public:
    Server(Panel& panel, ScreenSocket& listener, const ScreenServerOptions& options)
        : panel_(panel), listener_(listener), options_(options), begin_s_(clock_.now()) {}

    Status run() {
        if (Status status = black(); !status) return status;
        while (!left_ && !options_.stop()) {
            if (Status status = panel_.idle(); !status) return refuse_host(status);
            if (host_.is_open()) {
                if (Status status = serve_host(); !status) return refuse_host(status);
            } else if (options_.once && (served_ || clock_.now() - begin_s_ > options_.first_host_s)) {
                return {};
            } else if (listener_.has_news(idle_s)) {
                host_ = listener_.accept();
                served_ = served_ || host_.is_open();
            }
        }
        return {};
    }

private:
    Status black() {
        const Result<double> at = panel_.present(nullptr);
        return at ? Status{} : Status(tl::unexpected(at.error()));
    }

    Status refuse_host(Status status) {
        if (host_.is_open()) (void)host_.send({Say::refused, 0, 0, {}, status.error().message});
        return status;
    }

    void tell(const Message& message) {
        if (host_.is_open() && !host_.send(message)) host_.close();
    }

    void refuse(const std::string& why) {
        tell({Say::refused, 0, 0, {}, why});
        host_.close();
    }

    void turn_others_away() {
        ScreenSocket other = listener_.accept();
        if (other.is_open()) (void)other.send({Say::refused, 0, 0, {}, "another program is using this panel"});
    }

    Status serve_host() {
        if (!host_.has_news(idle_s)) {
            turn_others_away();
            return {};
        }
        Result<Message> message = host_.receive(message_s);
        if (!message) {
            host_.close();
            return {};
        }
        switch (message->say) {
            case Say::hello:
                greet(*message);
                return {};
            case Say::light:
                return light(*message);
            case Say::leave:
                left_ = true;
                listener_.close();  // a host that connects from now on starts another server
                [[fallthrough]];
            case Say::dark: {
                const Status status = black();
                if (status) tell({Say::is_dark, 0, 0, {}, {}});
                return status;
            }
            default:
                refuse("a message that makes no sense here");
                return {};
        }
    }

    void greet(const Message& hello) {
        const bool fits =
            hello.width_px == 0 || (hello.width_px == panel_.width_px() && hello.height_px == panel_.height_px());
        if (!fits) {
            return refuse(
                fmt::format("the panel has {} x {} px, the images {} x {} px: exact pixels need the same size",
                            panel_.width_px(), panel_.height_px(), hello.width_px, hello.height_px));
        }
        Light light;
        light.frame_s = panel_.frame_s();
        tell({Say::ready, panel_.width_px(), panel_.height_px(), light, options_.driver});
    }

    Status light(const Message& message) {
        const std::size_t pixels =
            static_cast<std::size_t>(panel_.width_px()) * static_cast<std::size_t>(panel_.height_px());
        const double seconds = message.light.asked_s;
        const bool good = message.width_px == panel_.width_px() && message.height_px == panel_.height_px() &&
                          message.bytes.size() == pixels && seconds > 0 && seconds <= longest_s;
        if (!good) {
            refuse(fmt::format("no light: an image of {} x {} px for {:g} s on a panel of {} x {} px", message.width_px,
                               message.height_px, seconds, panel_.width_px(), panel_.height_px()));
            return {};
        }
        job::Image image{message.width_px, message.height_px, std::vector<std::uint8_t>(pixels)};
        std::memcpy(image.pixels.data(), message.bytes.data(), pixels);
        const auto lit = [&] { tell({Say::lit, 0, 0, {}, {}}); };
        const Result<Light> light = keep_light(panel_, image, seconds, lit, [&] {
            // Any message from the host, or the end of its connection, ends the exposure.
            if (!host_.is_open() || host_.has_news(0) || options_.stop()) return false;
            turn_others_away();
            return panel_.idle().has_value();
        });
        if (!light) return tl::unexpected(light.error());
        tell({Say::ended, 0, 0, *light, {}});
        return {};
    }

    Panel& panel_;
    ScreenSocket& listener_;
    const ScreenServerOptions& options_;
    ScreenSocket host_;
    SteadyClock clock_;
    double begin_s_;
    bool served_ = false;
    bool left_ = false;
};

}  // namespace

Status serve_screen(Panel& panel, ScreenSocket& listener, const ScreenServerOptions& options) {
    // The host may turn the display off itself, so it is told of the end only when everything is done.
    Server server(panel, listener, options);
    const Status status = server.run();
    const Result<double> dark = panel.present(nullptr);
    if (!status) return status;
    return dark ? Status{} : Status(tl::unexpected(dark.error()));
}

}  // namespace pliant::host
