#include "printing/twin/serve.hpp"

#include <algorithm>
#include <chrono>

namespace pliant::twin {
namespace {

constexpr double longest_wait_s = 0.02;
constexpr double shortest_wait_s = 0.001;

double wall_s() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

Status serve(Twin& twin, Pty& pty, const ServeOptions& options) {
    double wall_before_s = wall_s();
    double now_s = twin.now();
    // On an accelerated machine, checking the light every 20 ms would be seconds off.
    const double look_every_s =
        options.lights ? std::clamp(longest_wait_s / options.speed, shortest_wait_s, longest_wait_s) : longest_wait_s;
    while (!options.stop()) {
        const auto next = twin.next_event();
        const double until_s = next ? (*next - now_s) / options.speed : look_every_s;
        const Result<std::string> bytes = pty.read(std::clamp(until_s, shortest_wait_s, look_every_s));
        if (!bytes) return tl::unexpected(bytes.error());
        const double wall_now_s = wall_s();
        now_s += std::min(wall_now_s - wall_before_s, options.longest_step_s) * options.speed;
        wall_before_s = wall_now_s;
        twin.advance_to(std::max(twin.now(), now_s));
        if (options.tick) options.tick(twin.now());
        // A host turns the light off before it sends the next move: so the light is handled first here, too.
        if (options.lights) {
            if (Status status = options.lights(twin); !status) return status;
        }
        if (!bytes->empty()) {
            if (options.log) options.log(*bytes, true);
            twin.receive(*bytes);
        }
        const std::string said = twin.take_output();
        if (said.empty()) continue;
        if (options.log) options.log(said, false);
        pty.write(said);
    }
    return {};
}

}  // namespace pliant::twin
