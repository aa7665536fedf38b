#include "printing/machine/built_in_printers.hpp"

#include <filesystem>
#include <vector>

#include "base/core/files.hpp"
#include "base/core/text.hpp"

namespace pliant::machine {
namespace {

tl::unexpected<Error> no_such_printer(const std::string& name) {
    std::vector<std::string> names;
    for (const EmbeddedFile& file : built_in_printers()) names.emplace_back(file.name);
    const std::string nearest = nearest_name(name, names);
    if (!nearest.empty())
        return input_error("{}: there is no such file or built-in printer; did you mean \"{}\"?", name, nearest);
    return input_error("{}: there is no such file or built-in printer; built in are {}", name, join_names(names));
}

}  // namespace

bool is_printer_name(const std::string& word) {
    std::error_code ignored;
    return word.find_first_of("./\\") == std::string::npos && !std::filesystem::exists(word, ignored);
}

bool is_built_in_printer(const std::string& word) {
    return is_printer_name(word) && find_file(built_in_printers(), word) != nullptr;
}

Result<std::string> read_printer_text(const std::string& name) {
    if (!is_printer_name(name)) return read_file(name);
    const EmbeddedFile* file = find_file(built_in_printers(), name);
    if (file == nullptr) return no_such_printer(name);
    return std::string(file->text);
}

}  // namespace pliant::machine
