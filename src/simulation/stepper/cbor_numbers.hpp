// Vectors of numbers in CBOR, with checks when reading.
#pragma once

#include <Eigen/Core>
#include <bit>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"

namespace pliant::sim::cbor {

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie in memory");

using Json = nlohmann::json;

template <class T>
[[nodiscard]] Json packed(std::span<const T> numbers) {
    static_assert(std::is_trivially_copyable_v<T>);
    std::vector<std::uint8_t> bytes(numbers.size_bytes());
    if (!bytes.empty()) std::memcpy(bytes.data(), numbers.data(), bytes.size());
    return Json::binary(std::move(bytes));
}
[[nodiscard]] inline Json packed(const Eigen::VectorXd& v) {
    return packed(std::span<const double>(v.data(), static_cast<std::size_t>(v.size())));
}

/// Parses the map, list or value in the bytes; `discarded` if invalid. Lists nested deeper than any of ours, and lists
/// longer than all bytes, are invalid: the parser would run out of stack, or throw.
[[nodiscard]] Json parsed(std::string_view bytes);

/// The value in CBOR, followed by a checksum.
[[nodiscard]] std::string sealed(const Json& value);
[[nodiscard]] std::string sealed(std::string cbor);
/// The bytes before the checksum. Error: it does not fit, because the file is damaged or incomplete.
[[nodiscard]] Result<std::string_view> unsealed(std::string_view bytes);

/// Reads values from a map; the first one that is missing or invalid is the error of the whole.
class Reader {
public:
    /// `map` must outlive it.
    explicit Reader(const Json& map) : map_(&map) {
        if (!map.is_object()) fail("no map");
    }

    [[nodiscard]] const Status& status() const { return status_; }
    void fail(const std::string& why) {
        if (status_) status_ = input_error("damaged: {}", why);
    }
    [[nodiscard]] bool has(const char* key) const { return status_ && map_->contains(key) && !map_->at(key).is_null(); }

    /// Null if missing.
    [[nodiscard]] const Json& at(const char* key) {
        static const Json none;
        if (!status_) return none;
        const auto found = map_->find(key);
        if (found != map_->end()) return *found;
        fail(std::string("no ") + key);
        return none;
    }
    [[nodiscard]] double number(const char* key) {
        const Json& value = at(key);
        if (value.is_number()) return value.get<double>();
        fail(std::string(key) + " is not a number");
        return 0;
    }
    [[nodiscard]] int integer(const char* key, int least, int most) {
        const Json& value = at(key);
        if (value.is_number_integer()) {
            const auto number = value.get<std::int64_t>();
            if (number >= least && number <= most) return static_cast<int>(number);
        }
        fail(std::string(key) + " is not a number from " + std::to_string(least) + " to " + std::to_string(most));
        return least;
    }
    [[nodiscard]] bool boolean(const char* key) {
        const Json& value = at(key);
        if (value.is_boolean()) return value.get<bool>();
        fail(std::string(key) + " is neither true nor false");
        return false;
    }
    [[nodiscard]] std::string text(const char* key) {
        const Json& value = at(key);
        if (value.is_string()) return value.get<std::string>();
        fail(std::string(key) + " is not a text");
        return {};
    }
    template <class T>
    [[nodiscard]] std::vector<T> numbers(const char* key) {
        return numbers_of<T>(key, at(key));
    }
    /// For a value already read; `key` names it in the error.
    template <class T>
    [[nodiscard]] std::vector<T> numbers_of(const char* key, const Json& value) {
        std::vector<T> out;
        if (!value.is_binary() || value.get_binary().size() % sizeof(T) != 0) {
            fail(std::string(key) + " is not a list of numbers");
            return out;
        }
        out.resize(value.get_binary().size() / sizeof(T));
        if (!out.empty()) std::memcpy(out.data(), value.get_binary().data(), value.get_binary().size());
        return out;
    }
    /// Finite numbers, exactly `size` of them.
    [[nodiscard]] Eigen::VectorXd vector(const char* key, Eigen::Index size) {
        const std::vector<double> numbers = this->numbers<double>(key);
        if (status_ && static_cast<Eigen::Index>(numbers.size()) != size)
            fail(std::string(key) + " has " + std::to_string(numbers.size()) + " numbers instead of " +
                 std::to_string(size));
        if (!status_) return Eigen::VectorXd::Zero(size);
        Eigen::VectorXd v = Eigen::Map<const Eigen::VectorXd>(numbers.data(), size);
        if (!v.allFinite()) fail(std::string(key) + " has numbers that are not finite");
        return v;
    }

private:
    const Json* map_;
    Status status_;
};

}  // namespace pliant::sim::cbor
