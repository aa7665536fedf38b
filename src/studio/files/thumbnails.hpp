// Pictures of robots that are not built: their bodies as drawn, with cables, in the lighting of the report. Small ones
// of those that can be opened, and the first one that a page shows. They are cached as long as the studio runs, and
// drawn one at a time.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <utility>

#include "base/core/vec3.hpp"
#include "presentation/draw/colour.hpp"
#include "studio/requests/project_folder.hpp"

namespace pliant::studio {

struct PictureStyle {
    int width_px = 240, height_px = 150;
    std::optional<Vec3> towards_eye;  ///< from the robot to the camera; none: as in the pictures of the report
    std::array<double, 4> margins = {0.07, 0.07, 0.10, 0.07};  ///< left, right, bottom, top, as shares of the picture
    /// Behind it, top and bottom; none: as in the report.
    std::optional<std::pair<report::Colour, report::Colour>> backdrop;
};
/// What the page shows until its 3D view is ready: from the same side, in front of the same background.
[[nodiscard]] PictureStyle first_picture_style(bool dark);

/// PNG, from the text of a robot file and its location. Errors: in the file, or its bodies; it takes too long, or is
/// stopped.
[[nodiscard]] Result<std::string> draw_robot(const std::string& text, const std::filesystem::path& file,
                                             const PictureStyle& style, std::stop_token stop = {});

class Thumbnails {
public:
    /// Null if there is none: the robot has errors, takes too long, or names files outside the folder that are not
    /// among `outside`. Redrawn if the text or a file that it names has changed.
    [[nodiscard]] std::shared_ptr<const std::string> of(const std::string& text, const std::filesystem::path& file,
                                                        const ProjectFolder& folder, const PictureStyle& style = {},
                                                        std::span<const std::string> outside = {},
                                                        const std::stop_token& stop = {});

private:
    std::mutex mutex_;                                                 ///< also held while one is drawn
    std::map<std::string, std::shared_ptr<const std::string>> known_;  ///< null: no picture
};

}  // namespace pliant::studio
