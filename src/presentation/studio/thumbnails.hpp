// Small pictures of robots that can be opened: their bodies as drawn, cables, in the light of the report's pictures.
// They are kept as long as the studio runs, and drawn one at a time.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "presentation/studio/project_folder.hpp"

namespace pliant::studio {

/// PNG, from the text of a robot file and where that lies. Errors: of the file, of its bodies; it takes too long.
[[nodiscard]] Result<std::string> draw_thumbnail(const std::string& text, const std::filesystem::path& file);

class Thumbnails {
public:
    /// Null where there is none: the robot has mistakes, takes too long, or names files outside of the folder. Drawn
    /// anew where the text or a file that it names has changed.
    [[nodiscard]] std::shared_ptr<const std::string> of(const std::string& text, const std::filesystem::path& file,
                                                        const ProjectFolder& folder);

private:
    std::mutex mutex_;                                                 ///< also held while one is drawn
    std::map<std::string, std::shared_ptr<const std::string>> known_;  ///< null: there is none
};

}  // namespace pliant::studio
