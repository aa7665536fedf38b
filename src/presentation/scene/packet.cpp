#include "presentation/scene/packet.hpp"

#include <fmt/format.h>

#include <bit>
#include <cstring>

namespace pliant::view {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are sent as they lie in memory");

template <class T>
void append_bytes(std::string& bytes, const std::vector<T>& values) {
    static_assert(sizeof(T) == 4);
    const std::size_t start = bytes.size();
    bytes.resize(start + 4 * values.size());
    if (!values.empty()) std::memcpy(bytes.data() + start, values.data(), 4 * values.size());
}

}  // namespace

void Packet::list(std::string_view name, std::string_view type, std::size_t count) {
    if (!arrays_.empty()) arrays_ += ',';
    arrays_ += fmt::format(R"({{"name":"{}","type":"{}","count":{}}})", name, type, count);
}

void Packet::add(std::string_view name, const std::vector<float>& values) {
    list(name, "f32", values.size());
    append_bytes(bytes_, values);
}

void Packet::add(std::string_view name, const std::vector<std::uint32_t>& values) {
    list(name, "u32", values.size());
    append_bytes(bytes_, values);
}

std::string Packet::finish(std::string_view head) const {
    std::string json = fmt::format(R"({{"head":{},"arrays":[{}]}})", head, arrays_);
    json.append((4 - json.size() % 4) % 4, ' ');
    const auto length = static_cast<std::uint32_t>(json.size());
    std::string packet = "PLN1";
    packet.resize(8);
    std::memcpy(packet.data() + 4, &length, 4);
    return packet + json + bytes_;
}

}  // namespace pliant::view
