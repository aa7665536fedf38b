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

namespace {

/// FNV-1a in words of eight bytes instead of single ones, for speed. Every change of a single word changes it.
std::uint64_t checksum_of(std::string_view bytes) {
    std::uint64_t sum = 14695981039346656037ULL;
    for (std::size_t at = 0; at < bytes.size(); at += sizeof sum) {
        std::uint64_t word = 0;
        std::memcpy(&word, bytes.data() + at, std::min(sizeof word, bytes.size() - at));
        sum = (sum ^ word) * 1099511628211ULL;
    }
    return sum ^ bytes.size();
}

}  // namespace

std::string sealed(const Json& value) {
    std::string bytes;
    Json::to_cbor(value, bytes);
    return sealed(std::move(bytes));
}

std::string sealed(std::string cbor) {
    const std::uint64_t sum = checksum_of(cbor);
    cbor.append(reinterpret_cast<const char*>(&sum), sizeof sum);
    return cbor;
}

Result<std::string_view> unsealed(std::string_view bytes) {
    std::uint64_t sum = 0;
    if (bytes.size() < sizeof sum) return input_error("damaged: it is too short");
    const std::string_view content = bytes.substr(0, bytes.size() - sizeof sum);
    std::memcpy(&sum, bytes.data() + content.size(), sizeof sum);
    if (sum != checksum_of(content)) return input_error("damaged: its checksum is wrong");
    return content;
}

Json parsed(std::string_view bytes) {
    Structure structure(bytes.size());
    if (!Json::sax_parse(bytes, &structure, Json::input_format_t::cbor)) return Json(Json::value_t::discarded);
    return Json::from_cbor(bytes, true, false);
}

}  // namespace pliant::sim::cbor
