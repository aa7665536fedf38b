// The library of materials: data/materials, compiled into the program.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/config.hpp"
#include "base/core/embedded_file.hpp"
#include "robot/description/robot.hpp"

namespace pliant::robot {

/// By name.
[[nodiscard]] std::span<const EmbeddedFile> library_files();

/// A material of the library and its documentation.
struct LibraryMaterial {
    MaterialSpec spec;
    std::string title;              ///< product and maker
    std::string hardness;           ///< "Shore 00-30"; empty: not published
    std::string source;             ///< where the constants and the density come from
    std::string derivation;         ///< how they follow from the source, and what they are not valid for
    std::array<double, 2> stretch;  ///< range in which the constants were measured
};
/// Errors name file and line; for an unknown name they suggest similar ones.
[[nodiscard]] Result<LibraryMaterial> library_material(std::string_view name);

/// "; did you mean ...?" with up to four similar names of the library, or how to list them all.
[[nodiscard]] std::string library_hint(std::string_view name);

/// The table of a material based on one of the library: the keys of `own` override those of the library. A `law` in
/// `own` drops the library's elastic constants; `bulk_modulus` and `poisson_ratio` replace each other. Precondition:
/// `base` is in the library.
[[nodiscard]] config::Value with_base(const config::Value& own, std::string_view base);

/// The whole library for people, one line each.
[[nodiscard]] std::string library_text();
/// One material with its constants and where they come from.
[[nodiscard]] std::string material_text(const LibraryMaterial& material);
/// A list of objects; pressures in Pa.
[[nodiscard]] std::string library_json(const std::vector<LibraryMaterial>& materials);

}  // namespace pliant::robot
