// The projector of a real print: a display or a folder of images, held by a separate process.
//
// The image and duration of every exposure go to `pliant-screen`, which presents the frames and ends the exposure by
// itself. If the host dies, its connection closes and the panel goes black, as between exposures. A display stays black
// after the host, because the desktop's light would cure resin, too; release_display() gives it back.
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
    std::string name;  ///< driver, or the display's own name
    int width_px = 0, height_px = 0;
    double refresh_hz = 0;  ///< 0: unknown
};

struct ScreenOptions {
    int width_px = 0, height_px = 0;  ///< of the images to be shown; 0: any
    double longest_light_s = 3600;    ///< ends a show() that is not ended otherwise; the printer's limits.exposure
    std::filesystem::path program;    ///< pliant-screen; "": beside the running program
};

/// Not thread-safe. After an error during an exposure the panel is black.
class ScreenProjector final : public Projector {
public:
    /// `where` is the number of a display, or a folder (images appear in it as in frame_folder.hpp; it needs the image
    /// size). Black once open. Errors: no such display, a different size (for both), in use by another host.
    [[nodiscard]] static Result<ScreenProjector> open(const std::string& where, const ScreenOptions& options);

    [[nodiscard]] const PanelInfo& panel() const { return panel_; }
    [[nodiscard]] Status show(const job::Image& image) override;
    [[nodiscard]] Status black() override;
    [[nodiscard]] Status show_for(const job::Image& image, double seconds) override;
    [[nodiscard]] Result<std::optional<Light>> finish() override;
    /// The process that holds the panel.
    [[nodiscard]] int holder_process() const { return socket_.peer_process(); }
    /// The last exposure ended by finish() or black().
    [[nodiscard]] const std::optional<Light>& last_light() const { return last_light_; }

private:
    ScreenProjector(ScreenSocket socket, PanelInfo panel, double longest_s)
        : socket_(std::move(socket)), panel_(std::move(panel)), longest_s_(longest_s) {}
    [[nodiscard]] Status wait_for(Say wanted, double timeout_s);

    ScreenSocket socket_;
    PanelInfo panel_;
    double longest_s_ = 0;
    double asked_s_ = 0;  ///< duration of the current exposure; 0: none
    std::optional<Light> last_light_;
};

/// The displays of this computer.
[[nodiscard]] Result<std::vector<PanelInfo>> list_displays(const std::filesystem::path& program = {});
/// Ends the process that keeps a display black, and any exposure with it. False: there is none.
[[nodiscard]] Result<bool> release_display(int display);

/// The display number in `where`, from 0; nullopt: it names a folder.
[[nodiscard]] std::optional<int> display_number(const std::string& where);

}  // namespace pliant::host
