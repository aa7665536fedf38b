#include "printing/machine/marlin_files.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <utility>

#include "printing/machine/define_lines.hpp"

namespace pliant::machine {
namespace {

/// "02010201" is 2.1.2.1, "02010300" 2.1.3 and "020008" 2.0.8; "" if it is not such a number.
std::string version(std::string_view digits) {
    if (digits.size() < 4 || digits.size() % 2 != 0 || digits.find_first_not_of("0123456789") != std::string_view::npos)
        return "";
    std::vector<int> parts;
    for (std::size_t i = 0; i < digits.size(); i += 2) parts.push_back(10 * (digits[i] - '0') + (digits[i + 1] - '0'));
    while (parts.size() > 3 && parts.back() == 0) parts.pop_back();
    return fmt::format("{}", fmt::join(parts, "."));
}

std::string only_value(const DefineLines& lines, std::string_view name) {
    const auto found = lines.find(name);
    return found.empty() ? "" : found.front().value;
}

/// One of the two files, being changed.
struct Header {
    const MarlinFile* file = nullptr;
    std::string_view name, version_name;
    DefineLines lines;
};

Status check_release(const Header& header, MarlinRelease release) {
    const std::string digits = only_value(header.lines, header.version_name);
    if (digits.empty())
        return input_error("{}: has no {}, which every {} of Marlin 2 has", header.file->path, header.version_name,
                           header.name);
    const std::string found = version(digits);
    if (marlin_release(found) == release) return {};
    return input_error(
        "{}: {} {} is of Marlin {}, the list is for {}: take that release, or name this one by --release",
        header.file->path, header.version_name, digits, found.empty() ? "unknown" : found, name_of(release));
}

bool is_pin(const FirmwareSetting& setting) {
    return setting.name.ends_with("_PIN") && !setting.value.empty() &&
           setting.value.find_first_not_of("0123456789") == std::string::npos;
}

std::string state(const DefineLine& line) {
    if (!line.active) return "off";
    return line.value.empty() ? "on" : line.value;
}

/// If a setting is only enabled, its value does not matter.
bool is_as_before(const DefineLine& before, const FirmwareSetting& setting) {
    if (setting.value == "on") return before.active;
    return state(before) == setting.value;
}

using Headers = std::array<Header, 2>;

Status check_names(const Headers& headers, const std::vector<FirmwareSetting>& settings) {
    std::vector<std::string> unknown;
    for (const FirmwareSetting& s : settings) {
        if (is_pin(s)) continue;
        if (std::all_of(headers.begin(), headers.end(), [&](const Header& h) { return h.lines.find(s.name).empty(); }))
            unknown.push_back(s.name);
    }
    if (unknown.empty()) return {};
    const std::string more = unknown.size() > 1 ? fmt::format(" and {} more of the list", unknown.size() - 1) : "";
    return input_error("{} and {}: neither has {}{}: they are not the configuration files of that release as it came",
                       headers[0].file->path, headers[1].file->path, unknown.front(), more);
}

/// Applies a setting in each file that has it; adds a line to the record per place.
void apply(Headers& headers, const FirmwareSetting& setting, ConfiguredMarlin& result) {
    bool found = false, changed = false;
    if (!setting.reason.empty()) result.record += fmt::format("# {}\n", setting.reason);
    for (Header& header : headers) {
        for (const DefineLine& place : header.lines.find(setting.name)) {
            found = true;
            changed = changed || !is_as_before(place, setting);
            result.record +=
                fmt::format("{}: {} = {} (was {})\n", header.name, setting.name, setting.value, state(place));
        }
        header.lines.set(setting.name, setting.value);
    }
    if (changed) ++result.changed;
    if (found) return;
    headers[0].lines.append(fmt::format("#define {} {}", setting.name, setting.value));
    result.record += fmt::format("{}: {} = {} (added)\n", headers[0].name, setting.name, setting.value);
    ++result.added;
}

/// The configuration's author, unless it is Marlin's default.
std::string author_of(const DefineLines& lines) {
    const std::string author = only_value(lines, "STRING_CONFIG_H_AUTHOR");
    return author.find("default config") == std::string::npos ? author : "";
}

}  // namespace

Result<ConfiguredMarlin> configure_marlin(const std::vector<FirmwareSetting>& settings, MarlinRelease release,
                                          const MarlinFile& configuration, const MarlinFile& configuration_adv) {
    Headers headers = {
        Header{&configuration, "Configuration.h", "CONFIGURATION_H_VERSION", DefineLines(configuration.text)},
        Header{&configuration_adv, "Configuration_adv.h", "CONFIGURATION_ADV_H_VERSION",
               DefineLines(configuration_adv.text)}};
    for (const Header& header : headers) {
        if (Status status = check_release(header, release); !status) return tl::unexpected(status.error());
    }
    if (Status status = check_names(headers, settings); !status) return tl::unexpected(status.error());
    ConfiguredMarlin result;
    result.author = author_of(headers[0].lines);
    for (const FirmwareSetting& setting : settings) apply(headers, setting, result);
    result.configuration = headers[0].lines.text();
    result.configuration_adv = headers[1].lines.text();
    return result;
}

}  // namespace pliant::machine
