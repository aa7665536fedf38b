#include "printing/prepare/option_text.hpp"

#include <charconv>
#include <cmath>

#include "base/core/units.hpp"

namespace pliant::prepare {
namespace {

/// Rounding error of a quantity in metres, in micrometres.
constexpr double rounding_um = 1e-6;

/// Whether the whole text is a number of `number`'s type.
template <class Number>
bool reads(const std::string& text, Number& number) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc() && end == text.data() + text.size();
}

}  // namespace

Result<double> length_um(const char* option, const std::string& text, double otherwise) {
    if (text.empty()) return otherwise;
    const Result<double> length = parse_quantity(text, Dimension::length);
    if (!length) return input_error("{}: {}", option, length.error().message);
    const double um = *length * 1e6;
    if (!std::isfinite(um)) return input_error("{} {}: is not a possible length", option, text);
    return um;
}

Result<double> length_um(const char* option, const std::string& text, double otherwise, double least_um,
                         double most_um) {
    const Result<double> um = length_um(option, text, otherwise);
    if (!um || text.empty()) return um;
    if (!(*um >= least_um - rounding_um && *um <= most_um + rounding_um))
        return input_error("{} {}: must be {:.6g} to {:.6g} mm", option, text, least_um / 1000, most_um / 1000);
    return um;
}

Result<int> layer_height_um(const char* option, const std::string& text) {
    const Result<double> height = length_um(option, text, 0);
    if (!height) return tl::unexpected(height.error());
    const double um = std::round(*height);
    if (!(um >= 1 && um <= 1000 && std::fabs(um - *height) <= rounding_um))
        return input_error("{} {}: a whole number of micrometres from 1 to 1000 is needed", option, text);
    return static_cast<int>(um);
}

int plain_number(const std::string& text) {
    int number = -1;
    return reads(text, number) && number >= 0 ? number : -1;
}

Result<double> plain_degrees(const char* option, const std::string& text) {
    double degrees = 0;
    if (!reads(text, degrees) || !std::isfinite(degrees))
        return input_error("{} {}: a number of degrees is needed", option, text);
    return degrees;
}

}  // namespace pliant::prepare
