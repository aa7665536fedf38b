// pliant materials: lists the library of materials that robot files may name.
#include <fmt/core.h>

#include <vector>

#include "command.hpp"
#include "robot/file/material_library.hpp"

namespace pliant::app {
namespace {

struct MaterialsOptions {
    std::vector<std::string> names;
    Output output;
};

Status list(const MaterialsOptions& options) {
    std::vector<std::string> names = options.names;
    if (names.empty()) {
        for (const EmbeddedFile& file : robot::library_files()) names.emplace_back(file.name);
    }
    std::vector<robot::LibraryMaterial> materials;
    for (const std::string& name : names) {
        Result<robot::LibraryMaterial> material = robot::library_material(name);
        if (!material) return tl::unexpected(material.error());
        materials.push_back(std::move(*material));
    }
    if (options.output.json) return fmt::print("{}\n", robot::library_json(materials)), Status{};
    if (options.names.empty()) return fmt::print("{}", robot::library_text()), Status{};
    for (const robot::LibraryMaterial& material : materials) fmt::print("{}", robot::material_text(material));
    return {};
}

}  // namespace

void add_materials(CLI::App& app, int& status) {
    auto options = std::make_shared<MaterialsOptions>();
    CLI::App* command = app.add_subcommand("materials", "list the library of materials that robot files may name");
    command->add_option("names", options->names, "show these materials with constants and sources");
    add_output_options(*command, options->output, true);
    command->footer("Example: pliant materials ecoflex-00-30");
    on_call(*command, status, [options] { return list(*options); });
}

}  // namespace pliant::app
