// Small pictures of robots that can be opened: their bodies as drawn, with cables, in the lighting of the report. They
// are cached as long as the studio runs, and drawn one at a time.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "presentation/studio/project_folder.hpp"

namespace pliant::studio {

/// PNG, from the text of a robot file and its location. Errors: in the file, or its bodies; it takes too long.
[[nodiscard]] Result<std::string> draw_thumbnail(const std::string& text, const std::filesystem::path& file);

class Thumbnails {
public:
    /// Null if there is none: the robot has errors, takes too long, or names files outside the folder. Redrawn if the
    /// text or a file that it names has changed.
    [[nodiscard]] std::shared_ptr<const std::string> of(const std::string& text, const std::filesystem::path& file,
                                                        const ProjectFolder& folder);

private:
    std::mutex mutex_;                                                 ///< also held while one is drawn
    std::map<std::string, std::shared_ptr<const std::string>> known_;  ///< null: no picture
};

}  // namespace pliant::studio
