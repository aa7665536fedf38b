// Which column of a table is meant by a name.
#pragma once

#include <functional>
#include <optional>
#include <string_view>

#include "base/core/csv.hpp"
#include "base/core/error.hpp"

namespace pliant::calibrate {

/// The column that is called `name`, whatever its unit; otherwise the only one for which `may_be` is true, which is
/// given names in lower case. None if there is no such column. Error: several, none of which is called just `name`.
[[nodiscard]] Result<std::optional<std::size_t>> named_column(const CsvTable& table, std::string_view name,
                                                              const std::function<bool(std::string_view)>& may_be);

}  // namespace pliant::calibrate
