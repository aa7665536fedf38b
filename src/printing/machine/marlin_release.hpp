// Releases of Marlin that differ in ways that matter to a host or to the build settings.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

namespace pliant::machine {

enum class MarlinRelease {
    v2_1_1,  ///< repeated line numbers are answered by Error, Resend and ok
    v2_1_2,  ///< 2.1.2 to 2.1.2.x: a line numbered as the last one, or the one before, is dropped silently
    v2_1_3,  ///< as 2.1.2 on the wire; settings of plugs, inverting and the old idle time must be absent
};

inline constexpr std::array<std::string_view, 3> marlin_release_names = {"2.1.1", "2.1.2", "2.1.3"};

[[nodiscard]] constexpr std::string_view name_of(MarlinRelease release) {
    return marlin_release_names[static_cast<std::size_t>(release)];
}

/// The release that a version belongs to: "2.1.2.1" and "2.1.2" are both 2.1.2. nullopt: not supported.
[[nodiscard]] constexpr std::optional<MarlinRelease> marlin_release(std::string_view version) {
    for (std::size_t i = 0; i < marlin_release_names.size(); ++i) {
        const std::string_view name = marlin_release_names[i];
        const bool ends =
            version.size() == name.size() || (version.size() > name.size() && version[name.size()] == '.');
        if (version.substr(0, name.size()) == name && ends) return static_cast<MarlinRelease>(i);
    }
    return std::nullopt;
}

}  // namespace pliant::machine
