#include "simulation/stepper/cbor_numbers.hpp"

namespace pliant::sim::cbor {
namespace {

/// Checks the structure only.
class Structure final : public nlohmann::json_sax<Json> {
public:
    explicit Structure(std::size_t most) : most_(most) {}

    bool null() override { return true; }
    bool boolean(bool) override { return true; }
    bool number_integer(number_integer_t) override { return true; }
    bool number_unsigned(number_unsigned_t) override { return true; }
    bool number_float(number_float_t, const string_t&) override { return true; }
    bool string(string_t&) override { return true; }
    bool binary(binary_t&) override { return true; }
    bool key(string_t&) override { return true; }
    bool start_object(std::size_t elements) override { return enter(elements); }
    bool start_array(std::size_t elements) override { return enter(elements); }
    bool end_object() override { return leave(); }
    bool end_array() override { return leave(); }
    bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override { return false; }

private:
    static constexpr int deepest = 16;

    bool enter(std::size_t elements) {
        const bool unknown = elements == static_cast<std::size_t>(-1);
        return ++depth_ <= deepest && (unknown || elements <= most_);
    }
    bool leave() {
        --depth_;
        return true;
    }

    std::size_t most_;
    int depth_ = 0;
};

}  // namespace

Json parsed(std::string_view bytes) {
    Structure structure(bytes.size());
    if (!Json::sax_parse(bytes, &structure, Json::input_format_t::cbor)) return Json(Json::value_t::discarded);
    return Json::from_cbor(bytes, true, false);
}

}  // namespace pliant::sim::cbor
