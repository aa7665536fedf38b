// From the build of a 3MF package to bodies on the plate.
#pragma once

#include <map>
#include <string>

#include "geometry/threemf/model_part.hpp"
#include "geometry/threemf/package.hpp"

namespace pliant::threemf {

class Build {
public:
    /// `package` provides other parts that this one references; nullptr: none.
    Build(const Package* package, std::string file) : package_(package), file_(std::move(file)) {}

    /// Errors: objects that are missing or must not be built, missing parts, too many bodies.
    [[nodiscard]] Result<ThreeMf> assemble(ModelPart start);

private:
    Result<const ModelPart*> part(const std::string& path);
    Status place(const std::string& path, const Placed& placed, const Transform& transform, int depth);
    Status add_mesh(const ModelPart& part, const Object& object, const Transform& transform);
    Status add_slices(const std::string& path, const Object& object, const Transform& transform, Body& body);
    Result<std::vector<Slice>> slices(const std::string& path, int stack, int depth);

    const Package* package_;
    std::string file_;
    std::map<std::string, ModelPart> parts_;
    ThreeMf built_;
    std::size_t visits_ = 0, triangles_ = 0;
};

}  // namespace pliant::threemf
