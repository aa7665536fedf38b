// Serialises values for the pipe between a program and its mesher (mesh_worker.hpp). Both ends run on one machine and
// come from one build, so numbers are in native byte order. The reader still trusts nothing: memory follows the actual
// bytes, indices are checked, and the nesting of expressions is limited.
#pragma once

#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "base/core/error.hpp"
#include "geometry/mesh/tet_mesh.hpp"
#include "geometry/mesh/tri_mesh.hpp"
#include "geometry/mesher/mesher.hpp"
#include "geometry/mesher/notches.hpp"
#include "geometry/mesher/step_content.hpp"

namespace pliant::mesh {

class Packer {
public:
    template <class T>
    requires std::is_arithmetic_v<T>
    void number(T value) { bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T)); }
    void flag(bool value) { number<std::uint8_t>(value ? 1 : 0); }
    void text(std::string_view value) {
        number<std::uint64_t>(value.size());
        bytes_.append(value);
    }
    /// An array of trivially copyable elements without pointers or padding.
    template <class T>
    requires std::is_trivially_copyable_v<T>
    void list(const std::vector<T>& values) {
        number<std::uint64_t>(values.size());
        bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    }
    [[nodiscard]] std::string take() { return std::move(bytes_); }

private:
    std::string bytes_;
};

/// Reads what a Packer wrote. After the first invalid item everything reads as zero or empty and good() is false, so
/// the caller checks once, at the end.
class Unpacker {
public:
    explicit Unpacker(std::string_view bytes) : rest_(bytes) {}

    template <class T>
    requires std::is_arithmetic_v<T> T number() {
        T value{};
        if (rest_.size() < sizeof(T)) {
            fail();
            return value;
        }
        std::memcpy(&value, rest_.data(), sizeof(T));
        rest_.remove_prefix(sizeof(T));
        return value;
    }
    std::string text() {
        const std::size_t size = count(1);
        std::string value(rest_.substr(0, size));
        rest_.remove_prefix(size);
        return value;
    }
    template <class T>
    requires std::is_trivially_copyable_v<T> std::vector<T> list() {
        std::vector<T> values(count(sizeof(T)));
        if (!values.empty()) std::memcpy(values.data(), rest_.data(), values.size() * sizeof(T));
        rest_.remove_prefix(values.size() * sizeof(T));
        return values;
    }
    bool flag() {
        const auto value = number<std::uint8_t>();
        if (value > 1) fail();
        return value == 1;
    }
    /// The number of items that follow, each of at least this many bytes; 0 if the remaining bytes cannot hold that
    /// many.
    std::size_t count(std::size_t least_bytes);
    void fail() {
        good_ = false;
        rest_ = {};
    }
    /// Whether everything was read without error and no bytes are left.
    [[nodiscard]] bool finished() const { return good_ && rest_.empty(); }
    [[nodiscard]] bool good() const { return good_; }

private:
    std::string_view rest_;
    bool good_ = true;
};

void pack(Packer& out, double value);
void pack(Packer& out, const Vec3& value);
void pack(Packer& out, const TriMesh& value);
void pack(Packer& out, const TetMesh& value);
void pack(Packer& out, const Solid& value);
void pack(Packer& out, const BodyGeometry& value);
void pack(Packer& out, const MeshSettings& value);
void pack(Packer& out, const StepContent& value);
void pack(Packer& out, const Notch& value);
void pack(Packer& out, const std::string& value);
void pack(Packer& out, const Diagnostic& value);
void pack(Packer& out, const Error& value);

void unpack(Unpacker& in, double& value);
void unpack(Unpacker& in, Vec3& value);
void unpack(Unpacker& in, TriMesh& value);
void unpack(Unpacker& in, TetMesh& value);
void unpack(Unpacker& in, Solid& value);
void unpack(Unpacker& in, BodyGeometry& value);
void unpack(Unpacker& in, MeshSettings& value);
void unpack(Unpacker& in, StepContent& value);
void unpack(Unpacker& in, Notch& value);
void unpack(Unpacker& in, std::string& value);
void unpack(Unpacker& in, Diagnostic& value);
void unpack(Unpacker& in, Error& value);

template <class T>
void pack(Packer& out, std::span<const T> values) {
    out.number<std::uint64_t>(values.size());
    for (const T& value : values) pack(out, value);
}
/// The inverse of pack().
template <class T>
void pack(Packer& out, const std::vector<T>& values) {
    pack(out, std::span<const T>(values));
}

template <class T>
void unpack(Unpacker& in, std::vector<T>& values) {
    values.clear();
    for (std::size_t left = in.count(1); left > 0 && in.good(); --left) unpack(in, values.emplace_back());
}

/// The value in an answer. Errors: that of the answer, or an unreadable answer.
template <class T>
Result<T> unpacked(const Result<std::string>& answer) {
    if (!answer) return tl::unexpected(answer.error());
    Unpacker in(*answer);
    T value{};
    unpack(in, value);
    if (!in.finished()) return failure("pliant-mesh answered with something that cannot be read");
    return value;
}

}  // namespace pliant::mesh
