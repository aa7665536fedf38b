#include "printing/twin/finding.hpp"

#include <fmt/format.h>

#include <array>

#include "base/core/text.hpp"

namespace pliant::twin {
namespace {

using Kind = Finding::Kind;

struct Named {
    Kind kind;
    std::string_view name;
    bool acceptable;
};

constexpr std::array<Named, 12> all{{{Kind::missing, "missing", false},
                                     {Kind::foreign, "foreign", false},
                                     {Kind::stray, "stray", false},
                                     {Kind::dose, "dose", false},
                                     {Kind::light, "light", false},
                                     {Kind::height, "height", false},
                                     {Kind::image, "image", false},
                                     {Kind::volume, "volume", true},
                                     {Kind::overcure, "overcure", true},
                                     {Kind::contamination, "contamination", true},
                                     {Kind::cleaning, "cleaning", true},
                                     {Kind::interlock, "interlock", false}}};

const Named& named(Kind kind) {
    for (const Named& entry : all) {
        if (entry.kind == kind) return entry;
    }
    return all.front();
}

}  // namespace

std::string_view finding_name(Kind kind) {
    return named(kind).name;
}

bool can_be_accepted(Kind kind) {
    return named(kind).acceptable;
}

Result<Kind> accepted_finding(std::string_view name) {
    std::vector<std::string> candidates;
    std::string list;
    for (const Named& entry : all) {
        if (!entry.acceptable) continue;
        if (entry.name == name) return entry.kind;
        candidates.emplace_back(entry.name);
        list += (list.empty() ? "" : ", ") + candidates.back();
    }
    for (const Named& entry : all) {
        if (entry.name == name)
            return input_error(
                "the finding \"{}\" cannot be accepted: the print is not the job; what can be accepted: {}", name,
                list);
    }
    const std::string nearest = nearest_name(name, candidates);
    return input_error("there is no finding \"{}\"{}; what can be accepted: {}", name,
                       nearest.empty() ? "" : fmt::format(", did you mean \"{}\"", nearest), list);
}

Result<std::vector<Kind>> accepted_findings(std::span<const std::string> names) {
    std::vector<Kind> kinds;
    for (const std::string& name : names) {
        const Result<Kind> kind = accepted_finding(name);
        if (!kind) return tl::unexpected(kind.error());
        kinds.push_back(*kind);
    }
    return kinds;
}

}  // namespace pliant::twin
