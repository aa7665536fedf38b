// The projector of a real print: a display or a folder of images, held by a process of its own.
//
// The image and the length of every light go to `pliant-screen`, which presents the frames and ends the light by
// itself. It sees the host's end as the end of the connection: then the panel goes black, as it does between lights. A
// display stays black after the host, because what a desktop shows would cure resin as well; release_display() gives it
// back.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "printing/screen/screen_wire.hpp"
#include "printing/wire/devices.hpp"

namespace pliant::host {

struct PanelInfo {
    int number = 0;
    std::string name;  ///< what drives it, or what the display calls itself
    int width_px = 0, height_px = 0;
    double refresh_hz = 0;  ///< 0: not known
};

struct ScreenOptions {
    int width_px = 0, height_px = 0;  ///< of the images that will come; 0: whatever the display has
    double longest_light_s = 3600;    ///< ends a show() that nobody ends; a printer's limits.exposure
    std::filesystem::path program;    ///< pliant-screen; "": beside the running program
};

/// Not for several threads. Errors of a light leave the panel black.
class ScreenProjector final : public Projector {
public:
    /// `where` is the number of a display, or a folder (images appear in it as frame_folder.hpp says; it needs the
    /// images' size). Black once it is open. Errors: no such display, another size (with both), in use by another host.
    [[nodiscard]] static Result<ScreenProjector> open(const std::string& where, const ScreenOptions& options);

    [[nodiscard]] const PanelInfo& panel() const { return panel_; }
    [[nodiscard]] Status show(const job::Image& image) override;
    [[nodiscard]] Status black() override;
    [[nodiscard]] Status show_for(const job::Image& image, double seconds) override;
    [[nodiscard]] Result<std::optional<Light>> finish() override;
    /// The process that holds the panel.
    [[nodiscard]] int holder_process() const { return socket_.peer_process(); }
    /// The last light that has ended, by finish() or black().
    [[nodiscard]] const std::optional<Light>& last_light() const { return last_light_; }

private:
    ScreenProjector(ScreenSocket socket, PanelInfo panel, double longest_s)
        : socket_(std::move(socket)), panel_(std::move(panel)), longest_s_(longest_s) {}
    [[nodiscard]] Status wait_for(Say wanted, double timeout_s);

    ScreenSocket socket_;
    PanelInfo panel_;
    double longest_s_ = 0;
    double asked_s_ = 0;  ///< of the light that is on; 0: none
    std::optional<Light> last_light_;
};

/// The displays that this computer has.
[[nodiscard]] Result<std::vector<PanelInfo>> list_displays(const std::filesystem::path& program = {});
/// Ends the process that keeps a display black, and any light with it. False: there is none.
[[nodiscard]] Result<bool> release_display(int display);

/// The display that `where` names, a number from 0 on; nullopt: it names a folder.
[[nodiscard]] std::optional<int> display_number(const std::string& where);

}  // namespace pliant::host
