// The zip file around a 3MF model: which part is the model, and the text of parts.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/zip/zip_file.hpp"
#include "geometry/threemf/xml_part.hpp"

namespace pliant::threemf {

class Package {
public:
    /// Errors: no zip file; no, several or an outside start part; relationships that the specification forbids.
    [[nodiscard]] static Result<Package> open(const std::filesystem::path& path);

    [[nodiscard]] const std::string& name() const { return name_; }
    /// Path of the start part, as in "/3D/3dmodel.model".
    [[nodiscard]] const std::string& model() const { return model_; }
    /// Relationships to parts that are not in the file, where no body needs them.
    [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }
    /// A part by its path from the root of the package. Errors: missing, above 1 GB, no well-formed XML.
    [[nodiscard]] Result<XmlPart> part(std::string_view path) const;

private:
    Package(ZipReader zip, std::string name) : zip_(std::move(zip)), name_(std::move(name)) {}
    Status find_model();
    Status check_relationships_of_model();
    void check_targets(const XmlPart& relationships, const std::string& folder);

    ZipReader zip_;
    std::string name_, model_;
    std::vector<std::string> warnings_;
};

}  // namespace pliant::threemf
